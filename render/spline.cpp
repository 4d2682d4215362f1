#include "render/spline.h"

#include <algorithm>
#include <cmath>

namespace sahel {

namespace {

using Point = SplineCurve::Point;

Point minus(const Point& a, const Point& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
double length(const Point& a) {
    return std::hypot(a[0], a[1], a[2]);
}

struct HermiteWeights {
    double p0, m0, p1, m1;
};
HermiteWeights hermite(double s) {
    const double s2 = s * s;
    const double s3 = s2 * s;
    return {2 * s3 - 3 * s2 + 1, s3 - 2 * s2 + s, -2 * s3 + 3 * s2, s3 - s2};
}
HermiteWeights hermite_slope(double s) {
    return {6 * s * s - 6 * s, 3 * s * s - 4 * s + 1, -6 * s * s + 6 * s, 3 * s * s - 2 * s};
}

/// Slopes of the monotone cubic through (x, y), y rising (Fritsch and Carlson 1980, with the harmonic mean).
std::vector<double> monotone_slopes(const std::vector<double>& x, const std::vector<double>& y) {
    const size_t n = x.size();
    std::vector<double> chord(n - 1);
    for (size_t i = 0; i + 1 < n; ++i) chord[i] = (y[i + 1] - y[i]) / (x[i + 1] - x[i]);
    std::vector<double> slope(n);
    slope.front() = chord.front();
    slope.back() = chord.back();
    for (size_t i = 1; i + 1 < n; ++i) {
        const double before = x[i] - x[i - 1];
        const double after = x[i + 1] - x[i];
        const double w0 = 2 * after + before;
        const double w1 = after + 2 * before;
        slope[i] = (w0 + w1) / (w0 / chord[i - 1] + w1 / chord[i]);
    }
    return slope;
}

} // namespace

SplineCurve::SplineCurve(std::vector<double> times, std::vector<Point> points, bool ease)
    : times_(std::move(times)), points_(std::move(points)) {
    const size_t n = times_.size();
    knots_.assign(n, 0.0);
    // Equal points get a short knot interval, so that the curve rests there.
    for (size_t i = 1; i < n; ++i)
        knots_[i] = knots_[i - 1] + std::max(1e-3, std::sqrt(length(minus(points_[i], points_[i - 1]))));

    const auto chord = [&](size_t a, size_t b) {
        Point d = minus(points_[b], points_[a]);
        for (double& c : d) c /= knots_[b] - knots_[a];
        return d;
    };
    tangents_.resize(n);
    tangents_.front() = chord(0, 1);
    tangents_.back() = chord(n - 2, n - 1);
    for (size_t i = 1; i + 1 < n; ++i) {
        const Point in = chord(i - 1, i), across = chord(i - 1, i + 1), out = chord(i, i + 1);
        for (size_t c = 0; c < 3; ++c) tangents_[i][c] = in[c] - across[c] + out[c];
    }
    knot_speed_ = monotone_slopes(times_, knots_);
    if (ease) knot_speed_.front() = knot_speed_.back() = 0.0;
}

Point SplineCurve::at(double time, Point* velocity) const {
    const double t = std::clamp(time, times_.front(), times_.back());
    const auto next = std::upper_bound(times_.begin() + 1, times_.end() - 1, t);
    const auto i = static_cast<size_t>(next - times_.begin()) - 1;

    const double interval = times_[i + 1] - times_[i];
    const double s = (t - times_[i]) / interval;
    const HermiteWeights time_w = hermite(s);
    const double knot = knots_[i] * time_w.p0 + knots_[i + 1] * time_w.p1 +
                        interval * (knot_speed_[i] * time_w.m0 + knot_speed_[i + 1] * time_w.m1);
    const double span = knots_[i + 1] - knots_[i];
    const double u = std::clamp((knot - knots_[i]) / span, 0.0, 1.0);
    const HermiteWeights w = hermite(u);
    Point p{};
    for (size_t c = 0; c < 3; ++c)
        p[c] = points_[i][c] * w.p0 + points_[i + 1][c] * w.p1 +
               span * (tangents_[i][c] * w.m0 + tangents_[i + 1][c] * w.m1);
    if (velocity) {
        const HermiteWeights dt = hermite_slope(s);
        const double knot_rate = (knots_[i] * dt.p0 + knots_[i + 1] * dt.p1) / interval + knot_speed_[i] * dt.m0 +
                                 knot_speed_[i + 1] * dt.m1;
        const HermiteWeights du = hermite_slope(u);
        for (size_t c = 0; c < 3; ++c)
            (*velocity)[c] = knot_rate * ((points_[i][c] * du.p0 + points_[i + 1][c] * du.p1) / span +
                                          tangents_[i][c] * du.m0 + tangents_[i + 1][c] * du.m1);
    }
    return p;
}

} // namespace sahel
