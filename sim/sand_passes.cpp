#include "sim/sand_passes.h"

#include "sim/border_flows.h"
#include "sim/sand_kernels.h"
#include "sim/tile_domain.h"
#include "world/det_math.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sahel {

namespace {

float tangent_of(float degrees) {
    const det::SinCos a = det::sincos(degrees * (det::k_pi / 180.0f));
    return a.sin / a.cos;
}

int32_t whole_cells(float length_m, double cell_m) {
    return static_cast<int32_t>(length_m / static_cast<float>(cell_m));
}

WetGround wet_ground(const SandParams& p) {
    return {p.moisture_capacity_m, k_m_per_tick / p.moisture_depth_m};
}

SlabView<const int32_t> ints(const TileDomain& d, SimLayer l) {
    return d.ints(l);
}
SlabView<const float> reals(const TileDomain& d, SimLayer l) {
    return d.reals(l);
}

SimLayer plane_after(int32_t legs) {
    return (legs & 1) != 0 ? SimLayer::hopping_next : SimLayer::hopping;
}

} // namespace

HopWay HopWay::of(const SandParams& p, double cell_m, float max_wind_m_per_s) {
    const float cells_per_speed = p.hop_s / static_cast<float>(cell_m);
    const float cells = max_wind_m_per_s * cells_per_speed;
    const float legs = std::max(1.0f, std::ceil(cells / static_cast<float>(k_longest_leg)));
    return {static_cast<int32_t>(legs), cells_per_speed / legs,
            std::min(cells / legs, static_cast<float>(k_longest_leg))};
}

int32_t shadow_samples(const SandParams& p, double cell_m) {
    return whole_cells(p.shadow_length_m, cell_m);
}

int32_t echo_steps(const SandParams& p, double cell_m) {
    return whole_cells(p.echo_sticky_range * p.echo_max_cliff_m, cell_m);
}

float smoothing_omega(const SandParams& p, double cell_m, float dt_s, float wind_m_per_s) {
    constexpr float k_settling = 0.6f; // on open sand
    const float bounced = p.lift_rate_m_per_s / k_settling;
    return bounced * dt_s * (p.reptation_smooth + p.reptation_smooth_wind_s_per_m * wind_m_per_s) /
           static_cast<float>(cell_m);
}

int32_t smoothing_parts(const SandParams& p, double cell_m, float dt_s, float max_wind_m_per_s) {
    constexpr float k_most_parts = 16.0f;
    const float omega = smoothing_omega(p, cell_m, dt_s, max_wind_m_per_s);
    if (!(omega > 0.0f)) return 0;
    return static_cast<int32_t>(std::clamp(std::ceil(omega / k_most_smoothing), 1.0f, k_most_parts));
}

Pass ground_pass() {
    return {GroundPass::k_decl, [](const PassRun& r) -> Status {
                const TileDomain& d = r.domain;
                const GroundPass f{ints(d, SimLayer::bedrock), ints(d, SimLayer::soil), ints(d, SimLayer::sand),
                                   ints(d, SimLayer::water), r.domain.ints(SimLayer::surface)};
                if (d.on_device()) return cuda::run_ground(r.launch, f);
                SAHEL_ISA_CALL(run_ground, r.launch, f);
                return {};
            }};
}

Pass wind_shadow_pass(const SandParams& p, double cell_m) {
    const int32_t samples = shadow_samples(p, cell_m);
    const float least = tangent_of(p.shadow_min_deg);
    const float range = tangent_of(p.shadow_max_deg) - least;
    return {WindShadowPass::decl(samples, p.shadow_curved), [=](const PassRun& r) -> Status {
                const TileDomain& d = r.domain;
                const WindShadowPass f{ints(d, SimLayer::surface),
                                       reals(d, SimLayer::wind_x),
                                       reals(d, SimLayer::wind_y),
                                       r.domain.reals(SimLayer::wind_shadow),
                                       samples,
                                       static_cast<float>(cell_m),
                                       least,
                                       range,
                                       p.shadow_curved,
                                       p.bilinear};
                if (d.on_device()) return cuda::run_wind_shadow(r.launch, f);
                SAHEL_ISA_CALL(run_wind_shadow, r.launch, f);
                return {};
            }};
}

