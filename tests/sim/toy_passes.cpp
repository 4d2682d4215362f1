#include "toy_passes.h"

#include <utility>

namespace sahel::test {

#if !SAHEL_HAS_CUDA
namespace {
Status none() {
    return Error{ErrorKind::unsupported, "built without CUDA"};
}
} // namespace
Status run_smooth_cuda(const Launch&, const SmoothPass&) {
    return none();
}
Status run_slump_cuda(const Launch&, const SlumpPass&) {
    return none();
}
Status run_hop_cuda(const Launch&, const HopPass&) {
    return none();
}
Status run_drift_cuda(const Launch&, const DriftPass&) {
    return none();
}
Status run_drift_flows_cuda(int32_t, const BorderFlowsView&, const DriftDonor&) {
    return none();
}
Status run_land_cuda(const Launch&, const LandPass&) {
    return none();
}
#endif

Pass smooth_pass() {
    return {SmoothPass::k_decl, [](const PassRun& r) -> Status {
                const SmoothPass f{std::as_const(r.domain).ints(SimLayer::sand), r.domain.reals(SimLayer::wind_shadow)};
                if (r.domain.on_device()) return run_smooth_cuda(r.launch, f);
                SAHEL_ISA_CALL(run_smooth, r.launch, f);
                return {};
            }};
}

Pass slump_pass(int32_t reach) {
    return {SlumpPass::k_decl, [reach](const PassRun& r) -> Status {
                const SlumpPass f{std::as_const(r.domain).ints(SimLayer::sand),
                                  std::as_const(r.domain).reals(SimLayer::wind_shadow),
                                  r.domain.ints(SimLayer::surface), reach};
                if (r.domain.on_device()) return run_slump_cuda(r.launch, f);
                SAHEL_ISA_CALL(run_slump, r.launch, f);
                return {};
            }};
}

Pass hop_pass(uint64_t seed, int64_t step) {
    return {HopPass::k_decl, [seed, step](const PassRun& r) -> Status {
                const HopPass f{std::as_const(r.domain).ints(SimLayer::surface), r.domain.ints(SimLayer::sand),
                                r.domain.places(), RandomStream(seed, step, Purpose::test)};
                if (r.domain.on_device()) return run_hop_cuda(r.launch, f);
                SAHEL_ISA_CALL(run_hop, r.launch, f);
                return {};
            }};
}

std::vector<Pass> drift_passes() {
    const auto drift = [](const PassRun& r) -> Status {
        const DriftPass f{std::as_const(r.domain).ints(SimLayer::airborne_sand),
                          std::as_const(r.domain).reals(SimLayer::wind_x),
                          std::as_const(r.domain).reals(SimLayer::wind_y), r.domain.ints(SimLayer::hopping)};
        if (r.domain.on_device()) {
            if (r.domain.keeps_flows())
                SAHEL_TRY(run_drift_flows_cuda(r.domain.slots(), r.domain.border_flows(SimLayer::airborne_sand), {f}));
            return run_drift_cuda(r.launch, f);
        }
        if (r.domain.keeps_flows())
            add_border_flows("test/drift_flows", r.domain.slots(), r.domain.border_flows(SimLayer::airborne_sand),
                             DriftPass::k_reach, DriftDonor{f});
        SAHEL_ISA_CALL(run_drift, r.launch, f);
        return {};
    };
    const auto land = [](const PassRun& r) -> Status {
        const LandPass f{std::as_const(r.domain).ints(SimLayer::hopping), r.domain.ints(SimLayer::airborne_sand)};
        if (r.domain.on_device()) return run_land_cuda(r.launch, f);
        SAHEL_ISA_CALL(run_land, r.launch, f);
        return {};
    };
    return {{DriftPass::k_decl, drift}, {LandPass::k_decl, land}};
}

} // namespace sahel::test
