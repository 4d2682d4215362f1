#include "tools/experiments/measure_dunes.h"

#include <algorithm>
#include <limits>
#include <map>

namespace sahel::experiments {

namespace {

/// Fills one patch from a seed. Each cell keeps the place by which it was reached; a cell reached again by a way that
/// gives it another place shows that the patch closes around the plane.
void flood(const Plane& sand, float threshold, int32_t seed_x, int32_t seed_y, BasicPlane<int32_t>& owner, int32_t id,
           std::vector<std::array<int32_t, 2>>& place, Dune& dune) {
    dune.cells.push_back({seed_x, seed_y});
    owner.at(seed_x, seed_y) = id;
    place[sand.index(seed_x, seed_y)] = {seed_x, seed_y};
    for (size_t next = 0; next < dune.cells.size(); ++next) {
        const auto [x, y] = dune.cells[next];
        for (int32_t dy = -1; dy <= 1; ++dy)
            for (int32_t dx = -1; dx <= 1; ++dx) {
                const std::array<int32_t, 2> to = {x + dx, y + dy};
                const size_t i = sand.index(to[0], to[1]);
                if (!(sand.values[i] > threshold)) continue;
                if (owner.values[i] == id) {
                    if (place[i] != to) dune.spans = true;
                    continue;
                }
                owner.values[i] = id;
                place[i] = to;
                dune.cells.push_back(to);
            }
    }
}

double wrapped(double a, double period) {
    return a - std::floor(a / period) * period;
}

} // namespace

std::vector<Dune> find_dunes(const Plane& sand, double threshold_m, double least_area_m2) {
    const auto threshold = static_cast<float>(threshold_m);
    BasicPlane<int32_t> owner(sand.width, sand.height, sand.cell_m, -1);
    std::vector<std::array<int32_t, 2>> place(sand.size());
    std::vector<Dune> dunes;
    const double cell_area = sand.cell_m * sand.cell_m;
    int32_t id = 0;
    for (int32_t y = 0; y < sand.height; ++y)
        for (int32_t x = 0; x < sand.width; ++x) {
            if (owner.at(x, y) >= 0 || !(sand.at(x, y) > threshold)) continue;
            Dune dune;
            flood(sand, threshold, x, y, owner, id++, place, dune);
            dune.area_m2 = cell_area * static_cast<double>(dune.cells.size());
            if (dune.area_m2 < least_area_m2) continue;
            for (const auto& [cx, cy] : dune.cells) {
                const double s = sand.at(cx, cy);
                dune.volume_m3 += s * cell_area;
                dune.height_m = std::max(dune.height_m, s);
                dune.centre_x_m += s * (cx + 0.5);
                dune.centre_y_m += s * (cy + 0.5);
            }
            const double weight = dune.volume_m3 / cell_area;
            dune.centre_x_m *= sand.cell_m / weight;
            dune.centre_y_m *= sand.cell_m / weight;
            dune.x_m = wrapped(dune.centre_x_m, sand.width * sand.cell_m);
            dune.y_m = wrapped(dune.centre_y_m, sand.height * sand.cell_m);
            dunes.push_back(std::move(dune));
        }
    std::stable_sort(dunes.begin(), dunes.end(),
                     [](const Dune& a, const Dune& b) { return a.volume_m3 > b.volume_m3; });
    return dunes;
}

DuneExtent extent_of(const Dune& dune, const Plane& sand, double angle_deg) {
    if (dune.cells.empty()) return {};
    const Vec2 d = unit_of(angle_deg);
    constexpr double k_far = std::numeric_limits<double>::infinity();
    double along_low = k_far, along_high = -k_far, across_low = k_far, across_high = -k_far;
    for (const auto& [x, y] : dune.cells) {
        const double along = x * d.x + y * d.y;
        const double across = -x * d.y + y * d.x;
        along_low = std::min(along_low, along);
        along_high = std::max(along_high, along);
        across_low = std::min(across_low, across);
        across_high = std::max(across_high, across);
    }
    return {(along_high - along_low + 1.0) * sand.cell_m, (across_high - across_low + 1.0) * sand.cell_m};
}

BarchanShape barchan_shape(const Dune& dune, const Plane& sand, double wind_deg) {
    BarchanShape shape;
    if (dune.cells.empty()) return shape;
    const Vec2 d = unit_of(wind_deg);
    constexpr double k_far = std::numeric_limits<double>::infinity();
    const auto along = [&](const std::array<int32_t, 2>& c) { return c[0] * d.x + c[1] * d.y; };
    const auto across = [&](const std::array<int32_t, 2>& c) { return -c[0] * d.y + c[1] * d.x; };
    double low = k_far, high = -k_far;
    for (const auto& c : dune.cells) {
        low = std::min(low, across(c));
        high = std::max(high, across(c));
    }
    const double third = (high - low) / 3.0;
    // The middle's edge is the mean over its lines along the wind, the horns end where their bands reach furthest.
    double left = -k_far, right = -k_far;
    std::map<int, double> middle_edge;
    std::map<int, std::array<double, 2>> profile; // place along the wind -> sum of sand, cells
    for (const auto& c : dune.cells) {
        const double v = across(c);
        const double u = along(c);
        if (v < low + third) {
            left = std::max(left, u);
        } else if (v > high - third) {
            right = std::max(right, u);
        } else {
            auto& edge = middle_edge.try_emplace(static_cast<int>(std::lround(v)), -k_far).first->second;
            edge = std::max(edge, u);
            auto& p = profile[static_cast<int>(std::lround(u))];
            p[0] += sand.at(c[0], c[1]);
            p[1] += 1.0;
        }
    }
    if (profile.size() < 3 || left == -k_far || right == -k_far) return shape;
    double edge = 0.0;
    for (const auto& [v, u] : middle_edge) edge += u;
    edge /= static_cast<double>(middle_edge.size());
    shape.left_horn_m = (left - edge) * sand.cell_m;
    shape.right_horn_m = (right - edge) * sand.cell_m;

    // Slopes along the line through the centre of the band, which no bend of the edge smears.
    const double centre = (low + high) / 2.0;
    std::map<int, std::array<double, 2>> line;
    for (const auto& c : dune.cells) {
        if (std::abs(across(c) - centre) > 1.0) continue;
        auto& p = line[static_cast<int>(std::lround(along(c)))];
        p[0] += sand.at(c[0], c[1]);
        p[1] += 1.0;
    }
    if (line.size() < 3) return shape;
    int crest = line.begin()->first;
    double top = 0.0;
    for (const auto& [u, p] : line)
        if (p[0] / p[1] > top) {
            top = p[0] / p[1];
            crest = u;
        }
    const int foot = line.begin()->first;
    const double foot_m = line.begin()->second[0] / line.begin()->second[1];
    if (crest > foot) shape.windward_slope = (top - foot_m) / ((crest - foot) * sand.cell_m);
    double before = -1.0;
    for (auto it = line.find(crest); it != line.end(); ++it) {
        const double s = it->second[0] / it->second[1];
        if (before >= 0.0) shape.lee_slope = std::max(shape.lee_slope, (before - s) / sand.cell_m);
        before = s;
    }
    return shape;
}

std::vector<DuneTrack> track_dunes(const std::vector<Dune>& before, const std::vector<Dune>& after, const Plane& plane,
                                   const TrackOptions& options) {
    struct Candidate {
        double miss_m;
        DuneTrack track;
    };
    std::vector<Candidate> candidates;
    for (size_t a = 0; a < before.size(); ++a)
        for (size_t b = 0; b < after.size(); ++b) {
            if (before[a].spans || after[b].spans) continue;
            const double ratio = after[b].volume_m3 / before[a].volume_m3;
            if (ratio > options.volume_ratio || ratio < 1.0 / options.volume_ratio) continue;
            // The way round the seam that comes nearest to the expected shift.
            const double ex = options.expect_x_m;
            const double ey = options.expect_y_m;
            const double miss_x = shortest(before[a].x_m + ex, after[b].x_m, plane.width * plane.cell_m);
            const double miss_y = shortest(before[a].y_m + ey, after[b].y_m, plane.height * plane.cell_m);
            const double miss = std::hypot(miss_x, miss_y);
            const DuneTrack track{a, b, ex + miss_x, ey + miss_y};
            if (std::hypot(track.shift_x_m, track.shift_y_m) > options.reach_m) continue;
            candidates.push_back({miss, track});
        }
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return a.miss_m < b.miss_m; });
    std::vector<uint8_t> used_before(before.size()), used_after(after.size());
    std::vector<DuneTrack> tracks;
    for (const Candidate& c : candidates) {
        if (used_before[c.track.before] || used_after[c.track.after]) continue;
        used_before[c.track.before] = used_after[c.track.after] = 1;
        tracks.push_back(c.track);
    }
    return tracks;
}

std::optional<LogFit> fit_log_log(const std::vector<Vec2>& points) {
    double n = 0.0, sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0, syy = 0.0;
    for (const Vec2& p : points) {
        if (!(p.x > 0.0) || !(p.y > 0.0)) continue;
        const double x = std::log(p.x);
        const double y = std::log(p.y);
        n += 1.0;
        sx += x;
        sy += y;
        sxx += x * x;
        sxy += x * y;
        syy += y * y;
    }
    if (n < 3.0) return std::nullopt;
    const double vx = sxx - sx * sx / n;
    if (vx <= 1.0e-9) return std::nullopt;
    LogFit fit;
    fit.count = static_cast<int>(n);
    fit.slope = (sxy - sx * sy / n) / vx;
    fit.intercept = (sy - fit.slope * sx) / n;
    const double left = std::max(syy - sy * sy / n - fit.slope * (sxy - sx * sy / n), 0.0);
    fit.slope_error = std::sqrt(left / (n - 2.0) / vx);
    return fit;
}

} // namespace sahel::experiments
