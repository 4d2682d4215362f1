#pragma once

#include "sim/aeolian.h"
#include "sim/sand_params.h"
#include "sim/wind_params.h"
#include "world/result.h"
#include "world/world.h"

#include <filesystem>
#include <string>
#include <string_view>

/// What a world's `simulation` says (world.json keeps it as it is, see WorldDesc):
///
///     "simulation": { "wind": { "speed": 5, ... }, "sand": { "lift_rate": 1, ... }, "rose": "winds.csv" }
///
/// Keys, ranges and defaults are those of the field tables; a missing key has its default. `rose` is a file in the world's
/// folder with a series of winds (wind_schedule.h; JSON if it ends so, else CSV), or nothing.
namespace sahel {

struct SimulationParams {
    WindParams wind;
    SandParams sand;
    std::string rose;
};

/// For a new world: the wind blows as the one that shaped the dunes of its terrain.
SimulationParams default_simulation(const WorldDesc& desc);
std::string simulation_json(const SimulationParams& params);
/// Of an open world; a world without one has the defaults. Errors: usage (unknown key, type, range).
Result<SimulationParams> simulation_of(const WorldDesc& desc, std::string_view where);
/// "sand.lift_rate=0.5". Errors: usage (names `where`, the nearest key, the range).
Status set_simulation(SimulationParams& params, std::string_view assignment, std::string_view where);

/// Reads the rose, if there is one. Errors: not_found, usage.
Result<Aeolian::Desc> aeolian_desc(const SimulationParams& params, const WorldDesc& desc,
                                   const std::filesystem::path& world_folder);

} // namespace sahel
