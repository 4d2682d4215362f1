#pragma once

#include "streaming/scene_file.h"

#include <cstdint>
#include <string>
#include <vector>

/// The columns a scene starts with: generators first, then the maps that lie beside the file.
///
///     NAME.json.terrain.exr      R bedrock, G sand (Oasis: B soil, A water), m
///     NAME.json.resistance.exr   G vegetation, below 0: solid object (Oasis: no plants), B resistance to abrasion;
///                                R (wind shadow) and A (echo class) are derived and not read
///
/// Line y of a map is row y of the grid, column x is column x: no flip. The size of a map is the size of the grid.
///
/// A smaller (or larger) run, `size`: the longer side gets so many cells of the same size, the shorter one in
/// proportion. Generated layers are cropped to the window that stands best for the whole (scene_terrain.h), so hills
/// and dunes keep their size in metres. Maps are resampled at cell centres: an obstacle or a disc of plants becomes a
/// smaller one of the same height, because a cropped one would not be the scene any more.
namespace sahel {

struct SceneGroundOptions {
    int size = 0;             ///< cells along the longer side; 0: as published
    bool keep_sticky = false; ///< take the echo class from the map, as the published program does
};

struct SceneGround {
    int32_t width = 0;
    int32_t height = 0;
    SceneWindow window;   ///< of the generated layers
    bool mapped = false;  ///< a map was read
    bool rebuilt = false; ///< the obstacle stands by its rule, its map is missing
    // Row after row; m, or 0 to 1.
    std::vector<float> bedrock_m, sand_m, soil_m, water_m, moisture_m;
    std::vector<float> vegetation, resistance;
    std::vector<float> echo; ///< empty unless kept
    std::vector<uint8_t> object;
    std::vector<std::string> notes;

    [[nodiscard]] size_t cells() const { return static_cast<size_t>(width) * static_cast<size_t>(height); }
    /// Cells along one side of this run for each of the scene's.
    double scale = 1.0;
};

/// Sides are multiples of this (tiles of a run).
inline constexpr int k_scene_side_step = 32;

/// The obstacle of the published scenes (4.6): a half disc of radius 150 facing the wind and a block of 400 x 300 cells
/// behind it, 100 m high. `rim`: cells by which it is widened (2 for the mask of objects).
bool scene_obstacle(int32_t full_width, int32_t full_height, int32_t x, int32_t y, int32_t rim);

/// Errors: usage (sizes), corrupt (a map that is no map, heights that are no heights), budget-free otherwise.
Result<SceneGround> make_scene_ground(const Scene& scene, const SceneGroundOptions& options = {});

} // namespace sahel