Pass cliff_pass(const SandParams& p, double cell_m) {
    const float least_m = tangent_of(p.echo_cliff_deg) * static_cast<float>(cell_m);
    return {CliffPass::k_decl, [=](const PassRun& r) -> Status {
                const TileDomain& d = r.domain;
                const CliffPass f{ints(d, SimLayer::surface),
                                  reals(d, SimLayer::wind_x),
                                  reals(d, SimLayer::wind_y),
                                  r.domain.reals(SimLayer::cliff),
                                  least_m,
                                  p.bilinear};
                if (d.on_device()) return cuda::run_cliff(r.launch, f);
                SAHEL_ISA_CALL(run_cliff, r.launch, f);
                return {};
            }};
}

Pass echo_pass(const SandParams& p, double cell_m) {
    const int32_t steps = echo_steps(p, cell_m);
    return {EchoPass::decl(steps, p.shadow_curved), [=](const PassRun& r) -> Status {
                const TileDomain& d = r.domain;
                const EchoPass f{reals(d, SimLayer::cliff),
                                 reals(d, SimLayer::wind_x),
                                 reals(d, SimLayer::wind_y),
                                 r.domain.reals(SimLayer::echo),
                                 steps,
                                 static_cast<float>(cell_m),
                                 p.echo_rate_m_per_s,
                                 p.echo_erosion_range,
                                 p.echo_sticky_range,
                                 p.echo_max_cliff_m,
                                 p.shadow_curved,
                                 p.bilinear};
                if (d.on_device()) return cuda::run_echo(r.launch, f);
                SAHEL_ISA_CALL(run_echo, r.launch, f);
                return {};
            }};
}

Pass no_echo_pass() {
    return {NoEchoPass::k_decl, [](const PassRun& r) -> Status {
                const NoEchoPass f{r.domain.reals(SimLayer::echo)};
                if (r.domain.on_device()) return cuda::run_no_echo(r.launch, f);
                SAHEL_ISA_CALL(run_no_echo, r.launch, f);
                return {};
            }};
}

Pass lift_pass(const SandParams& p, const SandPart& part) {
    const bool echoes = p.echo_rate_m_per_s > 0.0f;
    const RandomStream random(part.seed, part.step, Purpose::saltation, 2 * static_cast<uint32_t>(part.index));
    return {LiftPass::decl(echoes), [=](const PassRun& r) -> Status {
                const TileDomain& d = r.domain;
                const LiftPass f{ints(d, SimLayer::soil),
                                 ints(d, SimLayer::water),
                                 ints(d, SimLayer::moisture),
                                 reals(d, SimLayer::wind_shadow),
                                 reals(d, SimLayer::vegetation),
                                 echoes ? reals(d, SimLayer::echo) : SlabView<const float>{},
                                 r.domain.ints(SimLayer::sand),
                                 r.domain.ints(SimLayer::airborne_sand),
                                 r.domain.ints(SimLayer::hopping),
                                 d.places(),
                                 random,
                                 wet_ground(p),
                                 p.lift_rate_m_per_s * part.dt_s * k_ticks_per_m,
                                 part.dt_s * k_ticks_per_m,
                                 part.share,
                                 echoes};
                if (d.on_device()) return cuda::run_lift(r.launch, f);
                SAHEL_ISA_CALL(run_lift, r.launch, f);
                return {};
            }};
}

Pass hop_leg_pass(const SandParams& p, const HopWay& way, int32_t leg) {
    const SimLayer from = plane_after(leg);
    const SimLayer to = plane_after(leg + 1);
    const int32_t radius = static_cast<int32_t>(way.longest) + 1;
    return {HopLegPass::decl(from, to, radius), [=](const PassRun& r) -> Status {
                const TileDomain& d = r.domain;
                const HopLegPass f{ints(d, from),     reals(d, SimLayer::wind_x), reals(d, SimLayer::wind_y),
                                   r.domain.ints(to), way.cells_per_speed,        way.longest,
                                   p.bilinear};
                if (d.on_device()) {
                    SAHEL_TRY(cuda::run_hop_leg(r.launch, f));
                } else {
                    SAHEL_ISA_CALL(run_hop_leg, r.launch, f);
                }
                if (!d.keeps_flows()) return {};
                const BorderFlowsView flows = r.domain.border_flows(SimLayer::airborne_sand);
                if (d.on_device()) return cuda::add_flows(d.slots(), flows, radius, f);
                add_border_flows("sim/hop_flows", d.slots(), flows, radius, f);
                return {};
            }};
}

