#include "streaming/simulation_params.h"
#include "tools/command.h"
#include "world/params_cli.h"
#include "world/world.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>

namespace sahel::tools {

namespace {

struct Options {
    std::string world;
    std::string preset = "oasis";
    ParamOverrides<BaseTerrainParams> terrain;
    uint64_t seed = 1;
    int tile_cells = 2048;
    double cell_m = 1.0;
};

int run(const Options& o) {
    auto terrain = base_terrain_preset(o.preset);
    if (!terrain.ok()) return fail(terrain.error());
    WorldDesc desc;
    desc.name = std::filesystem::path(o.world).filename().string();
    if (desc.name.empty()) desc.name = std::filesystem::path(o.world).parent_path().filename().string();
    desc.seed = o.seed;
    desc.preset = o.preset;
    desc.terrain = *terrain;
    desc.tile_cells = o.tile_cells;
    desc.cell_m = o.cell_m;
    o.terrain.apply(desc.terrain);
    desc.simulation = simulation_json(default_simulation(desc));
    auto world = World::create(o.world, desc);
    if (!world.ok()) return fail(world.error());
    fmt::print("New world '{}' in {}: preset {}, seed {}, tiles of {} x {} cells of {} m\n", desc.name, o.world,
               o.preset, o.seed, o.tile_cells, o.tile_cells, o.cell_m);
    return 0;
}

} // namespace

void add_new_command(CommandLine& line) {
    auto o = std::make_shared<Options>();
    CLI::App& app = line.add("new", "Make a world: a folder with a seed; its land is generated where it is visited",
                             [=] { return run(*o); });
    app.add_option("WORLD", o->world, "Folder to make")->required();
    std::string names;
    for (const std::string_view name : base_terrain_presets()) names += (names.empty() ? "" : ", ") + std::string(name);
    app.add_option("--preset", o->preset, "Landscape: " + names)->capture_default_str();
    app.add_option("--seed", o->seed, "Seed of everything random in it")->capture_default_str();
    app.add_option("--tile", o->tile_cells, "Cells along a tile's side, a power of two from 128")
        ->capture_default_str();
    app.add_option("--cell", o->cell_m, "Side of a cell, m")->capture_default_str();
    add_params_options(app, "terrain", o->terrain);
}

} // namespace sahel::tools
