#include "sim/wind_grid.h"

#include "sim/wind_ground.h"
#include "sim/wind_project.h"
#include "sim/wind_smooth.h"
#include "sim/wind_warp.h"
#include "world/cuda_runtime.h"
#include "world/det_math.h"
#include "world/layers.h"
#include "world/params.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <utility>

namespace sahel {

namespace {

constexpr int32_t k_most_shift = 3;                // 8 cells
constexpr int64_t k_most_cells = int64_t{1} << 24; // along a side of the region
constexpr int64_t k_most_coarse = int64_t{1} << 28;
constexpr uint32_t k_magic = 0x444E4957; // "WIND"
constexpr uint32_t k_version = 1;

struct ScaleParams {
    float radius_m, weight, strength_m_per_s;
};

std::vector<ScaleParams> scales_of(const WindParams& p) {
    const std::array<ScaleParams, WarpKernel::k_scales> all{{
        {p.warp_radius_1_m, p.warp_weight_1, p.warp_strength_1_m_per_s},
        {p.warp_radius_2_m, p.warp_weight_2, p.warp_strength_2_m_per_s},
        {p.warp_radius_3_m, p.warp_weight_3, p.warp_strength_3_m_per_s},
        {p.warp_radius_4_m, p.warp_weight_4, p.warp_strength_4_m_per_s},
    }};
    std::vector<ScaleParams> used;
    if (!p.warp || !(p.warp_gain > 0.0f)) return used;
    for (int i = 0; i < p.warp_count; ++i)
        if (all[static_cast<size_t>(i)].weight > 0.0f) used.push_back(all[static_cast<size_t>(i)]);
    return used;
}

bool uses_mean(const WindParams& p) {
    return p.venturi_per_m > 0.0f && p.venturi_radius_m > 0.0f;
}

int32_t shift_of(const WindParams& params, int32_t tile_cells, double cell_m) {
    double least = std::numeric_limits<double>::infinity();
    for (const ScaleParams& s : scales_of(params)) least = std::min(least, 0.5 * static_cast<double>(s.radius_m));
    if (uses_mean(params)) least = std::min(least, 0.5 * static_cast<double>(params.venturi_radius_m));
    int32_t shift = 0;
    while (shift < k_most_shift && tile_cells % (2 << shift) == 0 && std::ldexp(cell_m, shift + 1) * 3.0 <= least)
        ++shift;
    return shift;
}

std::string text_of(const WindRegion& r) {
    return fmt::format("{} x {} cells from ({}, {})", r.x.cells, r.y.cells, r.x.first, r.y.first);
}

// What a solution is saved with. Read and written as it lies in memory: every machine that runs this is little-endian.
struct SavedHeader {
    uint32_t magic = k_magic;
    uint32_t version = k_version;
    int64_t first_x = 0, first_y = 0;
    int32_t cells_x = 0, cells_y = 0;
    int32_t spacing = 0;
    int32_t borders = 0; ///< bits: periodic x, periodic y, walls west, east, north, south
};
static_assert(sizeof(SavedHeader) == 40 && std::endian::native == std::endian::little);

SavedHeader header_of(const WindRegion& r, int32_t shift) {
    const auto bit = [](bool on, int n) { return on ? 1 << n : 0; };
    SavedHeader h;
    h.first_x = r.x.first;
    h.first_y = r.y.first;
    h.cells_x = r.x.cells;
    h.cells_y = r.y.cells;
    h.spacing = 1 << shift;
    h.borders = bit(r.x.periodic, 0) | bit(r.y.periodic, 1) | bit(r.x.wall_low, 2) | bit(r.x.wall_high, 3) |
                bit(r.y.wall_low, 4) | bit(r.y.wall_high, 5);
    return h;
}

// Ground where there is none: each ring of unknown cells beside known ones takes the mean of those, until all are
// known.
void carry_ground(std::vector<int64_t>& ground, std::vector<uint8_t>& known, const WindRegion& region) {
    constexpr uint8_t k_unknown = 0, k_known = 1, k_in_ring = 2;
    const auto nx = static_cast<size_t>(region.x.coarse);
    const auto beside = [&](size_t i, auto&& f) {
        const auto x = static_cast<int32_t>(i % nx);
        const auto y = static_cast<int32_t>(i / nx);
        for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}})
            f(static_cast<size_t>(region.y.inside(y + dy)) * nx + static_cast<size_t>(region.x.inside(x + dx)));
    };
    std::vector<size_t> ring;
    std::vector<size_t> next;
    std::vector<int64_t> means;
    const auto add_unknown = [&](size_t j) {
        if (known[j] != k_unknown) return;
        known[j] = k_in_ring;
        next.push_back(j);
    };
    const size_t count = ground.size();
    for (size_t i = 0; i < count; ++i)
        if (known[i] == k_known) beside(i, add_unknown);
    while (!next.empty()) {
        ring.swap(next);
        next.clear();
        means.clear();
        for (const size_t i : ring) {
            int64_t sum = 0;
            int64_t n = 0;
            beside(i, [&](size_t j) {
                sum += known[j] == k_known ? ground[j] : 0;
                n += known[j] == k_known ? 1 : 0;
            });
            means.push_back(floor_div(sum, n));
        }
        for (size_t k = 0; k < ring.size(); ++k) {
            ground[ring[k]] = means[k];
            known[ring[k]] = k_known;
        }
        for (const size_t i : ring) beside(i, add_unknown);
    }
}

} // namespace

