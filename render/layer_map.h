#pragma once

#include "render/png_io.h"
#include "world/layers.h"
#include "world/surface_source.h"

#include <string>

/// A picture of one layer of the world from above, shaded by the relief: what lies below the tile map, and a quick look
/// at a world without GL.
namespace sahel {

struct LayerMap {
    Image image; ///< RGBA, north up
    double x0_m = 0.0, y0_m = 0.0, side_m = 0.0;
    float low = 0.0f, high = 0.0f; ///< values of the first and the last colour, in the layer's unit
    std::string legend;            ///< "sand, 0 to 12.5 m"
};

/// `pixels` x `pixels` cells around (x, y), which cover at least `side_m`: the level is the finest one that does.
/// Bedrock shows the height of the ground. Errors: those of the source; usage (sizes).
Result<LayerMap> make_layer_map(const SurfaceSource& source, Layer layer, double x_m, double y_m, double side_m,
                                int pixels = 256);

} // namespace sahel
