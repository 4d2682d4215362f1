#include "sim/avalanche_passes.h"

#include "sim/avalanche_cuda.h"
#include "sim/avalanche_donors.h"
#include "sim/avalanche_ground.h"

#include <algorithm>

namespace sahel {

namespace {

template <class Run>
std::vector<uint8_t> on_blocks(const char* name, const TileDomain& d, const std::vector<SlideWork>& work,
                               const Run& run) {
    std::vector<uint8_t> slid(work.size(), 0);
    int64_t cells = 0;
    for (const SlideWork& w : work) cells += w.rect.area();
    run(SlideLaunch{name, work.data(), static_cast<int32_t>(work.size()), slid.data(),
                    d.order() == VisitOrder::backward, cells});
    return slid;
}

// The launch of a plan, cut into blocks.
std::vector<SlideWork> blocks_of(const Launch& l) {
    std::vector<SlideWork> work;
    for (int32_t i = 0; i < l.count; ++i) {
        const LocalRect r = l.items[i].rect;
        for (int32_t y = r.y0; y < r.y1; y += k_slide_block_y)
            for (int32_t x = r.x0; x < r.x1; x += k_slide_block_x)
                work.push_back({l.items[i].slot,
                                0,
                                {x, y, std::min(x + k_slide_block_x, r.x1), std::min(y + k_slide_block_y, r.y1)}});
    }
    return work;
}

constexpr PassDecl k_flows{"sim/avalanche flows",
                           {{SimLayer::bedrock, 1},
                            {SimLayer::soil, 1},
                            {SimLayer::sand, 1},
                            {SimLayer::repose, 1},
                            {SimLayer::slide_e, 0},
                            {SimLayer::slide_se, 0},
                            {SimLayer::slide_s, 0},
                            {SimLayer::slide_sw, 0}},
                           k_slide_flow_layers,
                           48};
constexpr PassDecl k_apply{"sim/avalanche apply",
                           {{SimLayer::sand, 0},
                            {SimLayer::slide_e, 1},
                            {SimLayer::slide_se, 1},
                            {SimLayer::slide_s, 1},
                            {SimLayer::slide_sw, 1}},
                           {SimLayer::sand},
                           24};
constexpr PassDecl k_sand_sweep{
    "sim/avalanche sand",
    {{SimLayer::bedrock, 2}, {SimLayer::soil, 2}, {SimLayer::sand, 2}, {SimLayer::repose, 1}},
    {SimLayer::surface_next},
    20};
constexpr PassDecl k_soil_sweep{"sim/avalanche soil",
                                {{SimLayer::bedrock, 2},
                                 {SimLayer::soil, 2},
                                 {SimLayer::sand, 1},
                                 {SimLayer::vegetation, 1},
                                 {SimLayer::moisture, 1}},
                                {SimLayer::surface_next},
                                24};
constexpr PassDecl k_rock_sweep{
    "sim/avalanche rock", {{SimLayer::bedrock, 2}, {SimLayer::object, 1}}, {SimLayer::surface_next}, 12};
constexpr PassDecl k_rock_to_sand_sweep{"sim/avalanche rock to sand",
                                        {{SimLayer::bedrock, 2}, {SimLayer::object, 1}, {SimLayer::sand, 0}},
                                        {SimLayer::sand, SimLayer::surface_next},
                                        20};

} // namespace

std::vector<uint8_t> run_slides(const TileDomain& d, const std::vector<SlideWork>& work, const SlideProbe& f) {
    return on_blocks("sim/avalanche probe", d, work, [&](const SlideLaunch& l) { SAHEL_ISA_CALL(probe_slides, l, f); });
}
std::vector<uint8_t> run_slides(const TileDomain& d, const std::vector<SlideWork>& work, const SlideSweep& f) {
    return on_blocks("sim/avalanche sweep", d, work, [&](const SlideLaunch& l) { SAHEL_ISA_CALL(sweep_slides, l, f); });
}
std::vector<uint8_t> run_slides(const TileDomain& d, const std::vector<SlideWork>& work, const SlideFlows& f) {
    return on_blocks("sim/avalanche flows", d, work, [&](const SlideLaunch& l) { SAHEL_ISA_CALL(flow_slides, l, f); });
}
void run_slides(const TileDomain& d, const std::vector<SlideWork>& work, const SlideApply& f) {
    on_blocks("sim/avalanche apply", d, work, [&](const SlideLaunch& l) { SAHEL_ISA_CALL(apply_slides, l, f); });
}

SlideFlows slide_flows(TileDomain& d, const SlideGround& ground, const SlideInertia& rule) {
    return {ground,
            rule,
            d.ints(SimLayer::slide_e),
            d.ints(SimLayer::slide_se),
            d.ints(SimLayer::slide_s),
            d.ints(SimLayer::slide_sw)};
}

SlideApply slide_apply(TileDomain& d, const SlideGround& ground) {
    return {ground,
            d.ints(SimLayer::slide_e),
            d.ints(SimLayer::slide_se),
            d.ints(SimLayer::slide_s),
            d.ints(SimLayer::slide_sw),
            d.ints(SimLayer::sand)};
}

std::vector<Pass> avalanche_passes(AvalancheKind kind, const SandParams& params, double cell_m) {
    const bool to_sand = received_layer(kind, params) != moving_layer(kind);
    const PassDecl& decl = kind == AvalancheKind::sand   ? k_sand_sweep
                           : kind == AvalancheKind::soil ? k_soil_sweep
                           : to_sand                     ? k_rock_to_sand_sweep
                                                         : k_rock_sweep;
    const auto ground = [params, cell_m, kind](TileDomain& d) -> Result<SlideGround> {
        SAHEL_ASSIGN(const SlideBorders borders, SlideBorders::of(d));
        return slide_ground(d, borders, params, cell_m, kind);
    };
    std::vector<Pass> passes;
    passes.push_back({decl, [ground, to_sand](const PassRun& r) -> Status {
                          SAHEL_ASSIGN(const SlideGround g, ground(r.domain));
                          SlideSweep sweep{g, {}, r.domain.ints(SimLayer::surface_next), {}};
                          if (to_sand) sweep.taken = r.domain.ints(SimLayer::sand);
                          if (r.domain.on_device()) return cuda::run_slides(r.launch, SlideSweepCell{sweep});
                          run_slides(r.domain, blocks_of(r.launch), sweep);
                          return {};
                      }});
    if (kind != AvalancheKind::sand) return passes;
    passes.push_back({k_flows, [ground, params, cell_m](const PassRun& r) -> Status {
                          SAHEL_ASSIGN(const SlideGround g, ground(r.domain));
                          const SlideFlows flows = slide_flows(r.domain, g, slide_inertia(params, cell_m));
                          if (r.domain.on_device()) return cuda::run_slides(r.launch, SlideFlowsCell{flows});
                          run_slides(r.domain, blocks_of(r.launch), flows);
                          return {};
                      }});
    passes.push_back({k_apply, [ground](const PassRun& r) -> Status {
                          SAHEL_ASSIGN(const SlideGround g, ground(r.domain));
                          const SlideApply apply = slide_apply(r.domain, g);
                          if (r.domain.on_device()) return cuda::run_slides(r.launch, SlideApplyCell{apply});
                          run_slides(r.domain, blocks_of(r.launch), apply);
                          return {};
                      }});
    return passes;
}

} // namespace sahel
