#include "render/view_panorama.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sahel {

namespace {
constexpr double k_rad = std::numbers::pi / 180.0;
constexpr double k_earth_radius_m = 6371000.0;
constexpr int k_finest_level = 1; // 2 m cells: ripples do not matter here
constexpr int k_coarsest_level = 9;
} // namespace

ViewTerrain::ViewTerrain(const SurfaceSource& source, uint64_t max_bytes)
    : source_(source), max_blocks_(std::max<uint64_t>(16, max_bytes / (k_side * k_side * (sizeof(float) + 1)))) {}

double ViewTerrain::cell_m(int level) const {
    return std::ldexp(source_.cell_m(), level);
}

const ViewTerrain::Block& ViewTerrain::block(TileKey key) {
    if (last_ && key == last_key_) return *last_;
    auto found = blocks_.find(key);
    if (found == blocks_.end()) {
        if (blocks_.size() >= max_blocks_) blocks_.clear();
        auto made = std::make_unique<Block>();
        made->surface_m.assign(k_side * k_side, 0.0f);
        made->material.assign(k_side * k_side, ViewMaterial::rock);
        auto cells = LayerBlock::allocate(key.level, tile_rect(key, k_side), 0, k_surface_layers);
        if (cells.ok() && source_.read(*cells).ok()) {
            const auto rock = cells->ints(Layer::bedrock), soil = cells->ints(Layer::soil);
            const auto sand = cells->ints(Layer::sand), water = cells->ints(Layer::water);
            for (int y = 0; y < k_side; ++y)
                for (int x = 0; x < k_side; ++x) {
                    const auto i = static_cast<size_t>(y * k_side + x);
                    made->surface_m[i] = metres_of_ticks(rock(x, y) + soil(x, y) + sand(x, y) + water(x, y));
                    made->material[i] = metres_of_ticks(water(x, y)) > 0.05f  ? ViewMaterial::water
                                        : metres_of_ticks(sand(x, y)) > 0.25f ? ViewMaterial::sand
                                        : metres_of_ticks(soil(x, y)) > 0.15f ? ViewMaterial::soil
                                                                              : ViewMaterial::rock;
                }
        } else {
            failed_ = true;
        }
        found = blocks_.emplace(key, std::move(made)).first;
    }
    last_key_ = key;
    last_ = found->second.get();
    return *last_;
}

ViewTerrain::Cell ViewTerrain::at(int level, double x_m, double y_m) {
    const double cell = cell_m(level);
    const auto x = static_cast<int64_t>(std::floor(x_m / cell));
    const auto y = static_cast<int64_t>(std::floor(y_m / cell));
    const Block& b = block(tile_of({x, y}, level, k_side));
    const auto i = static_cast<size_t>(floor_mod(y, k_side) * k_side + floor_mod(x, k_side));
    return {b.surface_m[i], b.material[i]};
}

std::pair<float, float> ViewTerrain::slope(int level, double x_m, double y_m) {
    const double cell = cell_m(level);
    const auto two = static_cast<float>(2.0 * cell);
    const float east = at(level, x_m + cell, y_m).surface_m - at(level, x_m - cell, y_m).surface_m;
    const float south = at(level, x_m, y_m + cell).surface_m - at(level, x_m, y_m - cell).surface_m;
    return {east / two, south / two};
}

Panorama cast_panorama(ViewTerrain& terrain, const Vec3d& eye_m, double reach_m) {
    Panorama p;
    p.pixels.resize(static_cast<size_t>(Panorama::k_columns) * Panorama::k_rows);
    p.skyline_deg.assign(Panorama::k_columns, -90.0f);
    p.skyline_m.assign(Panorama::k_columns, 0.0f);
    p.near_rise_deg.assign(Panorama::k_columns, -90.0f);

    for (int column = 0; column < Panorama::k_columns; ++column) {
        const double azimuth = (column + 0.5) * Panorama::k_step_deg * k_rad;
        const double dx = std::cos(azimuth), dy = std::sin(azimuth);
        const auto c = static_cast<size_t>(column);
        int row = Panorama::k_rows; // the lowest row that is not filled yet lies above it
        double step = 2.0;
        for (double d = 2.0; d < reach_m && row > 0; d += step) {
            step = std::max(2.0, 0.035 * d);
            int level = k_finest_level;
            while (level < k_coarsest_level && terrain.cell_m(level + 1) <= step) ++level;
            const double x = eye_m[0] + dx * d, y = eye_m[1] + dy * d;
            const ViewTerrain::Cell cell = terrain.at(level, x, y);
            const double rise = static_cast<double>(cell.surface_m) - eye_m[2] - d * d / (2.0 * k_earth_radius_m);
            const auto elevation = static_cast<float>(std::atan2(rise, d) / k_rad);
            if (d <= 40.0) p.near_rise_deg[c] = std::max(p.near_rise_deg[c], elevation);
            if (elevation <= p.skyline_deg[c]) continue;
            p.skyline_deg[c] = elevation;
            p.skyline_m[c] = static_cast<float>(d);
            // The first row whose middle lies below the surface.
            const auto top = static_cast<int>(
                std::ceil((Panorama::k_top_deg - static_cast<double>(elevation)) / Panorama::k_step_deg - 0.5));
            if (top >= row) continue;
            const auto [east, south] = terrain.slope(level, x, y);
            const Panorama::Pixel pixel{static_cast<float>(d), east, south, cell.material};
            for (int r = std::max(top, 0); r < row; ++r)
                p.pixels[static_cast<size_t>(r * Panorama::k_columns + column)] = pixel;
            row = std::max(top, 0);
        }
    }
    return p;
}

} // namespace sahel
