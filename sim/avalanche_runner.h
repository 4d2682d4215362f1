#pragma once

#include "sim/avalanche_passes.h"
#include "sim/tile_domain.h"

#include <cstdint>
#include <memory>

/// Runs sweeps on the domain's machine and keeps account of the blocks that can be left out (avalanche_blocks.h). On a
/// device nothing waits for a sweep: what slid is read when it is asked for.
namespace sahel {

class SlideRunner {
  public:
    SlideRunner() = default;
    SlideRunner(const SlideRunner&) = delete;
    SlideRunner& operator=(const SlideRunner&) = delete;
    virtual ~SlideRunner() = default;

    static Result<std::unique_ptr<SlideRunner>> make(TileDomain& domain, bool adaptive, int sweeps);

    /// False if nothing can slide anywhere. (A device does not look: it answers true.)
    virtual Result<bool> may_slide(const SlideProbe& probe) = 0;
    /// Sweep number n over `margin` halo cells.
    virtual Status sweep(int n, int32_t margin, const SlideSweep& f) = 0;
    virtual Status flows(int n, int32_t margin, const SlideFlows& f) = 0;
    virtual Status apply(int32_t margin, const SlideApply& f) = 0;
    /// Halos were refreshed.
    virtual Status halo_changed() = 0;
    /// Copies slabs, or what lies beyond the owned cells, or the blocks of the last sweep.
    enum class Part : uint8_t { all, halo, last_sweep };
    virtual Status copy(SlabView<const int32_t> from, SlabView<int32_t> to, Part part) = 0;
    virtual Status zero(SlabView<int32_t> flows) = 0;
    virtual Status border_flows(const BorderFlowsView& view, const SlideDonor& donor) = 0;
    virtual Status border_flows(const BorderFlowsView& view, const SlideFlowDonor& donor) = 0;
    /// Whether something slid in sweep n. `known`: whether that can be told now without waiting.
    [[nodiscard]] virtual bool known(int n) const = 0;
    virtual Result<bool> slid(int n) = 0;
    /// Cells worked out so far.
    virtual Result<int64_t> cells() = 0;
};

Result<std::unique_ptr<SlideRunner>> make_host_slides(TileDomain& domain, bool adaptive);
Result<std::unique_ptr<SlideRunner>> make_device_slides(TileDomain& domain, bool adaptive, int sweeps);

} // namespace sahel
