#include "world/terrain_lakes.h"

#include "world/terrain_layout.h"
#include "world/terrain_streams.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace sahel {

namespace {

constexpr int64_t k_lattice = 2 * k_lake_lattice_m; // half metres
constexpr float k_largest_range_m = 48.0f;          // of the ground under and around a lake
constexpr float k_smallest_radius_m = 90.0f;

/// Beyond this level lakes are smaller than a cell.
constexpr int32_t k_last_lake_level = 8;

/// The land at one point, always as 16 m nodes see it: a lake does not depend on the level that asks.
struct Land {
    float relief, canyon, continent, height;
};
Land land_at(const TerrainTables& t, const TerrainKernels& kernels, int64_t x, int64_t y) {
    std::array<float, k_base_rows> memory{};
    const BaseRow row = base_row_in(memory.data(), 1);
    const SampleRow sample{x, y, 32, 0};
    kernels.sums(t, sample, 1, 16.0f, SumRange{}, row);
    kernels.base(t, sample, 1, 16.0f, row);
    return {*row.sum[static_cast<int>(SumField::relief)], *row.field[static_cast<int>(NodeField::canyon)],
            *row.sum[static_cast<int>(SumField::continent)], *row.height};
}

/// A lake reaches 3 radii (k_no_lake); radii are at most 1.45 lake_radius_m.
int64_t lake_reach_half_m(const TerrainTables& t) {
    return static_cast<int64_t>(2.0f * k_no_lake * 1.45f * t.p.lake_radius_m) + 1;
}

std::optional<LakeSite> lake_at(const TerrainTables& t, const TerrainKernels& kernels, int64_t i, int64_t j) {
    const auto raw = raw_lake_site(t, i, j);
    if (!raw) return std::nullopt;
    float radius = t.p.lake_radius_m * (0.55f + 0.9f * static_cast<float>(lowbias32(raw->hash)) / 4294967296.0f);
    for (int dj = -1; dj <= 1; ++dj)
        for (int di = -1; di <= 1; ++di) {
            if (di == 0 && dj == 0) continue;
            const auto other = raw_lake_site(t, i + di, j + dj);
            if (!other) continue;
            const float dx = static_cast<float>(other->x_half_m - raw->x_half_m) * 0.5f;
            const float dy = static_cast<float>(other->y_half_m - raw->y_half_m) * 0.5f;
            radius = std::min(radius, 0.34f * std::sqrt(dx * dx + dy * dy));
        }
    if (radius < k_smallest_radius_m) return std::nullopt;
    const Land centre = land_at(t, kernels, raw->x_half_m, raw->y_half_m);
    if (centre.relief < t.p.lake_relief_min || centre.relief > t.p.lake_relief_max || centre.canyon > 0.3f)
        return std::nullopt;
    if (t.p.sea != 0 && centre.continent < 0.12f) return std::nullopt;
    float low = centre.height;
    float high = centre.height;
    const auto off = static_cast<int64_t>(radius * 3.2f);
    for (const auto& [dx, dy] :
         {std::pair{off, int64_t{0}}, {-off, int64_t{0}}, {int64_t{0}, off}, {int64_t{0}, -off}}) {
        const float h = land_at(t, kernels, raw->x_half_m + dx, raw->y_half_m + dy).height;
        low = std::min(low, h);
        high = std::max(high, h);
    }
    if (high - low > k_largest_range_m) return std::nullopt;
    return LakeSite{raw->x_half_m, raw->y_half_m, radius, std::floor((low - 1.0f) * 8.0f) / 8.0f,
                    4.0f + radius * 0.02f};
}

} // namespace

std::optional<RawLakeSite> raw_lake_site(const TerrainTables& t, int64_t i, int64_t j) {
    const uint32_t h = node_hash(column_hash(static_cast<uint32_t>(static_cast<uint64_t>(i)), t.lake_salt),
                                 static_cast<uint32_t>(static_cast<uint64_t>(j)));
    if (static_cast<float>(h >> 24) / 256.0f >= t.p.lake_probability) return std::nullopt;
    const auto inside = [](uint32_t bits) {
        return 1024 + static_cast<int64_t>(static_cast<float>(bits & 0xFFFu) / 4096.0f * 6144.0f);
    };
    return RawLakeSite{h, i * k_lattice + inside(h), j * k_lattice + inside(h >> 12)};
}

void find_lakes(const TerrainTables& t, const TerrainKernels& kernels, int64_t x0, int64_t y0, int64_t x1, int64_t y1,
                std::vector<LakeSite>& lakes) {
    lakes.clear();
    if (t.p.lake_probability <= 0.0f) return;
    const int64_t reach = lake_reach_half_m(t);
    const int64_t i0 = floor_div(x0 - reach, k_lattice), i1 = floor_div(x1 + reach, k_lattice);
    const int64_t j0 = floor_div(y0 - reach, k_lattice), j1 = floor_div(y1 + reach, k_lattice);
    for (int64_t j = j0; j <= j1; ++j)
        for (int64_t i = i0; i <= i1; ++i)
            if (const auto lake = lake_at(t, kernels, i, j)) lakes.push_back(*lake);
}

void find_lakes_near(const TerrainTables& t, const TerrainKernels& kernels, int32_t level, const CellRect& rect,
                     std::vector<LakeSite>& lakes) {
    lakes.clear();
    if (level > k_last_lake_level) return;
    CellRect reach = node_reach_half_m(rect, level);
    if (has_streams(t, level)) // streams reach farther than their lakes
        reach = reach.grown(std::max<int64_t>(k_stream_site_half_m - lake_reach_half_m(t), 0));
    find_lakes(t, kernels, reach.x0, reach.y0, reach.x1, reach.y1, lakes);
}

} // namespace sahel