Pass deposit_pass(const SandParams& p, double cell_m, const SandPart& part, int32_t legs) {
    const bool echoes = p.echo_rate_m_per_s > 0.0f;
    const bool wears = p.abrasion > 0.0f || p.soil_abrasion > 0.0f;
    const auto index = static_cast<uint32_t>(part.index);
    const RandomStream random(part.seed, part.step, Purpose::saltation, 2 * index + 1);
    const RandomStream random_wear(part.seed, part.step, Purpose::abrasion, index);
    // By amount: for each metre of way and of sand. Else for each metre of way, whatever bounces there.
    const float wear_unit = p.abrasion_by_amount ? p.hop_s : part.dt_s * k_ticks_per_m;
    const SimLayer arrived = plane_after(legs);
    return {DepositPass::decl(arrived, echoes, wears), [=](const PassRun& r) -> Status {
                const TileDomain& d = r.domain;
                DepositPass f;
                f.arrived = ints(d, arrived);
                f.water = ints(d, SimLayer::water);
                f.moisture = ints(d, SimLayer::moisture);
                f.object = ints(d, SimLayer::object);
                f.shadow = reals(d, SimLayer::wind_shadow);
                f.vegetation = reals(d, SimLayer::vegetation);
                f.soil = r.domain.ints(SimLayer::soil);
                f.sand = r.domain.ints(SimLayer::sand);
                f.airborne = r.domain.ints(SimLayer::airborne_sand);
                f.bounce = r.domain.reals(SimLayer::bounce);
                if (echoes) f.echo = reals(d, SimLayer::echo);
                if (wears) {
                    f.surface = ints(d, SimLayer::surface);
                    f.resistance = reals(d, SimLayer::resistance);
                    f.wind_x = reals(d, SimLayer::wind_x);
                    f.wind_y = reals(d, SimLayer::wind_y);
                    f.bedrock = r.domain.ints(SimLayer::bedrock);
                }
                f.places = d.places();
                f.random = random;
                f.random_wear = random_wear;
                f.wet = wet_ground(p);
                f.bounce_threshold = ticks_of_metres(p.bounce_threshold_m);
                f.abrasion_threshold = ticks_of_metres(p.abrasion_threshold_m);
                f.cell_ticks = ticks_of_metres(static_cast<float>(cell_m));
                f.per_second = k_m_per_tick / part.dt_s;
                f.wear = p.abrasion * wear_unit;
                f.soil_wear = p.soil_abrasion * wear_unit;
                f.by_amount = p.abrasion_by_amount;
                f.echoes = echoes;
                f.wears = wears;
                if (d.on_device()) return cuda::run_deposit(r.launch, f);
                SAHEL_ISA_CALL(run_deposit, r.launch, f);
                return {};
            }};
}

Pass smooth_pass(const SandParams& p, double cell_m, float dt_s) {
    const bool by_wind = p.reptation_smooth_wind_s_per_m > 0.0f;
    return {SmoothPass::decl(by_wind), [=](const PassRun& r) -> Status {
                const TileDomain& d = r.domain;
                SmoothPass f;
                f.bedrock = ints(d, SimLayer::bedrock);
                f.soil = ints(d, SimLayer::soil);
                f.sand = ints(d, SimLayer::sand);
                f.bounce = reals(d, SimLayer::bounce);
                if (by_wind) {
                    f.wind_x = reals(d, SimLayer::wind_x);
                    f.wind_y = reals(d, SimLayer::wind_y);
                }
                f.change = r.domain.ints(SimLayer::surface);
                f.strength = 0.5f * p.reptation_smooth * dt_s;
                f.wind_strength = 0.25f * p.reptation_smooth_wind_s_per_m * dt_s;
                f.cell_m = static_cast<float>(cell_m);
                f.most = k_most_smoothing * f.cell_m;
                f.by_wind = by_wind;
                if (d.on_device()) {
                    SAHEL_TRY(cuda::run_smooth(r.launch, f));
                } else {
                    SAHEL_ISA_CALL(run_smooth, r.launch, f);
                }
                if (!d.keeps_flows()) return {};
                const BorderFlowsView flows = r.domain.border_flows(SimLayer::sand);
                if (d.on_device()) return cuda::add_flows(d.slots(), flows, 1, f);
                add_border_flows("sim/smooth_flows", d.slots(), flows, 1, f);
                return {};
            }};
}