struct WindGrid::State {
    WindRegion region;
    WindParams params;
    double cell_m = 1.0;
    int32_t shift = 0;
    MemoryPool* pool = nullptr;

    std::vector<ScaleParams> scales;
    std::vector<int64_t> ground; ///< sums of ticks
    std::vector<uint8_t> known;
    std::vector<int64_t> slot_sums;
    std::vector<float> height, smooth; ///< packed
    std::vector<std::vector<float>> rings;
    WindPlane height_plane, mean_plane, wind_x_plane, wind_y_plane;
    std::vector<WindPlane> scale_planes;
    std::vector<GaussianSmoother> smoothers; ///< of the scales, then of the mean
    std::optional<WindProjection> projection;

    bool solved = false;
    std::vector<float> wind_x, wind_y; ///< packed
    Buffer device;                     ///< both, one after the other
    float max_speed = 0.0f;
    Projected projected;

    [[nodiscard]] size_t cells() const { return static_cast<size_t>(region.x.coarse) * size_t(region.y.coarse); }
    WindPlane plane() {
        rings.emplace_back(static_cast<size_t>(WindPlane::floats(region.x.coarse, region.y.coarse)), 0.0f);
        return WindPlane::in(rings.back().data(), region.x.coarse, region.y.coarse);
    }
    [[nodiscard]] WindRing ring_x() const { return region.x.periodic ? WindRing::wrap : WindRing::edge; }
    [[nodiscard]] WindRing ring_y() const { return region.y.periodic ? WindRing::wrap : WindRing::edge; }
    void unpack(const std::vector<float>& from, const WindPlane& to) const {
        for (int32_t y = 0; y < to.ny; ++y)
            std::memcpy(to.row(y), from.data() + size_t(y) * size_t(to.nx), size_t(to.nx) * sizeof(float));
        to.fill_ring(ring_x(), ring_y());
    }
    static void pack(const WindPlane& from, std::vector<float>& to) {
        for (int32_t y = 0; y < from.ny; ++y)
            std::memcpy(to.data() + size_t(y) * size_t(from.nx), from.row(y), size_t(from.nx) * sizeof(float));
    }
    Status publish();
};

// The new solution becomes what passes read.
Status WindGrid::State::publish() {
    float most = 0.0f;
    for (size_t i = 0; i < wind_x.size(); ++i) most = std::max(most, wind_x[i] * wind_x[i] + wind_y[i] * wind_y[i]);
    max_speed = det::sqrt(most) * (1.0f + 0x1p-21f); // mixing rounds
    solved = true;
    if (pool->kind() != MemoryKind::cuda) return {};
    const uint64_t bytes = wind_x.size() * sizeof(float);
    SAHEL_TRY(cuda::copy_to_device(device.data(), wind_x.data(), bytes));
    return cuda::copy_to_device(static_cast<float*>(device.data()) + wind_x.size(), wind_y.data(), bytes);
}

