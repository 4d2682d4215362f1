#include "sim/avalanche_cuda.h"
#include "sim/avalanche_runner.h"
#include "world/cuda_runtime.h"

#include <fmt/format.h>

#include <utility>
#include <vector>

namespace sahel {

namespace {

constexpr int k_ask_every = 16; // sweeps: waiting for a device costs about as much as a few quiet sweeps

class DeviceSlides final : public SlideRunner {
  public:
    DeviceSlides(TileDomain& domain, int sweeps) : d_(domain), sweeps_(sweeps) {}

    Status open(bool adaptive) {
        flags_.grid = SlideGrid::of(d_.tile_cells(), d_.halo(), d_.slots(), cuda::k_slide_device_block_x,
                                    cuda::k_slide_device_block_y);
        flags_.adaptive = adaptive;
        const auto blocks = static_cast<uint64_t>(flags_.grid.count());
        const uint64_t marks = (blocks + 15) / 16 * 16;
        const auto counters = static_cast<uint64_t>(sweeps_);
        SAHEL_ASSIGN(void* const of_blocks, d_.scratch("avalanche blocks", 2 * marks + 4 * blocks));
        SAHEL_ASSIGN(void* const of_sweeps,
                     d_.scratch(fmt::format("avalanche of {} sweeps", sweeps_), 16 + 4 * counters));
        flags_.before = static_cast<uint8_t*>(of_blocks);
        flags_.now = flags_.before + marks;
        flags_.quiet = reinterpret_cast<float*>(flags_.now + marks);
        flags_.cells = static_cast<unsigned long long*>(of_sweeps);
        of_sweeps_ = reinterpret_cast<int32_t*>(flags_.cells + 2);
        const std::vector<int32_t> zeros(4 + counters, 0);
        SAHEL_TRY(cuda::copy_to_device(of_sweeps, zeros.data(), zeros.size() * 4));
        return cuda::wake_slides(flags_);
    }
    Result<bool> may_slide(const SlideProbe&) override { return true; }
    Status sweep(int n, int32_t margin, const SlideSweep& f) override {
        flags_.slid = of_sweeps_ + n;
        SAHEL_TRY(cuda::sweep_slides(flags_, margin, f));
        std::swap(flags_.before, flags_.now);
        return {};
    }
    Status flows(int n, int32_t margin, const SlideFlows& f) override {
        flags_.slid = of_sweeps_ + n;
        SAHEL_TRY(cuda::flow_slides(flags_, margin, f));
        std::swap(flags_.before, flags_.now);
        return {};
    }
    Status apply(int32_t margin, const SlideApply& f) override {
        cuda::SlideFlags of_last = flags_;
        of_last.now = flags_.before;
        return cuda::apply_slides(of_last, margin, f);
    }
    Status halo_changed() override { return cuda::wake_slides_in_halo(flags_); }
    Status copy(SlabView<const int32_t> from, SlabView<int32_t> to, Part part) override {
        return cuda::copy_slides(d_.slots(), d_.tile_cells(), from, to, part == Part::halo);
    }
    Status zero(SlabView<int32_t> flows) override { return cuda::zero_slides(d_.slots(), flows); }
    Status border_flows(const BorderFlowsView& view, const SlideDonor& donor) override {
        return cuda::add_slide_flows(d_.slots(), view, donor);
    }
    Status border_flows(const BorderFlowsView& view, const SlideFlowDonor& donor) override {
        return cuda::add_slide_flows(d_.slots(), view, donor);
    }
    [[nodiscard]] bool known(int n) const override { return (n + 1) % k_ask_every == 0 || n + 1 == sweeps_; }
    Result<bool> slid(int n) override {
        int32_t any = 0;
        SAHEL_TRY(cuda::copy_to_host(&any, of_sweeps_ + n, 4));
        return any != 0;
    }
    Result<int64_t> cells() override {
        unsigned long long cells = 0;
        SAHEL_TRY(cuda::copy_to_host(&cells, flags_.cells, sizeof cells));
        return static_cast<int64_t>(cells);
    }

  private:
    TileDomain& d_;
    int sweeps_;
    cuda::SlideFlags flags_;
    int32_t* of_sweeps_ = nullptr;
};

} // namespace

Result<std::unique_ptr<SlideRunner>> make_device_slides(TileDomain& domain, bool adaptive, int sweeps) {
    auto slides = std::make_unique<DeviceSlides>(domain, sweeps);
    SAHEL_TRY(slides->open(adaptive));
    return std::unique_ptr<SlideRunner>(std::move(slides));
}

} // namespace sahel
