#include "sim/aeolian.h"

#include "sim/echo.h"
#include "sim/saltation.h"
#include "sim/sand_passes.h"
#include "sim/step_plan.h"
#include "sim/wind_shadow.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <span>
#include <utility>
#include <vector>

namespace sahel {

namespace {

constexpr int32_t k_least_halo = k_leg_radius;
constexpr double k_most_parts = 1000.0; // of a step
constexpr int32_t k_most_legs = 64;     // of a hop: 448 cells

Error refuse(std::string message) {
    return {ErrorKind::usage, std::move(message)};
}

int32_t parts_of(const SandParams& p) {
    // A step of exactly so many hops must not get one more by rounding.
    return std::max(1, static_cast<int32_t>(std::ceil(double{p.step_s} / double{p.hop_s} * (1.0 - 1e-6))));
}

Status check(const Aeolian::Desc& desc) {
    const SandParams& p = desc.sand;
    SAHEL_TRY(check_ranges(desc.wind, "wind and sand", "wind"));
    SAHEL_TRY(check_ranges(p, "wind and sand", "sand"));
    if (!(desc.cell_m > 0.0)) return refuse(fmt::format("cells of {} m are not possible", desc.cell_m));
    if (p.shadow_max_deg <= p.shadow_min_deg)
        return refuse(fmt::format("sand.shadow_max ({} deg) must be above sand.shadow_min ({} deg)", p.shadow_max_deg,
                                  p.shadow_min_deg));
    if (p.echo_rate_m_per_s > 0.0f && p.echo_sticky_range <= p.echo_erosion_range)
        return refuse(fmt::format("sand.echo_sticky_range ({}) must be above sand.echo_erosion_range ({})",
                                  p.echo_sticky_range, p.echo_erosion_range));
    if (double{p.step_s} / double{p.hop_s} > k_most_parts)
        return refuse(fmt::format("sand.step ({} s) is more than {} times sand.hop ({} s): choose a shorter step or a "
                                  "longer hop",
                                  p.step_s, k_most_parts, p.hop_s));
    return {};
}

} // namespace

SimLayerSet Aeolian::layers(const Desc& /*desc*/) {
    SimLayerSet set{SimLayer::bedrock,  SimLayer::soil,          SimLayer::sand,       SimLayer::water,
                    SimLayer::moisture, SimLayer::airborne_sand, SimLayer::vegetation, SimLayer::resistance,
                    SimLayer::object,   SimLayer::wind_x,        SimLayer::wind_y,     SimLayer::wind_shadow,
                    SimLayer::cliff,    SimLayer::echo,          SimLayer::hopping,    SimLayer::hopping_next,
                    SimLayer::bounce,   SimLayer::repose,        SimLayer::surface};
    set.insert(avalanche_layers());
    return set;
}

int32_t Aeolian::least_halo(const Desc& desc) {
    int32_t halo = std::max(k_least_halo, WindShadowPass::radius(shadow_samples(desc.sand, desc.cell_m)));
    if (desc.sand.echo_rate_m_per_s > 0.0f && !desc.echo_given)
        halo = std::max(halo, EchoPass::radius(echo_steps(desc.sand, desc.cell_m)));
    return halo;
}

Aeolian::Aeolian(Desc desc, WindGrid wind, int32_t slots)
    : desc_(std::move(desc)), schedule_(desc_.schedule ? *desc_.schedule : WindSchedule(desc_.wind)),
      wind_(std::move(wind)), supplied_(static_cast<size_t>(slots)) {}

Result<Aeolian> Aeolian::create(const Desc& desc, const TileDomain& domain) {
    SAHEL_TRY(check(desc));
    if (const int32_t least = least_halo(desc); domain.halo() < least)
        return refuse(fmt::format("wind and sand need halos of at least {} cells, not {} (sand.shadow_length and "
                                  "sand.echo_sticky_range decide)",
                                  least, domain.halo()));
    Status missing;
    layers(desc).for_each([&](SimLayer l) {
        if (missing.ok() && !domain.layers().contains(l))
            missing = refuse(fmt::format("wind and sand need the layer {}", info_of(l).name));
    });
    SAHEL_TRY(missing);
    SAHEL_ASSIGN(WindGrid wind, WindGrid::create(domain, desc.wind, desc.cell_m));
    return Aeolian(desc, std::move(wind), domain.slots());
}

WindNow Aeolian::wind_at(int64_t step) const {
    return schedule_.at(static_cast<double>(step) * double{desc_.sand.step_s});
}

Status Aeolian::supply(TileDomain& domain, int64_t step) {
    const SandParams& p = desc_.sand;
    const Pass covered = covered_pass(p);
    SAHEL_TRY(run_passes(domain, std::span(&covered, 1)));
    SAHEL_ASSIGN(const std::vector<int64_t> counts, domain.sums(SimLayer::surface));
    int64_t cells = 0;
    for (const int64_t c : counts) cells += c;
    stats_.coverage = static_cast<double>(cells) / static_cast<double>(domain.owned_cells());
    const bool add = stats_.coverage < double{p.supply_target};
    const bool remove = p.supply_removes && stats_.coverage > double{p.supply_target};
    if (!add && !remove) return {};
    SAHEL_ASSIGN(const std::vector<int64_t> before, domain.sums(SimLayer::sand));
    const Pass pass = supply_pass(p, desc_.seed, step, remove);
    SAHEL_TRY(run_passes(domain, std::span(&pass, 1)));
    SAHEL_ASSIGN(const std::vector<int64_t> after, domain.sums(SimLayer::sand));
    for (size_t i = 0; i < after.size(); ++i) {
        (add ? supplied_[i].added_ticks : supplied_[i].removed_ticks) += std::abs(after[i] - before[i]);
        if (domain.keeps_flows())
            domain.add_source(add ? LedgerSource::supply_added : LedgerSource::supply_removed, SimLayer::sand,
                              static_cast<int32_t>(i), after[i] - before[i]);
    }
    return {};
}

Status Aeolian::step(TileDomain& domain, int64_t step) {
    const SandParams& p = desc_.sand;
    SAHEL_CHECK_EQ(supplied_.size(), static_cast<size_t>(domain.slots()));
    if (p.supply && step % p.supply_every_steps == 0) SAHEL_TRY(supply(domain, step));

    // Solved when the step says so, never by what happened to run before: a resumed run does the same.
    const WindNow now = wind_at(step);
    const bool fresh =
        !wind_.solved() || step % desc_.wind.epoch_steps == 0 || (step > 0 && !(now == wind_at(step - 1)));
    if (fresh) SAHEL_TRY(wind_.solve(domain, now));
    stats_.max_wind_m_per_s = wind_.max_speed();

    const int32_t parts = parts_of(p);
    SandPart part{desc_.seed, step, 0, p.step_s / static_cast<float>(parts), 1.0f};
    part.share = std::min(1.0f, part.dt_s / p.hop_s);
    const HopWay way = HopWay::of(p, desc_.cell_m, stats_.max_wind_m_per_s);
    if (way.legs > k_most_legs)
        return refuse(
            fmt::format("a wind of {:.3g} m/s would carry sand {:.3g} cells far in one hop of sand.hop = {} s; "
                        "the most is {}",
                        stats_.max_wind_m_per_s, stats_.max_wind_m_per_s * p.hop_s / desc_.cell_m, p.hop_s,
                        k_most_legs * k_longest_leg));
    const int32_t smoothing = smoothing_parts(p, desc_.cell_m, part.dt_s, stats_.max_wind_m_per_s);
    stats_.parts = parts;
    stats_.legs = way.legs;

    std::vector<Pass> passes;
    if (fresh || domain.valid_halo(SimLayer::wind_x) < 0) passes.push_back(wind_.pass());
    const bool echoes = p.echo_rate_m_per_s > 0.0f;
    if (!echoes && (fresh || domain.valid_halo(SimLayer::echo) < 0)) passes.push_back(no_echo_pass());
    for (part.index = 0; part.index < parts; ++part.index) {
        passes.push_back(ground_pass());
        passes.push_back(wind_shadow_pass(p, desc_.cell_m));
        if (echoes && !desc_.echo_given) {
            passes.push_back(cliff_pass(p, desc_.cell_m));
            passes.push_back(echo_pass(p, desc_.cell_m));
        }
        passes.push_back(lift_pass(p, part));
        for (int32_t leg = 0; leg < way.legs; ++leg) passes.push_back(hop_leg_pass(p, way, leg));
        passes.push_back(deposit_pass(p, desc_.cell_m, part, way.legs));
        for (int32_t i = 0; i < smoothing; ++i) {
            passes.push_back(smooth_pass(p, desc_.cell_m, part.dt_s / static_cast<float>(smoothing)));
            passes.push_back(apply_smooth_pass());
        }
    }
    passes.push_back(repose_pass(p));
    SAHEL_TRY(run_passes(domain, passes));

    SAHEL_TRY(avalanche(domain, p, desc_.cell_m, AvalancheKind::sand, desc_.avalanche, &stats_.sand));
    if (p.soil_sweeps > 0) SAHEL_TRY(avalanche(domain, p, desc_.cell_m, AvalancheKind::soil, desc_.avalanche, nullptr));
    if (p.bedrock_sweeps > 0)
        SAHEL_TRY(avalanche(domain, p, desc_.cell_m, AvalancheKind::bedrock, desc_.avalanche, nullptr));
    return {};
}

} // namespace sahel
