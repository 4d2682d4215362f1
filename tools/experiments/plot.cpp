#include "tools/experiments/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

namespace sahel::experiments {

namespace {

constexpr PixelColour k_paper{32, 32, 35, 255};
constexpr PixelColour k_grid{62, 62, 66, 255};
constexpr PixelColour k_ink{210, 206, 196, 255};
constexpr int k_left = 64, k_right = 16, k_top = 16, k_bottom = 52;

void put(Image& image, int x, int y, PixelColour c) {
    if (x < 0 || y < 0 || x >= image.width_px || y >= image.height_px) return;
    std::copy(c.begin(), c.end(), image.at(x, y));
}

void disc(Image& image, double cx, double cy, double radius, PixelColour c) {
    for (int y = static_cast<int>(cy - radius); y <= static_cast<int>(cy + radius) + 1; ++y)
        for (int x = static_cast<int>(cx - radius); x <= static_cast<int>(cx + radius) + 1; ++x)
            if (std::hypot(x - cx, y - cy) <= radius) put(image, x, y, c);
}

void stroke(Image& image, Vec2 a, Vec2 b, double radius, PixelColour c) {
    const int n = static_cast<int>(std::max(std::abs(b.x - a.x), std::abs(b.y - a.y)) * 2.0) + 1;
    for (int i = 0; i <= n; ++i) {
        const double t = static_cast<double>(i) / n;
        disc(image, a.x + (b.x - a.x) * t, a.y + (b.y - a.y) * t, radius, c);
    }
}

/// An axis in use: what it shows, where its marks stand.
struct Scale {
    bool log = false;
    double low = 0.0, high = 1.0; ///< of the logarithm, on a logarithmic axis
    std::vector<double> marks;

    [[nodiscard]] bool shows(double v) const { return !log || v > 0.0; }
    [[nodiscard]] double share(double v) const { return ((log ? std::log10(v) : v) - low) / (high - low); }
};

Scale scale_of(const PlotAxis& axis, const std::vector<double>& values) {
    Scale s;
    s.log = axis.log;
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (const double v : values) {
        if (!std::isfinite(v) || !s.shows(v)) continue;
        low = std::min(low, s.log ? std::log10(v) : v);
        high = std::max(high, s.log ? std::log10(v) : v);
    }
    if (!(low <= high)) low = 0.0, high = 1.0;
    const double margin = high > low ? 0.05 * (high - low) : 0.5;
    s.low = axis.low ? (s.log ? std::log10(*axis.low) : *axis.low) : low - margin;
    s.high = axis.high ? (s.log ? std::log10(*axis.high) : *axis.high) : high + margin;
    if (s.log) {
        for (int decade = static_cast<int>(std::floor(s.low)); decade <= s.high; ++decade)
            for (const double m : {1.0, 2.0, 5.0})
                if (const double v = m * std::pow(10.0, decade); std::log10(v) >= s.low && std::log10(v) <= s.high)
                    s.marks.push_back(v);
        return s;
    }
    const double raw = (s.high - s.low) / 6.0;
    const double power = std::pow(10.0, std::floor(std::log10(raw)));
    const double step = power * (raw > 5.0 * power ? 10.0 : raw > 2.0 * power ? 5.0 : 2.0);
    for (double v = std::ceil(s.low / step) * step; v <= s.high + 1.0e-9 * step; v += step)
        s.marks.push_back(std::abs(v) < 1.0e-9 * step ? 0.0 : v);
    return s;
}

} // namespace

PixelColour plot_colour(size_t i) {
    constexpr std::array<PixelColour, 6> k_colours = {{{236, 176, 84, 255},
                                                       {104, 176, 232, 255},
                                                       {132, 204, 124, 255},
                                                       {232, 112, 100, 255},
                                                       {188, 144, 226, 255},
                                                       {220, 220, 214, 255}}};
    return k_colours[i % k_colours.size()];
}

Image draw_plot(const Plot& plot) {
    Image image(plot.width_px, plot.height_px, 4);
    for (int y = 0; y < image.height_px; ++y)
        for (int x = 0; x < image.width_px; ++x) put(image, x, y, k_paper);
    std::vector<double> xs, ys;
    for (const PlotSeries& s : plot.series)
        for (const Vec2& p : s.points) {
            xs.push_back(p.x);
            ys.push_back(p.y);
        }
    const Scale sx = scale_of(plot.x, xs);
    const Scale sy = scale_of(plot.y, ys);
    const int right = plot.width_px - k_right;
    const int bottom = plot.height_px - k_bottom;
    const auto place = [&](Vec2 p) {
        return Vec2{k_left + sx.share(p.x) * (right - k_left), bottom - sy.share(p.y) * (bottom - k_top)};
    };
    const TextPainter small(13.0f);
    for (const double v : sx.marks) {
        const auto x = static_cast<int>(k_left + sx.share(v) * (right - k_left));
        for (int y = k_top; y <= bottom; ++y) put(image, x, y, k_grid);
        const std::string text = fmt::format("{:.4g}", v);
        small.draw(image, x - small.width_px(text) / 2, bottom + 4, text, k_ink);
    }
    for (const double v : sy.marks) {
        const auto y = static_cast<int>(bottom - sy.share(v) * (bottom - k_top));
        for (int x = k_left; x <= right; ++x) put(image, x, y, k_grid);
        const std::string text = fmt::format("{:.4g}", v);
        small.draw(image, k_left - 6 - small.width_px(text), y - small.line_px() / 2, text, k_ink);
    }
    const TextPainter ink(14.0f);
    ink.draw(image, (k_left + right - ink.width_px(plot.x.label)) / 2, bottom + 24, plot.x.label, k_ink);
    ink.draw(image, k_left + 6, k_top + 2, plot.y.label, k_ink);
    int line = 0;
    for (const PlotSeries& s : plot.series) {
        std::vector<Vec2> at;
        for (const Vec2& p : s.points)
            if (std::isfinite(p.x) && std::isfinite(p.y) && sx.shows(p.x) && sy.shows(p.y)) at.push_back(place(p));
        for (size_t i = 0; i < at.size(); ++i) {
            if (s.lines && i > 0) stroke(image, at[i - 1], at[i], 0.8, s.colour);
            if (!s.lines) disc(image, at[i].x, at[i].y, 4.0, s.colour);
        }
        if (!s.name.empty()) {
            ink.draw(image, right - 8 - ink.width_px(s.name), k_top + 2 + line * ink.line_px(), s.name, s.colour);
            ++line;
        }
    }
    return image;
}

} // namespace sahel::experiments
