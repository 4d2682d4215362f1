#pragma once

#include "world/executor.h"
#include "world/macros.h"

#include <cstdint>
#include <vector>

/// Blocks of cells of every slot, and which of them a sweep can leave out without changing a bit.
///
///     columns  -1 |    0    |    1    | 2       block 0 starts at cell 0: the halo has blocks of its own
///     -----------+---------+---------+---
///                |         |         |            64 x 32 cells on the host, 64 x 16 on a device
///
/// What a cell becomes depends on cells within 2 of it, hence on its own block and the eight around. If nothing slid
/// in any of the nine since the block was last worked out, and nothing slid in it then, nothing will slide in it now.
/// "Slid" means that a transfer of at least one tick touched a cell of the block.
namespace sahel {

inline constexpr int32_t k_slide_block_x = 64;
inline constexpr int32_t k_slide_block_y = 32;

struct SlideGrid {
    int32_t n = 0, halo = 0, slots = 0;
    int32_t block_x = k_slide_block_x, block_y = k_slide_block_y;
    int32_t first_x = 0, first_y = 0; ///< least block column and row: 0 or negative
    int32_t count_x = 0, count_y = 0;

    SAHEL_HD static SlideGrid of(int32_t n, int32_t halo, int32_t slots, int32_t block_x = k_slide_block_x,
                                 int32_t block_y = k_slide_block_y) {
        const int32_t out_x = (halo + block_x - 1) / block_x;
        const int32_t out_y = (halo + block_y - 1) / block_y;
        return {n,
                halo,
                slots,
                block_x,
                block_y,
                -out_x,
                -out_y,
                (n + halo + block_x - 1) / block_x + out_x,
                (n + halo + block_y - 1) / block_y + out_y};
    }
    [[nodiscard]] SAHEL_HD int32_t per_slot() const { return count_x * count_y; }
    [[nodiscard]] SAHEL_HD int32_t count() const { return slots * per_slot(); }
    /// Cells of block (bx, by), counted from 0, within `margin` cells around the owned ones.
    [[nodiscard]] SAHEL_HD LocalRect rect(int32_t bx, int32_t by, int32_t margin) const {
        const int32_t x = (bx + first_x) * block_x;
        const int32_t y = (by + first_y) * block_y;
        const int32_t lo = -margin;
        const int32_t hi = n + margin;
        return {x > lo ? x : lo, y > lo ? y : lo, x + block_x < hi ? x + block_x : hi,
                y + block_y < hi ? y + block_y : hi};
    }
    [[nodiscard]] SAHEL_HD bool in_halo(int32_t bx, int32_t by) const {
        const LocalRect r = rect(bx, by, halo);
        return r.x0 < 0 || r.y0 < 0 || r.x1 > n || r.y1 > n;
    }
};

inline constexpr int32_t k_uneven = -1; ///< repose of a block that has more than one

/// Cells of one block that a sweep works out.
struct SlideWork {
    int32_t slot = 0;
    int32_t block = 0;
    LocalRect rect;
    int32_t repose = k_uneven; ///< ticks, where it is known to be the same in the block and all around it
};

/// The host's account of what may move.
class SlideBlocks {
  public:
    SlideBlocks(const SlideGrid& grid, bool adaptive);

    [[nodiscard]] const SlideGrid& grid() const { return grid_; }
    /// The repose of each block, k_uneven where it is not the same in all its cells: most sand has one angle of repose,
    /// and sweeps need not read it then.
    void set_repose(const std::vector<int32_t>& of_block);
    /// Every block of the region.
    [[nodiscard]] std::vector<SlideWork> all(int32_t margin) const;
    /// Those in which something may slide under a rule of this strength. A block that was quiet under a stronger rule
    /// is quiet under a weaker one: every transfer grows with the strength.
    [[nodiscard]] std::vector<SlideWork> pick(int32_t margin, float strength) const;
    /// After the blocks were worked out: in which of them something slid. Returns whether in any.
    bool note(const std::vector<SlideWork>& work, const std::vector<uint8_t>& slid, float strength);
    /// Halos were refreshed: whatever lies there may have changed.
    void touch_halo();

  private:
    void wake(int32_t slot, int32_t bx, int32_t by);
    template <class F> void for_nine(int32_t slot, int32_t bx, int32_t by, const F& f) const;

    SlideGrid grid_;
    bool adaptive_;
    std::vector<int32_t> repose_; ///< of each block and the eight around it; empty: not known
    std::vector<float> quiet_;    ///< of each block: strongest rule under which nothing slides; below 0: not known
};

} // namespace sahel
