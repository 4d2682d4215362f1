#pragma once

#include "render/camera.h"
#include "streaming/region_run.h"
#include "world/world.h"

#include <filesystem>
#include <functional>

/// The first act of the demo: the wind blows over a block of tiles for some hundred steps, which is recorded from
/// above, committed to the world, and flown over afterwards.
namespace sahel::tools {

struct DuneAct {
    TileRect region;
    int64_t steps = 0;
    double seconds = 0.0;
    double ms_per_step = 0.0;
    double mcells_per_s = 0.0;
    std::string video; ///< empty: no encoder, frames lie in a folder that `note` names
    std::string note;
};

/// The square of `side` x `side` tiles that lies before the camera.
TileRect tiles_before(const CameraPose& pose, const WorldDesc& desc, int side);

/// Simulates the region for so many steps from where the world stands and commits. A frame every `every` steps, one
/// pixel a cell. Errors: those of RegionRun, of the video.
Result<DuneAct> blow_dunes(World& world, const TileRect& region, int64_t steps, int every,
                           const std::filesystem::path& video, const std::function<void(int64_t, int64_t)>& progress);

} // namespace sahel::tools
