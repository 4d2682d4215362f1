#pragma once

#include "render/atmosphere.h"
#include "render/camera_path.h"
#include "streaming/region_run.h"
#include "world/world.h"

#include <string>
#include <vector>

/// Where the demo goes: places worth it are found in the world (render/camera_search.h), not typed in.
namespace sahel::tools {

struct TourStill {
    std::string name;
    CameraPose pose;
    Atmosphere atmosphere;
    double score = 0.0; ///< FoundView::score
};

struct Tour {
    CameraPath flight;
    Atmosphere atmosphere;
    std::vector<TourStill> stills; ///< four, where the landscape has as many
};

/// A flight of `seconds` and stills. A pure function of the world's surface.
Result<Tour> plan_tour(const World& world, double seconds);

/// Looks for the still of the dunes anew, over the tiles in which wind has moved them since the tour was planned: the
/// old eye may lie under sand by now. Views towards the rim of the tiles are the last choice, since the sand beyond it
/// did not move.
Status look_again_at_dunes(const World& world, const TileRect& blown, Tour& tour);

} // namespace sahel::tools
