#pragma once

#include "render/contact_sheet.h"
#include "tools/experiments/plane.h"

#include <optional>
#include <string>
#include <vector>

/// Small diagrams for the sheets: points and lines on linear or logarithmic axes.
namespace sahel::experiments {

struct PlotSeries {
    std::string name;
    std::vector<Vec2> points;
    PixelColour colour{230, 170, 80, 255};
    bool lines = true; ///< else points
};

struct PlotAxis {
    std::string label; ///< with unit
    bool log = false;
    std::optional<double> low; ///< else from the data
    std::optional<double> high;
};

struct Plot {
    PlotAxis x, y;
    std::vector<PlotSeries> series;
    int width_px = 640;
    int height_px = 480;
};

/// Distinct colours, in this order.
PixelColour plot_colour(size_t i);
/// Points that an axis cannot show (not above 0 on a logarithmic one) are left out.
Image draw_plot(const Plot& plot);

} // namespace sahel::experiments
