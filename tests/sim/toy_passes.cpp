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

} // namespace sahel::test
