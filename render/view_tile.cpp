#include "render/view_tile.h"

#include "render/view_bake.h"
#include "world/noise.h"

#include <algorithm>
#include <cmath>

namespace sahel {

namespace {

constexpr int k_halo = 18; ///< cells read around the tile: 8 for the border, 15 for one ring of the coarsest lattice
constexpr int k_side = k_view_cells + 2 * k_halo;
constexpr float k_wet_m = 0.02f;         ///< thinner water is not drawn
constexpr float k_below_ground_m = 2.0f; ///< where the water surface lies when there is no water near

/// A square lattice of values with a ring around the tile; index -ring is the first.
struct Lattice2 {
    int first = 0; ///< index of the first sample, negative
    int side = 0;
    std::vector<float> v;

    Lattice2(int first_index, int last_index)
        : first(first_index), side(last_index - first_index + 1), v(static_cast<size_t>(side) * side) {}
    float& at(int i, int j) { return v[static_cast<size_t>((j - first) * side + (i - first))]; }
    [[nodiscard]] float at(int i, int j) const { return v[static_cast<size_t>((j - first) * side + (i - first))]; }
};

/// Every second sample of a 3 x 3 tent over the finer lattice. The order of the additions is part of the result: two
/// tiles that share a corner compute the same float.
Lattice2 coarser(const Lattice2& fine, int first, int last) {
    Lattice2 out(first, last);
    for (int j = first; j <= last; ++j)
        for (int i = first; i <= last; ++i) {
            const auto row = [&](int y) {
                return (fine.at(2 * i - 1, y) + fine.at(2 * i + 1, y)) + 2.0f * fine.at(2 * i, y);
            };
            out.at(i, j) = ((row(2 * j - 1) + row(2 * j + 1)) + 2.0f * row(2 * j)) * (1.0f / 16.0f);
        }
    return out;
}

struct Cells {
    std::vector<float> ground, water; ///< m, k_side^2; water depth
    [[nodiscard]] size_t index(int x, int y) const { return static_cast<size_t>((y + k_halo) * k_side + x + k_halo); }
};

/// Sum over the four cells around corner (2i, 2j).
template <class F> float corner_sum(int i, int j, F&& value) {
    return (value(2 * i - 1, 2 * j - 1) + value(2 * i, 2 * j - 1)) + (value(2 * i - 1, 2 * j) + value(2 * i, 2 * j));
}

struct Lattices {
    std::array<Lattice2, k_lattice_count> ground, water;
    Lattice2 reach; ///< of the coarsest one: 1 where water stands near enough that its surface is known
};

/// The water surface is known where water stands. Amount (level times share) and share are filtered like the ground, so
/// level = amount / share reaches as far beyond the shore as the filter does; one more ring comes from the neighbours.
Lattices make_lattices(const Cells& c) {
    Lattice2 g2(-7, 263), w2(-7, 263), s2(-7, 263);
    for (int j = g2.first; j < g2.first + g2.side; ++j)
        for (int i = g2.first; i < g2.first + g2.side; ++i) {
            g2.at(i, j) = 0.25f * corner_sum(i, j, [&](int x, int y) { return c.ground[c.index(x, y)]; });
            const auto wet = [&](int x, int y) { return c.water[c.index(x, y)] > k_wet_m ? 1.0f : 0.0f; };
            s2.at(i, j) = 0.25f * corner_sum(i, j, wet);
            w2.at(i, j) = 0.25f * corner_sum(i, j, [&](int x, int y) {
                              return wet(x, y) * (c.ground[c.index(x, y)] + c.water[c.index(x, y)]);
                          });
        }
    Lattice2 g4 = coarser(g2, -3, 131), w4 = coarser(w2, -3, 131), s4 = coarser(s2, -3, 131);
    Lattice2 g8 = coarser(g4, -1, 65), w8 = coarser(w4, -1, 65), s8 = coarser(s4, -1, 65);
    // Levels of the coarsest lattice, with one ring of dilation.
    Lattice2 known(-1, 65), level(-1, 65);
    for (size_t i = 0; i < level.v.size(); ++i) {
        known.v[i] = s8.v[i] > 1e-4f ? 1.0f : 0.0f;
        level.v[i] = known.v[i] > 0.0f ? w8.v[i] / s8.v[i] : 0.0f;
    }
    Lattice2 water8(0, 64), reach8(0, 64);
    for (int j = 0; j <= 64; ++j)
        for (int i = 0; i <= 64; ++i) {
            float sum = level.at(i, j), count = known.at(i, j);
            if (count == 0.0f)
                for (int dj = -1; dj <= 1; ++dj)
                    for (int di = -1; di <= 1; ++di) {
                        sum += level.at(i + di, j + dj) * known.at(i + di, j + dj);
                        count += known.at(i + di, j + dj);
                    }
            reach8.at(i, j) = count > 0.0f ? 1.0f : 0.0f;
            water8.at(i, j) = count > 0.0f ? sum / count : g8.at(i, j) - k_below_ground_m;
        }
    // Finer water lattices follow the coarsest one where they know nothing themselves.
    const auto finer = [&](const Lattice2& amount, const Lattice2& share, const Lattice2& ground, int step) {
        Lattice2 out(0, 512 / step);
        const int ratio = 8 / step;
        for (int j = 0; j < out.side; ++j)
            for (int i = 0; i < out.side; ++i) {
                if (share.at(i, j) > 1e-4f) {
                    out.at(i, j) = amount.at(i, j) / share.at(i, j);
                    continue;
                }
                const int ci = std::min(i / ratio, 63), cj = std::min(j / ratio, 63);
                const float a = static_cast<float>(i - ci * ratio) / static_cast<float>(ratio);
                const float b = static_cast<float>(j - cj * ratio) / static_cast<float>(ratio);
                const bool reached =
                    reach8.at(ci, cj) * reach8.at(ci + 1, cj) * reach8.at(ci, cj + 1) * reach8.at(ci + 1, cj + 1) >
                    0.0f;
                const float top = water8.at(ci, cj) + a * (water8.at(ci + 1, cj) - water8.at(ci, cj));
                const float bottom = water8.at(ci, cj + 1) + a * (water8.at(ci + 1, cj + 1) - water8.at(ci, cj + 1));
                out.at(i, j) = reached ? top + b * (bottom - top) : ground.at(i, j) - k_below_ground_m;
            }
        return out;
    };
    Lattice2 water2 = finer(w2, s2, g2, 2), water4 = finer(w4, s4, g4, 4);
    return {{std::move(g2), std::move(g4), std::move(g8)},
            {std::move(water2), std::move(water4), std::move(water8)},
            std::move(reach8)};
}

int16_t snorm16(float v) {
    return static_cast<int16_t>(std::lround(std::clamp(v, -1.0f, 1.0f) * 32767.0f));
}
uint8_t unorm8(float v) {
    return static_cast<uint8_t>(std::clamp(v, 0.0f, 1.0f) * 255.0f + 0.5f);
}

template <class Texel, class Average> void fill_mips(MipChain<Texel>& chain, int side, Average&& average) {
    for (int m = 1; m < k_view_mips; ++m, side /= 2) {
        const std::vector<Texel>& from = chain[static_cast<size_t>(m - 1)];
        std::vector<Texel>& to = chain[static_cast<size_t>(m)];
        const int half = side / 2;
        to.resize(static_cast<size_t>(half) * half);
        for (int y = 0; y < half; ++y)
            for (int x = 0; x < half; ++x) {
                const Texel* p = &from[static_cast<size_t>(2 * y * side + 2 * x)];
                to[static_cast<size_t>(y * half + x)] = average(p[0], p[1], p[side], p[side + 1]);
            }
    }
}
void fill_mips(MipChain<Snorm16x2>& chain) {
    fill_mips(chain, k_view_texels, [](Snorm16x2 a, Snorm16x2 b, Snorm16x2 c, Snorm16x2 d) {
        return Snorm16x2{static_cast<int16_t>((a.x + b.x + c.x + d.x) / 4),
                         static_cast<int16_t>((a.y + b.y + c.y + d.y) / 4)};
    });
}
void fill_mips(MipChain<Rgba8>& chain, int side) {
    fill_mips(chain, side, [](Rgba8 a, Rgba8 b, Rgba8 c, Rgba8 d) {
        const auto mean = [](int w, int x, int y, int z) { return static_cast<uint8_t>((w + x + y + z + 2) / 4); };
        return Rgba8{mean(a.r, b.r, c.r, d.r), mean(a.g, b.g, c.g, d.g), mean(a.b, b.b, c.b, d.b),
                     mean(a.a, b.a, c.a, d.a)};
    });
}

/// The corners of the coarsest lattice around a cell, and their shares: lattice corner i lies at cell 8 i.
struct CoarseCorners {
    int i, j;
    float a, b;