WindRegion WindRegion::of(const TileLayout& layout) {
    SAHEL_CHECK(!layout.tiles.empty());
    const int64_t n = layout.tile_cells;
    int64_t x0 = layout.tiles.front().x, x1 = x0, y0 = layout.tiles.front().y, y1 = y0;
    for (const TileKey& key : layout.tiles) {
        x0 = std::min(x0, key.x);
        x1 = std::max(x1, key.x);
        y0 = std::min(y0, key.y);
        y1 = std::max(y1, key.y);
    }
    const auto axis = [&](int64_t first, int64_t last, int64_t low, int64_t high, Border below, Border above) {
        WindAxis a;
        a.first = first * n;
        a.cells = static_cast<int32_t>(std::min((last + 1 - first) * n, k_most_cells + 1)); // create refuses the last
        const bool at_low = layout.bounded && first == low;
        const bool at_high = layout.bounded && last + 1 == high;
        a.periodic = at_low && at_high && below == Border::periodic;
        a.wall_low = at_low && below == Border::wall;
        a.wall_high = at_high && above == Border::wall;
        return a;
    };
    return {axis(x0, x1, layout.tx0, layout.tx1, layout.west, layout.east),
            axis(y0, y1, layout.ty0, layout.ty1, layout.north, layout.south), layout.tile_cells};
}

Result<WindGrid> WindGrid::create(const TileDomain& domain, const WindParams& params, double cell_m) {
    if (domain.slots() == 0) return Error{ErrorKind::usage, "there is no wind without tiles"};
    return create(WindRegion::of(domain.layout()), params, cell_m, domain.pool());
}

Result<WindGrid> WindGrid::create(const WindRegion& region, const WindParams& params, double cell_m, MemoryPool& pool) {
    SAHEL_TRY(check_ranges(params, "wind"));
    if (!(cell_m > 0.0) || !std::isfinite(cell_m))
        return Error{ErrorKind::usage, fmt::format("a cell of {} m is not possible", cell_m)};
    const int32_t shift = shift_of(params, region.tile_cells, cell_m);
    const int64_t coarse = int64_t{region.x.cells >> shift} * (region.y.cells >> shift);
    if (region.x.cells > k_most_cells || region.y.cells > k_most_cells || coarse > k_most_coarse)
        return Error{ErrorKind::usage, fmt::format("a region of {} is too large for one wind: choose a smaller one, "
                                                   "or larger radii of the wind",
                                                   text_of(region))};
    auto state = std::make_shared<State>();
    State& s = *state;
    s.region = region;
    s.params = params;
    s.cell_m = cell_m;
    s.shift = shift;
    s.pool = &pool;
    s.region.x.coarse = region.x.cells >> shift;
    s.region.y.coarse = region.y.cells >> shift;
    SAHEL_CHECK_EQ(s.region.x.coarse << shift, region.x.cells);
    SAHEL_CHECK_EQ(s.region.y.coarse << shift, region.y.cells);
    const size_t cells = s.cells();
    const double spacing_m = std::ldexp(cell_m, shift);
    s.scales = scales_of(params);
    s.ground.resize(cells);
    s.known.resize(cells);
    s.height.resize(cells);
    s.smooth.resize(cells);
    s.wind_x.resize(cells);
    s.wind_y.resize(cells);
    s.height_plane = s.plane();
    s.wind_x_plane = s.plane();
    s.wind_y_plane = s.plane();
    const auto smoother = [&](float radius_m) {
        s.smoothers.emplace_back(s.region.x.coarse, s.region.y.coarse, region.x.periodic, region.y.periodic,
                                 0.5 * static_cast<double>(radius_m) / spacing_m);
    };
    for (const ScaleParams& scale : s.scales) {
        smoother(scale.radius_m);
        s.scale_planes.push_back(s.plane());
    }
    if (uses_mean(params)) {
        smoother(params.venturi_radius_m);
        s.mean_plane = s.plane();
    }
    if (params.project)
        s.projection.emplace(s.region.x.coarse, s.region.y.coarse, region.x.periodic, region.y.periodic);
    if (pool.kind() == MemoryKind::cuda) {
        SAHEL_ASSIGN(s.device, Buffer::allocate(pool, 2 * cells * sizeof(float)));
    }
    return WindGrid(std::move(state));
}

Status WindGrid::solve(const TileDomain& domain, const WindNow& now) {
    clear_ground();
    SAHEL_TRY(add_ground(domain));
    return solve_ground(now);
}

void WindGrid::clear_ground() {
    std::fill(state_->known.begin(), state_->known.end(), uint8_t{0});
}

