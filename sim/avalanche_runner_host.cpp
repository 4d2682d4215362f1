#include "sim/avalanche_donors.h"
#include "sim/avalanche_runner.h"

#include <cstring>
#include <utility>
#include <vector>

namespace sahel {

namespace {

class HostSlides final : public SlideRunner {
  public:
    HostSlides(TileDomain& domain, bool adaptive)
        : d_(domain), blocks_(SlideGrid::of(domain.tile_cells(), domain.halo(), domain.slots()), adaptive) {}

    Result<bool> may_slide(const SlideProbe& probe) override {
        const std::vector<SlideWork> everywhere = blocks_.all(d_.halo() - 1);
        return blocks_.note(everywhere, run_slides(d_, everywhere, probe), 1.0f);
    }
    Status sweep(int n, int32_t margin, const SlideSweep& f) override {
        if (n == 0 && f.ground.kind == AvalancheKind::sand) blocks_.set_repose(repose_of_blocks(f.ground));
        work_ = blocks_.pick(margin, f.rule.strength);
        slid_ = blocks_.note(work_, run_slides(d_, work_, f), f.rule.strength);
        count(work_);
        return {};
    }
    Status flows(int, int32_t margin, const SlideFlows& f) override {
        work_ = blocks_.pick(margin, 1.0f);
        slid_ = blocks_.note(work_, run_slides(d_, work_, f), 1.0f);
        count(work_);
        return {};
    }
    Status apply(int32_t margin, const SlideApply& f) override {
        if (slid_) run_slides(d_, blocks_.pick(margin, 1.0f), f);
        return {};
    }
    Status halo_changed() override {
        blocks_.touch_halo();
        return {};
    }
    Status copy(SlabView<const int32_t> from, SlabView<int32_t> to, Part part) override {
        if (part == Part::last_sweep) {
            for (const SlideWork& w : work_)
                for (int32_t y = w.rect.y0; y < w.rect.y1; ++y) copy_words(from, to, w.slot, y, w.rect.x0, w.rect.x1);
            return {};
        }
        const auto rows = [&](int32_t slot, int32_t y) {
            if (part == Part::halo && y >= 0 && y < d_.tile_cells()) {
                copy_words(from, to, slot, y, from.first, 0);
                copy_words(from, to, slot, y, d_.tile_cells(), from.last);
            } else {
                copy_words(from, to, slot, y, from.first, from.last);
            }
        };
        for_each_row("sim/avalanche copy", rows);
        return {};
    }
    Status zero(SlabView<int32_t> flows) override {
        for_each_row("sim/avalanche zero", [&](int32_t slot, int32_t y) {
            std::memset(flows.row(slot, y) + flows.first, 0, static_cast<size_t>(flows.last - flows.first) * 4);
        });
        return {};
    }
    Status border_flows(const BorderFlowsView& view, const SlideDonor& donor) override {
        if (slid_) add_border_flows("sim/avalanche border", d_.slots(), view, 1, donor);
        return {};
    }
    Status border_flows(const BorderFlowsView& view, const SlideFlowDonor& donor) override {
        if (slid_) add_border_flows("sim/avalanche border", d_.slots(), view, 1, donor);
        return {};
    }
    [[nodiscard]] bool known(int) const override { return true; }
    Result<bool> slid(int) override { return slid_; }
    Result<int64_t> cells() override { return cells_; }

  private:
    static void copy_words(SlabView<const int32_t> from, SlabView<int32_t> to, int32_t slot, int32_t y, int32_t x0,
                           int32_t x1) {
        std::memcpy(to.row(slot, y) + x0, from.row(slot, y) + x0, static_cast<size_t>(x1 - x0) * 4);
    }
    template <class F> void for_each_row(const char* name, const F& f) const {
        const int32_t rows = d_.tile_cells() + 2 * d_.halo();
        for_each_index(name, int64_t{rows} * rows * d_.slots(), int64_t{rows} * d_.slots(), [&](int64_t i) {
            f(static_cast<int32_t>(i / rows), static_cast<int32_t>(i % rows) - d_.halo());
        });
    }
    // Ticks of repose of each block, k_uneven where its cells differ.
    [[nodiscard]] std::vector<int32_t> repose_of_blocks(const SlideGround& ground) const {
        const SlideGrid& grid = blocks_.grid();
        std::vector<int32_t> found(static_cast<size_t>(grid.count()), k_uneven);
        for_each_index("sim/avalanche repose", d_.owned_cells(), int64_t{grid.slots} * grid.count_y, [&](int64_t i) {
            const auto slot = static_cast<int32_t>(i / grid.count_y);
            const auto by = static_cast<int32_t>(i % grid.count_y);
            for (int32_t bx = 0; bx < grid.count_x; ++bx) {
                const LocalRect r = grid.rect(bx, by, grid.halo);
                if (r.empty()) continue;
                const float first = ground.repose(slot, r.x0, r.y0);
                bool even = true;
                for (int32_t y = r.y0; y < r.y1; ++y) {
                    const float* const row = ground.repose.row(slot, y);
                    for (int32_t x = r.x0; x < r.x1; ++x) even &= row[x] == first;
                }
                if (even)
                    found[static_cast<size_t>(i * grid.count_x + bx)] = repose_ticks(first, ground.ticks_per_tangent);
            }
        });
        return found;
    }
    void count(const std::vector<SlideWork>& work) {
        for (const SlideWork& w : work) cells_ += w.rect.area();
    }

    TileDomain& d_;
    SlideBlocks blocks_;
    std::vector<SlideWork> work_;
    bool slid_ = false;
    int64_t cells_ = 0;
};

} // namespace

Result<std::unique_ptr<SlideRunner>> make_host_slides(TileDomain& domain, bool adaptive) {
    return std::unique_ptr<SlideRunner>(std::make_unique<HostSlides>(domain, adaptive));
}

Result<std::unique_ptr<SlideRunner>> SlideRunner::make(TileDomain& domain, bool adaptive, int sweeps) {
    return domain.on_device() ? make_device_slides(domain, adaptive, sweeps) : make_host_slides(domain, adaptive);
}

} // namespace sahel
