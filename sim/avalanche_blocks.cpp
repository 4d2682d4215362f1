#include "sim/avalanche_blocks.h"

#include <algorithm>

namespace sahel {

SlideBlocks::SlideBlocks(const SlideGrid& grid, bool adaptive)
    : grid_(grid), adaptive_(adaptive), quiet_(static_cast<size_t>(grid.count()), -1.0f) {}

std::vector<SlideWork> SlideBlocks::all(int32_t margin) const {
    return pick(margin, 1e30f);
}

std::vector<SlideWork> SlideBlocks::pick(int32_t margin, float strength) const {
    std::vector<SlideWork> work;
    int32_t block = 0;
    for (int32_t slot = 0; slot < grid_.slots; ++slot)
        for (int32_t by = 0; by < grid_.count_y; ++by)
            for (int32_t bx = 0; bx < grid_.count_x; ++bx, ++block) {
                if (adaptive_ && quiet_[static_cast<size_t>(block)] >= strength) continue;
                const LocalRect rect = grid_.rect(bx, by, margin);
                const int32_t repose = repose_.empty() ? k_uneven : repose_[static_cast<size_t>(block)];
                if (!rect.empty()) work.push_back({slot, block, rect, repose});
            }
    return work;
}

template <class F> void SlideBlocks::for_nine(int32_t slot, int32_t bx, int32_t by, const F& f) const {
    for (int32_t y = std::max(by - 1, 0); y <= std::min(by + 1, grid_.count_y - 1); ++y)
        for (int32_t x = std::max(bx - 1, 0); x <= std::min(bx + 1, grid_.count_x - 1); ++x)
            f(static_cast<size_t>(slot * grid_.per_slot() + y * grid_.count_x + x));
}

void SlideBlocks::wake(int32_t slot, int32_t bx, int32_t by) {
    for_nine(slot, bx, by, [&](size_t block) { quiet_[block] = -1.0f; });
}

void SlideBlocks::set_repose(const std::vector<int32_t>& of_block) {
    repose_ = of_block;
    size_t block = 0;
    for (int32_t slot = 0; slot < grid_.slots; ++slot)
        for (int32_t by = 0; by < grid_.count_y; ++by)
            for (int32_t bx = 0; bx < grid_.count_x; ++bx, ++block)
                for_nine(slot, bx, by, [&](size_t other) {
                    if (of_block[other] != of_block[block]) repose_[block] = k_uneven;
                });
}

bool SlideBlocks::note(const std::vector<SlideWork>& work, const std::vector<uint8_t>& slid, float strength) {
    bool any = false;
    for (const SlideWork& w : work) {
        float& quiet = quiet_[static_cast<size_t>(w.block)];
        quiet = std::max(quiet, strength);
    }
    for (size_t i = 0; i < work.size(); ++i) {
        if (slid[i] == 0) continue;
        any = true;
        const int32_t in_slot = work[i].block % grid_.per_slot();
        wake(work[i].slot, in_slot % grid_.count_x, in_slot / grid_.count_x);
    }
    return any;
}

void SlideBlocks::touch_halo() {
    for (int32_t slot = 0; slot < grid_.slots; ++slot)
        for (int32_t by = 0; by < grid_.count_y; ++by)
            for (int32_t bx = 0; bx < grid_.count_x; ++bx)
                if (grid_.in_halo(bx, by)) wake(slot, bx, by);
}

} // namespace sahel