Status WindGrid::add_ground(const TileDomain& domain) {
    State& s = *state_;
    const int32_t tile = domain.tile_cells();
    SAHEL_CHECK_EQ(tile % (1 << s.shift), 0);
    GroundSums sums;
    sums.shift = s.shift;
    sums.n = tile >> s.shift;
    for (const SimLayer l : {SimLayer::bedrock, SimLayer::soil, SimLayer::sand, SimLayer::water})
        if (domain.layers().contains(l)) sums.layer[sums.layers++] = domain.ints(l);
    const size_t tile_coarse = static_cast<size_t>(sums.n) * static_cast<size_t>(sums.n);
    s.slot_sums.resize(tile_coarse * static_cast<size_t>(domain.slots()));
    sums.out = s.slot_sums.data();
    if (domain.on_device()) {
        SAHEL_TRY(run_ground_sums_cuda(sums, domain.slots()));
    } else {
        SAHEL_ISA_CALL(run_ground_sums, sums, domain.slots());
    }
    for (size_t slot = 0; slot < static_cast<size_t>(domain.slots()); ++slot) {
        const TileKey key = domain.layout().tiles[slot];
        const int64_t x0 = (key.x * tile - s.region.x.first) >> s.shift;
        const int64_t y0 = (key.y * tile - s.region.y.first) >> s.shift;
        if (x0 < 0 || y0 < 0 || x0 + sums.n > s.region.x.coarse || y0 + sums.n > s.region.y.coarse)
            return Error{ErrorKind::usage, fmt::format("tile ({}, {}) lies outside of the wind's region of {}", key.x,
                                                       key.y, text_of(s.region))};
        for (size_t y = 0; y < static_cast<size_t>(sums.n); ++y) {
            const size_t to = (static_cast<size_t>(y0) + y) * size_t(s.region.x.coarse) + static_cast<size_t>(x0);
            const int64_t* from = s.slot_sums.data() + slot * tile_coarse + y * static_cast<size_t>(sums.n);
            std::copy(from, from + sums.n, s.ground.begin() + static_cast<ptrdiff_t>(to));
            std::fill_n(s.known.begin() + static_cast<ptrdiff_t>(to), sums.n, uint8_t{1});
        }
    }
    return {};
}

Status WindGrid::solve_ground(const WindNow& now) {
    State& s = *state_;
    if (std::find(s.known.begin(), s.known.end(), uint8_t{1}) == s.known.end())
        return Error{ErrorKind::usage, "the wind has no ground to blow over: add tiles first"};
    carry_ground(s.ground, s.known, s.region);
    // Metres above a whole number of ticks, so that heights keep their precision anywhere.
    const int64_t cells_each = int64_t{1} << (2 * s.shift);
    int64_t mean = 0; // of the sums, without their overflow
    int64_t rest = 0;
    const auto count = static_cast<int64_t>(s.cells());
    for (const int64_t sum : s.ground) {
        mean += floor_div(sum, count);
        rest += floor_mod(sum, count);
    }
    const int64_t base = floor_div(mean + rest / count, cells_each);    // ticks
    const float tick_m = k_m_per_tick / static_cast<float>(cells_each); // exact
    for (size_t i = 0; i < s.ground.size(); ++i)
        s.height[i] = static_cast<float>(s.ground[i] - base * cells_each) * tick_m;
    s.unpack(s.height, s.height_plane);

    WarpKernel kernel;
    kernel.height = s.height_plane;
    kernel.base_m = static_cast<float>(base) * k_m_per_tick;
    kernel.absolute = !uses_mean(s.params);
    kernel.venturi_per_m = s.params.venturi_per_m;
    const WindVector wind = vector_of(now);
    kernel.wind_x = wind.x_m_per_s;
    kernel.wind_y = wind.y_m_per_s;
    const double spacing_m = std::ldexp(s.cell_m, s.shift);
    kernel.slope_factor = static_cast<float>(0.5 * static_cast<double>(s.params.warp_gain) / spacing_m);
    kernel.out_x = s.wind_x_plane;
    kernel.out_y = s.wind_y_plane;
    double weights = 0.0;
    for (const ScaleParams& scale : s.scales) weights += static_cast<double>(scale.weight);
    for (size_t i = 0; i < s.scales.size(); ++i) {
        s.smoothers[i].run(s.height.data(), s.smooth.data());
        s.unpack(s.smooth, s.scale_planes[i]);
        kernel.scale[kernel.scales++] = {s.scale_planes[i],
                                         static_cast<float>(static_cast<double>(s.scales[i].weight) / weights),
                                         s.scales[i].strength_m_per_s};
    }
    if (uses_mean(s.params)) {
        s.smoothers.back().run(s.height.data(), s.smooth.data());
        s.unpack(s.smooth, s.mean_plane);
        kernel.mean = s.mean_plane;
    }
    SAHEL_ISA_CALL(run_warp_wind, kernel);
    s.projected = {};
    if (s.projection) {
        s.wind_x_plane.fill_ring(s.ring_x(), s.ring_y());
        s.wind_y_plane.fill_ring(s.ring_x(), s.ring_y());
        const WindProjection::Outcome outcome = s.projection->run(s.wind_x_plane, s.wind_y_plane);
        s.projected = {outcome.before, outcome.after, outcome.iterations};
    }
    State::pack(s.wind_x_plane, s.wind_x);
    State::pack(s.wind_y_plane, s.wind_y);
    return s.publish();
}