    /// Corners [first, last].
    CoarseCorners(int x, int y, int first, int last) {
        const auto least = static_cast<float>(first), most = static_cast<float>(last) - 1e-3f;
        const float u = std::clamp((static_cast<float>(x) + 0.5f) * 0.125f, least, most);
        const float v = std::clamp((static_cast<float>(y) + 0.5f) * 0.125f, least, most);
        i = static_cast<int>(std::floor(u));
        j = static_cast<int>(std::floor(v));
        a = u - static_cast<float>(i);
        b = v - static_cast<float>(j);
    }
    float mix(const Lattice2& l) const {
        const float top = l.at(i, j) + a * (l.at(i + 1, j) - l.at(i, j));
        const float bottom = l.at(i, j + 1) + a * (l.at(i + 1, j + 1) - l.at(i, j + 1));
        return top + b * (bottom - top);
    }
    /// The mean of those corners alone where `known` is not 0.
    float mean(const Lattice2& l, const Lattice2& known) const {
        float sum = 0.0f, shares = 0.0f;
        for (int n = 0; n < 4; ++n) {
            const int x = i + n % 2, y = j + n / 2;
            const float share = (n % 2 ? a : 1.0f - a) * (n / 2 ? b : 1.0f - b) * known.at(x, y);
            sum += share * l.at(x, y);
            shares += share;
        }
        return sum / shares;
    }
};

/// Water near a cell: its height minus the ground there, m, and how far it is known: 0 where none is near.
struct WaterNear {
    float above_m = -k_below_ground_m;
    float known = 0.0f;
};
WaterNear water_near(const Cells& c, const Lattices& l, int x, int y) {
    const float depth = c.water[c.index(x, y)];
    if (depth > k_wet_m) return {depth, 1.0f};
    const CoarseCorners corners(x, y, 0, 64);
    const float known = corners.mix(l.reach);
    if (known <= 1e-3f) return {};
    return {std::min(corners.mean(l.water[2], l.reach) - c.ground[c.index(x, y)], 0.0f), known};
}

/// Wind, shelter and sand in the air; nothing where no wind was simulated.
void fill_wind(const LayerBlock& block, ViewTile& tile) {
    const auto wind_x = block.reals(Layer::wind_x), wind_y = block.reals(Layer::wind_y);
    const auto shelter = block.reals(Layer::wind_shadow);
    const auto air = block.ints(Layer::airborne_sand);
    constexpr int k_half = k_view_texels / 2;
    const auto blown = [&] {
        for (int y = -k_view_border; y < k_view_cells + k_view_border; y += 2)
            for (int x = -k_view_border; x < k_view_cells + k_view_border; x += 2)
                if (wind_x(x, y) != 0.0f || wind_y(x, y) != 0.0f) return true;
        return false;
    };
    if (!blown()) return;
    tile.wind[0].resize(static_cast<size_t>(k_half) * k_half);
    const auto encoded = [](float m_per_s) {
        return static_cast<uint8_t>(
            std::lround(128.0f + std::clamp(m_per_s * k_wind_unit_per_m_per_s, -127.0f, 127.0f)));
    };
    for (int j = 0; j < k_half; ++j)
        for (int i = 0; i < k_half; ++i) {
            const int x = 2 * i - k_view_border, y = 2 * j - k_view_border;
            const auto mean = [&](const auto& field) {
                return 0.25f * (static_cast<float>(field(x, y)) + static_cast<float>(field(x + 1, y)) +
                                static_cast<float>(field(x, y + 1)) + static_cast<float>(field(x + 1, y + 1)));
            };
            tile.wind[0][static_cast<size_t>(j * k_half + i)] = {encoded(mean(wind_x)), encoded(mean(wind_y)),
                                                                 unorm8(mean(shelter)),
                                                                 unorm8(mean(air) * k_m_per_tick * 2.0f)};
        }
    fill_mips(tile.wind, k_half);
}

} // namespace

uint64_t ViewTile::bytes() const {
    uint64_t sum = sizeof(*this);
    for (const auto& v : ground_m) sum += v.size() * sizeof(float);
    for (const auto& v : water_m) sum += v.size() * sizeof(float);
    for (const auto& v : normal) sum += v.size() * sizeof(Snorm16x2);
    for (const auto& v : material) sum += v.size() * sizeof(Rgba8);
    for (const auto& v : bake) sum += v.size() * sizeof(Rgba8);
    for (const auto& v : water) sum += v.size() * sizeof(Snorm16x2);
    for (const auto& v : wind) sum += v.size() * sizeof(Rgba8);
    return sum;
}

std::shared_ptr<const TileContext> ViewTile::context() const {
    return height_context;
}

uint64_t view_tile_max_bytes() {
    uint64_t texels = 0, lattice = 0;
    for (int m = 0, side = k_view_texels; m < k_view_mips; ++m, side /= 2)
        texels += static_cast<uint64_t>(side) * side * 12 + static_cast<uint64_t>(side / 2) * (side / 2) * 8;
    for (const int side : k_lattice_side) lattice += static_cast<uint64_t>(side) * side * 2 * sizeof(float);
    return sizeof(ViewTile) + texels + lattice;
}

void WaterBlocks::add(int cell_x, int cell_y) {
    constexpr int k_last = k_view_cells / k_block - 1;
    const int x = std::clamp(cell_x / k_block, 0, k_last), y = std::clamp(cell_y / k_block, 0, k_last);
    const auto around = static_cast<uint16_t>(0b111u << x >> 1);
    for (int row = std::max(y - 1, 0); row <= std::min(y + 1, k_last); ++row) rows_[static_cast<size_t>(row)] |= around;
}

bool WaterBlocks::any(int cell_x, int cell_y, int side) const {
    const int blocks = side / k_block;
    const uint32_t columns = ((1u << blocks) - 1u) << (cell_x / k_block);
    const auto first = rows_.begin() + cell_y / k_block;
    return std::any_of(first, first + blocks, [&](uint16_t row) { return (row & columns) != 0; });
}

Result<std::unique_ptr<ViewTile>> build_view_tile(const SurfaceSource& source, TileKey key, const SunDirection& sun,
                                                  const std::shared_ptr<const TileContext>& parent) {
    const LayerSet wanted = k_surface_layers.united(
        {Layer::moisture, Layer::wetness, Layer::wind_x, Layer::wind_y, Layer::wind_shadow, Layer::airborne_sand});
    SAHEL_ASSIGN(LayerBlock block, LayerBlock::allocate(key.level, tile_rect(key, k_view_cells), k_halo, wanted));
    SAHEL_TRY(source.read(block));

    auto tile = std::make_unique<ViewTile>();
    tile->key = key;
    tile->cell_m = std::ldexp(source.cell_m(), key.level);
    const auto cell = static_cast<float>(tile->cell_m);

    Cells c;
    c.ground.resize(static_cast<size_t>(k_side) * k_side);
    c.water.resize(c.ground.size());
    const auto rock = block.ints(Layer::bedrock), soil = block.ints(Layer::soil);
    const auto sand = block.ints(Layer::sand), water = block.ints(Layer::water);
    for (int y = -k_halo; y < k_view_cells + k_halo; ++y)
        for (int x = -k_halo; x < k_view_cells + k_halo; ++x) {
            c.ground[c.index(x, y)] = metres_of_ticks(rock(x, y) + soil(x, y) + sand(x, y));
            c.water[c.index(x, y)] = metres_of_ticks(water(x, y));
        }

    Lattices lattices = make_lattices(c);
    float low = 1e30f, high = -1e30f;
    for (int k = 0; k < k_lattice_count; ++k) {
        if (key.level > 0 && k + 1 < k_lattice_count) continue; // only level 0 draws nodes finer than 8 cells
        const auto n = static_cast<size_t>(k);
        const int side = k_lattice_side[n];
        tile->ground_m[n].resize(static_cast<size_t>(side) * side);
        tile->water_m[n].resize(static_cast<size_t>(side) * side);
        for (int j = 0; j < side; ++j)
            for (int i = 0; i < side; ++i) {
                const auto at = static_cast<size_t>(j * side + i);
                const float g = lattices.ground[n].at(i, j), w = lattices.water[n].at(i, j);
                tile->ground_m[n][at] = g;
                tile->water_m[n][at] = w;
                low = std::min(low, std::min(g, w));
                high = std::max(high, std::max(g, w));
            }
    }
    tile->min_m = low;
    tile->max_m = high;

    // Context for the children, then the light.
    auto context = std::make_shared<ViewTileContext>();
    context->key = key;
    context->cell_m = tile->cell_m;
    context->parent = std::static_pointer_cast<const ViewTileContext>(parent);
    context->ground_m.resize(static_cast<size_t>(ViewTileContext::k_side) * ViewTileContext::k_side);
    context->max_m = -1e30f;
    for (int j = 0; j < ViewTileContext::k_side; ++j)
        for (int i = 0; i < ViewTileContext::k_side; ++i) {
            float sum = 0.0f;
            for (int y = 0; y < 4; ++y)
                for (int x = 0; x < 4; ++x)
                    sum += c.ground[c.index(4 * i - k_view_border + x, 4 * j - k_view_border + y)];
            context->ground_m[static_cast<size_t>(j * ViewTileContext::k_side + i)] = sum * (1.0f / 16.0f);
        }
    for (const float h : c.ground) context->max_m = std::max(context->max_m, h);
    const HeightChain chain(c.ground, k_side, -k_halo, *context);
    std::vector<float> sun_seen, sky_seen;
    bake_sun(chain, tile->cell_m, sun, sun_seen);
    bake_sky(chain, tile->cell_m, sky_seen);
    tile->bake[0].resize(sun_seen.size());
    for (size_t i = 0; i < sun_seen.size(); ++i) tile->bake[0][i] = {unorm8(sun_seen[i]), unorm8(sky_seen[i]), 0, 0};
    fill_mips(tile->bake, k_view_texels / 2);

    // Normals, materials, water.
    const auto wetness = block.reals(Layer::wetness);
    const auto moisture = block.ints(Layer::moisture);
    const auto texels = static_cast<size_t>(k_view_texels) * k_view_texels;
    tile->normal[0].resize(texels);
    tile->material[0].resize(texels);
    tile->water[0].resize(texels);
    // Differences over two cells, smoothed across (Sobel): a crest that runs askew to the cells does not become a saw.
    const float inverse = 0.125f / cell;
    for (int j = 0; j < k_view_texels; ++j)
        for (int i = 0; i < k_view_texels; ++i) {
            const int x = i - k_view_border, y = j - k_view_border;
            const auto at = static_cast<size_t>(j * k_view_texels + i);
            const float* p = &c.ground[c.index(x, y)];
            const float gx =
                ((p[1 - k_side] - p[-1 - k_side]) + (p[1 + k_side] - p[-1 + k_side]) + 2.0f * (p[1] - p[-1])) * inverse;
            const float gy = ((p[k_side - 1] - p[-k_side - 1]) + (p[k_side + 1] - p[-k_side + 1]) +
                              2.0f * (p[k_side] - p[-k_side])) *
                             inverse;
            const float up = 1.0f / std::sqrt(gx * gx + gy * gy + 1.0f);
            tile->normal[0][at] = {snorm16(-gx * up), snorm16(-gy * up)};

            const WaterNear near = water_near(c, lattices, x, y);
            const float above = near.above_m;
            tile->water[0][at].x = static_cast<int16_t>(std::clamp(above * 256.0f, -32767.0f, 32767.0f));
            const float loose_m = metres_of_ticks(sand(x, y) + soil(x, y));
            tile->water[0][at].y = snorm16(1.0f - sstep(0.03f, 0.25f, loose_m));

            // Distance to the shore from the height above the water and the slope of the shore.
            const float slope = std::sqrt(gx * gx + gy * gy);
            constexpr float k_far_m = 60.0f; // and whatever lies farther
            const float shore_m = k_far_m + near.known * (std::min(-above / std::max(slope, 0.03f), k_far_m) - k_far_m);
            const float near_water = sstep(24.0f, 2.0f, shore_m);
            const float soil_m = metres_of_ticks(soil(x, y));
            const float wet = sstep(-0.25f, 0.65f, wetness(x, y));
            // Rain gathers where a slope is hollow, and soil keeps it: there something grows.
            const float around = CoarseCorners(x, y, -1, 65).mix(lattices.ground[2]);
            const float hollow = shore_m > 0.0f ? sstep(0.0f, 0.06f * cell, around - c.ground[c.index(x, y)]) *
                                                      sstep(0.08f, 0.5f, slope) * clamp01(soil_m * 4.0f)
                                                : 0.0f;
            const float damp = std::max(shore_m > 0.0f ? near_water : 0.0f, hollow);
            const float litter = clamp01(soil_m * 0.55f) * (0.10f + 0.90f * wet) + 0.45f * damp;
            const float moist = clamp01(0.15f + 0.65f * wet + 0.5f * std::max(near_water, hollow) +
                                        metres_of_ticks(moisture(x, y)) * 5.0f);
            tile->material[0][at] = {unorm8(metres_of_ticks(sand(x, y)) * 2.0f), unorm8(litter), unorm8(moist),
                                     unorm8((std::clamp(shore_m, -20.0f, 60.0f) + 20.0f) / 80.0f)};
        }
    fill_mips(tile->normal);
    fill_mips(tile->material, k_view_texels);
    const auto least = static_cast<int16_t>(k_least_water_m * 256.0f - 1.0f);
    for (int j = 0; j < k_view_texels; ++j)
        for (int i = 0; i < k_view_texels; ++i)
            if (tile->water[0][static_cast<size_t>(j) * k_view_texels + static_cast<size_t>(i)].x >= least)
                tile->water_blocks.add(i - k_view_border, j - k_view_border);
    fill_mips(tile->water);
    fill_wind(block, *tile);
    tile->height_context = std::move(context);
    return tile;
}

} // namespace sahel