Pass apply_smooth_pass() {
    return {ApplySmoothPass::k_decl, [](const PassRun& r) -> Status {
                const ApplySmoothPass f{ints(r.domain, SimLayer::surface), r.domain.ints(SimLayer::sand)};
                if (r.domain.on_device()) return cuda::run_apply_smooth(r.launch, f);
                SAHEL_ISA_CALL(run_apply_smooth, r.launch, f);
                return {};
            }};
}

Pass repose_pass(const SandParams& p) {
    const bool lowers = p.reptation_repose_s2_per_m2 > 0.0f;
    const float bare = tangent_of(p.repose_deg);
    const float planted = tangent_of(p.repose_plants_deg);
    return {ReposePass::decl(lowers), [=](const PassRun& r) -> Status {
                const TileDomain& d = r.domain;
                ReposePass f;
                f.soil = ints(d, SimLayer::soil);
                f.sand = ints(d, SimLayer::sand);
                f.moisture = ints(d, SimLayer::moisture);
                f.vegetation = reals(d, SimLayer::vegetation);
                if (lowers) {
                    f.bounce = reals(d, SimLayer::bounce);
                    f.shadow = reals(d, SimLayer::wind_shadow);
                    f.wind_x = reals(d, SimLayer::wind_x);
                    f.wind_y = reals(d, SimLayer::wind_y);
                }
                f.repose = r.domain.reals(SimLayer::repose);
                f.wet = wet_ground(p);
                f.bare = bare;
                f.planted = planted;
                f.lowering = p.reptation_repose_s2_per_m2;
                f.calm = p.reptation_shadowed ? 1.0f : 0.0f;
                f.lowers = lowers;
                if (d.on_device()) return cuda::run_repose(r.launch, f);
                SAHEL_ISA_CALL(run_repose, r.launch, f);
                return {};
            }};
}

Pass covered_pass(const SandParams& p) {
    const int32_t threshold = ticks_of_metres(p.supply_threshold_m);
    return {CoveredPass::k_decl, [=](const PassRun& r) -> Status {
                const CoveredPass f{ints(r.domain, SimLayer::sand), r.domain.ints(SimLayer::surface), threshold};
                if (r.domain.on_device()) return cuda::run_covered(r.launch, f);
                SAHEL_ISA_CALL(run_covered, r.launch, f);
                return {};
            }};
}

Pass supply_pass(const SandParams& p, uint64_t seed, int64_t step, bool remove) {
    return {SupplyPass::k_decl, [=](const PassRun& r) -> Status {
                const TileLayout& layout = r.domain.layout();
                int64_t x0 = layout.tx0, y0 = layout.ty0, x1 = layout.tx1, y1 = layout.ty1;
                if (!layout.bounded) { // the rectangle around the tiles
                    x0 = x1 = layout.tiles.front().x;
                    y0 = y1 = layout.tiles.front().y;
                    for (const TileKey& t : layout.tiles) {
                        x0 = std::min(x0, t.x);
                        y0 = std::min(y0, t.y);
                        x1 = std::max(x1, t.x + 1);
                        y1 = std::max(y1, t.y + 1);
                    }
                }
                const int64_t n = r.domain.tile_cells();
                const auto within = [n](int64_t lo, int64_t hi, uint32_t bits) {
                    return lo * n + static_cast<int64_t>(
                                        static_cast<uint64_t>(bits) * static_cast<uint64_t>((hi - lo) * n) >> 32);
                };
                const Random4 centre = RandomStream(seed, step, Purpose::supply, 1).at(0, 0);
                SupplyPass f;
                f.sand = r.domain.ints(SimLayer::sand);
                f.places = r.domain.places();
                f.random = RandomStream(seed, step, Purpose::supply);
                f.twice_mean = 2.0f * k_ticks_per_m * (remove ? -p.supply_remove_m : p.supply_add_m);
                f.everywhere = remove || p.supply_uniform;
                f.centre_x = within(x0, x1, centre.v[0]);
                f.centre_y = within(y0, y1, centre.v[1]);
                f.radius = p.supply_radius_cells;
                f.period_x = f.places.period_x;
                f.period_y = f.places.period_y;
                if (r.domain.on_device()) return cuda::run_supply(r.launch, f);
                SAHEL_ISA_CALL(run_supply, r.launch, f);
                return {};
            }};
}

} // namespace sahel