Pass WindGrid::pass() const {
    return {WindPass::k_decl, [state = state_](const PassRun& r) -> Status {
                SAHEL_CHECK(state->solved);
                SAHEL_CHECK(!r.domain.on_device() || !state->device.empty());
                WindPass f;
                f.field = {state->wind_x.data(), state->wind_y.data(), state->region.x, state->region.y, state->shift};
                f.origin = r.domain.places().origin;
                f.wind_x = r.domain.reals(SimLayer::wind_x);
                f.wind_y = r.domain.reals(SimLayer::wind_y);
                if (r.domain.on_device()) {
                    f.field.wind_x = static_cast<const float*>(state->device.data());
                    f.field.wind_y = f.field.wind_x + state->wind_x.size();
                    return run_wind_pass_cuda(r.launch, f);
                }
                SAHEL_ISA_CALL(run_wind_pass, r.launch, f);
                return {};
            }};
}

float WindGrid::max_speed() const {
    SAHEL_CHECK(state_->solved);
    return state_->max_speed;
}

std::vector<uint8_t> WindGrid::save() const {
    const State& s = *state_;
    SAHEL_CHECK(s.solved);
    const SavedHeader header = header_of(s.region, s.shift);
    const size_t plane = s.wind_x.size() * sizeof(float);
    std::vector<uint8_t> bytes(sizeof(header) + 2 * plane);
    std::memcpy(bytes.data(), &header, sizeof(header));
    std::memcpy(bytes.data() + sizeof(header), s.wind_x.data(), plane);
    std::memcpy(bytes.data() + sizeof(header) + plane, s.wind_y.data(), plane);
    return bytes;
}

Status WindGrid::restore(const std::vector<uint8_t>& bytes) {
    State& s = *state_;
    SavedHeader found;
    if (bytes.size() < sizeof(found)) return Error{ErrorKind::corrupt, "a saved wind is cut short"};
    std::memcpy(&found, bytes.data(), sizeof(found));
    if (found.magic != k_magic) return Error{ErrorKind::corrupt, "what was saved is no wind"};
    if (found.version != k_version)
        return Error{ErrorKind::unsupported,
                     fmt::format("a saved wind has version {}, this program reads {}", found.version, k_version)};
    const SavedHeader own = header_of(s.region, s.shift);
    if (std::memcmp(&found, &own, sizeof(own)) != 0)
        return Error{ErrorKind::usage,
                     fmt::format("a saved wind of {} x {} cells from ({}, {}), spacing {}, does not fit the region of "
                                 "{}, spacing {}, or its borders",
                                 found.cells_x, found.cells_y, found.first_x, found.first_y, found.spacing,
                                 text_of(s.region), own.spacing)};
    const size_t plane = s.wind_x.size() * sizeof(float);
    if (bytes.size() != sizeof(found) + 2 * plane)
        return Error{ErrorKind::corrupt,
                     fmt::format("a saved wind has {} bytes instead of {}", bytes.size(), sizeof(found) + 2 * plane)};
    std::vector<float> x(s.wind_x.size());
    std::vector<float> y(s.wind_y.size());
    std::memcpy(x.data(), bytes.data() + sizeof(found), plane);
    std::memcpy(y.data(), bytes.data() + sizeof(found) + plane, plane);
    const auto finite = [](float v) { return std::isfinite(v); };
    if (!std::all_of(x.begin(), x.end(), finite) || !std::all_of(y.begin(), y.end(), finite))
        return Error{ErrorKind::corrupt, "a saved wind has values that are not numbers"};
    s.wind_x = std::move(x);
    s.wind_y = std::move(y);
    s.projected = {};
    return s.publish();
}

bool WindGrid::solved() const {
    return state_->solved;
}
int32_t WindGrid::spacing_cells() const {
    return 1 << state_->shift;
}
const WindRegion& WindGrid::region() const {
    return state_->region;
}
std::span<const float> WindGrid::coarse_x() const {
    return state_->wind_x;
}
std::span<const float> WindGrid::coarse_y() const {
    return state_->wind_y;
}
const WindGrid::Projected& WindGrid::projected() const {
    return state_->projected;
}

} // namespace sahel
