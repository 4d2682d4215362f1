#include "tools/experiments/measure_crests.h"

namespace sahel::experiments {

CrestAngle crest_angle(const Plane& h, const CellMask* mask) {
    SAHEL_CHECK(!mask || mask->same_shape(h));
    double xx = 0.0, xy = 0.0, yy = 0.0;
    for (int32_t y = 0; y < h.height; ++y)
        for (int32_t x = 0; x < h.width; ++x) {
            if (mask && !mask->at(x, y)) continue;
            const double gx = (h.at(x + 2, y) - h.at(x - 2, y)) / (4.0 * h.cell_m);
            const double gy = (h.at(x, y + 2) - h.at(x, y - 2)) / (4.0 * h.cell_m);
            xx += gx * gx;
            xy += gx * gy;
            yy += gy * gy;
        }
    const double trace = xx + yy;
    if (trace <= 0.0) return {};
    const double spread = std::hypot(xx - yy, 2.0 * xy); // difference of the two eigenvalues
    const double strong_deg = 0.5 * std::atan2(2.0 * xy, xx - yy) * 180.0 / k_pi;
    double crest = std::fmod(strong_deg + 90.0, 180.0);
    if (crest < 0.0) crest += 180.0;
    return {crest, spread / trace};
}

CrestAngle mean_line(const std::vector<CrestAngle>& lines) {
    if (lines.empty()) return {};
    double c = 0.0, s = 0.0;
    for (const CrestAngle& line : lines) {
        const double twice = 2.0 * line.angle_deg * k_pi / 180.0;
        c += line.coherence * std::cos(twice);
        s += line.coherence * std::sin(twice);
    }
    double angle = 0.5 * std::atan2(s, c) * 180.0 / k_pi;
    if (angle < 0.0) angle += 180.0;
    return {angle, std::hypot(c, s) / static_cast<double>(lines.size())};
}

namespace {

double growth(const std::vector<FluxWind>& winds, double gamma, double angle_deg) {
    double sum = 0.0;
    for (const FluxWind& w : winds) {
        const double s = std::abs(std::sin((w.angle_deg - angle_deg) * k_pi / 180.0));
        sum += w.flux * (1.0 + gamma * s) * s;
    }
    return sum;
}

double across(const std::vector<FluxWind>& winds, double gamma, double angle_deg) {
    double sum = 0.0;
    for (const FluxWind& w : winds) {
        const double s = std::sin((w.angle_deg - angle_deg) * k_pi / 180.0);
        sum += w.flux * (1.0 + gamma * std::abs(s)) * s;
    }
    return sum;
}

double along(const std::vector<FluxWind>& winds, double gamma, double angle_deg) {
    double sum = 0.0;
    for (const FluxWind& w : winds) {
        const double a = (w.angle_deg - angle_deg) * k_pi / 180.0;
        sum += w.flux * (1.0 + gamma * std::abs(std::sin(a))) * std::cos(a);
    }
    return sum;
}

} // namespace

TwoModes two_modes(const std::vector<FluxWind>& winds, double gamma) {
    constexpr double k_step = 0.01; // degrees
    TwoModes out;
    double best = -1.0;
    for (double a = 0.0; a < 180.0; a += k_step)
        if (const double g = growth(winds, gamma, a); g > best) {
            best = g;
            out.instability_deg = a;
        }
    double most = 0.0; // of several balanced lines the one that most sand follows
    for (double a = 0.0; a < 360.0; a += k_step) {
        const double left = across(winds, gamma, a);
        const double right = across(winds, gamma, a + k_step);
        if (left * right > 0.0) continue;
        const double root = a + k_step * (left == right ? 0.0 : left / (left - right));
        if (const double f = along(winds, gamma, root); f > most) {
            most = f;
            out.elongation_deg = std::fmod(root, 360.0);
        }
    }
    Vec2 sum;
    double total = 0.0;
    for (const FluxWind& w : winds) {
        const Vec2 d = unit_of(w.angle_deg);
        sum.x += w.flux * d.x;
        sum.y += w.flux * d.y;
        total += w.flux;
    }
    out.resultant_deg = std::atan2(sum.y, sum.x) * 180.0 / k_pi;
    out.resultant_share = total > 0.0 ? std::hypot(sum.x, sum.y) / total : 0.0;
    return out;
}

} // namespace sahel::experiments
