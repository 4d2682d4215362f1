#include "world/terrain_lakes.h"

#include "world/terrain_rows.h"
#include "world/tile_key.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace sahel {

namespace {

constexpr int64_t k_lattice = 2 * k_lake_lattice_m; // half metres
constexpr float k_largest_range_m = 48.0f;          // of the ground under and around a lake
constexpr float k_smallest_radius_m = 90.0f;

struct RawSite {
    uint32_t hash;
    int64_t x, y; // half metres
};

std::optional<RawSite> raw_site(const TerrainTables& t, int64_t i, int64_t j) {
    const uint32_t h = node_hash(column_hash(static_cast<uint32_t>(static_cast<uint64_t>(i)), t.lake_salt),
                                 static_cast<uint32_t>(static_cast<uint64_t>(j)));
    if (static_cast<float>(h >> 24) / 256.0f >= t.p.lake_probability) return std::nullopt;
    const auto inside = [](uint32_t bits) {
        return 1024 + static_cast<int64_t>(static_cast<float>(bits & 0xFFFu) / 4096.0f * 6144.0f);
    };
    return RawSite{h, i * k_lattice + inside(h), j * k_lattice + inside(h >> 12)};
}

/// The land at one point, always as 16 m nodes see it: a lake does not depend on the level that asks.
struct Land {
    float relief, canyon, continent, height;
};
Land land_at(const TerrainTables& t, int64_t x, int64_t y) {
    std::array<float, 18> v{};
    const NodeRows rows{&v[0], &v[1], &v[2], &v[3], &v[4], &v[5], &v[6], &v[7], &v[8], &v[9]};
    NodeScratch scratch{};
    for (int i = 0; i < 8; ++i) scratch.v[i] = &v[static_cast<size_t>(10 + i)];
    const SampleRow row{x, y, 32, 0};
    SAHEL_ISA_CALL(terrain_height_row, t, row, 1, 16.0f, rows, scratch);
    return {v[2], v[7], v[4], v[9]};
}

std::optional<LakeSite> lake_at(const TerrainTables& t, int64_t i, int64_t j) {
    const auto raw = raw_site(t, i, j);
    if (!raw) return std::nullopt;
    float radius = t.p.lake_radius_m * (0.55f + 0.9f * static_cast<float>(lowbias32(raw->hash)) / 4294967296.0f);
    for (int dj = -1; dj <= 1; ++dj)
        for (int di = -1; di <= 1; ++di) {
            if (di == 0 && dj == 0) continue;
            const auto other = raw_site(t, i + di, j + dj);
            if (!other) continue;
            const float dx = static_cast<float>(other->x - raw->x) * 0.5f;
            const float dy = static_cast<float>(other->y - raw->y) * 0.5f;
            radius = std::min(radius, 0.34f * std::sqrt(dx * dx + dy * dy));
        }
    if (radius < k_smallest_radius_m) return std::nullopt;
    const Land centre = land_at(t, raw->x, raw->y);
    if (centre.relief < t.p.lake_relief_min || centre.relief > t.p.lake_relief_max || centre.canyon > 0.3f)
        return std::nullopt;
    if (t.p.sea != 0 && centre.continent < 0.12f) return std::nullopt;
    float low = centre.height;
    float high = centre.height;
    const auto off = static_cast<int64_t>(radius * 3.2f);
    for (const auto& [dx, dy] :
         {std::pair{off, int64_t{0}}, {-off, int64_t{0}}, {int64_t{0}, off}, {int64_t{0}, -off}}) {
        const float h = land_at(t, raw->x + dx, raw->y + dy).height;
        low = std::min(low, h);
        high = std::max(high, h);
    }
    if (high - low > k_largest_range_m) return std::nullopt;
    return LakeSite{raw->x, raw->y, radius, std::floor((low - 1.0f) * 8.0f) / 8.0f, 4.0f + radius * 0.02f};
}

} // namespace

void find_lakes(const TerrainTables& t, int64_t x0, int64_t y0, int64_t x1, int64_t y1, std::vector<LakeSite>& lakes) {
    lakes.clear();
    if (t.p.lake_probability <= 0.0f) return;
    // A lake reaches 2.2 radii, times 1.8 where the noise draws its shape in; radii are at most 1.45 lake_radius_m.
    const auto reach = static_cast<int64_t>(2.0f * 4.0f * 1.45f * t.p.lake_radius_m) + 1;
    const int64_t i0 = floor_div(x0 - reach, k_lattice), i1 = floor_div(x1 + reach, k_lattice);
    const int64_t j0 = floor_div(y0 - reach, k_lattice), j1 = floor_div(y1 + reach, k_lattice);
    for (int64_t j = j0; j <= j1; ++j)
        for (int64_t i = i0; i <= i1; ++i)
            if (const auto lake = lake_at(t, i, j)) lakes.push_back(*lake);
}

} // namespace sahel
