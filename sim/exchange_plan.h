#pragma once

#include "sim/directions.h"
#include "sim/sim_layers.h"
#include "sim/slab_view.h"
#include "world/executor.h"
#include "world/tile_key.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

/// Who holds the cells of a halo, worked out once for each layout of resident tiles. The eight segments of a tile's
/// halo (four sides, four corners) each have one named border:
///
///     +--+---------+--+     neighbour  the resident tile beside it (periodic worlds: the one across the seam)
///     | 5|    6    | 7|     wall       cells of the own side, mirrored: what would leave comes back from the image
///     +--+---------+--+     frozen     a tile of the world that is not resident: its cells are loaded once and do not
///     |  |         |  |                change; what flows there is kept in its inbox (ledger.h)
///     | 4|  owned  | 0|     open       the end of the world: ground goes on as it ends, nothing comes in
///     |  |         |  |     level      open, and water stands at a fixed level outside
///     +--+---------+--+
///     | 3|    2    | 1|     Cells of neighbour and wall segments are live: passes compute them, exchanges refresh
///     +--+---------+--+     them. The others are never computed; open and level ones are filled from the edge.
///
/// Copies between one pair of tiles form one message: packed, sent, unpacked as a whole.
namespace sahel {

enum class Border : uint8_t { neighbour, wall, frozen, open, level, periodic };

constexpr bool is_live(Border b) {
    return b == Border::neighbour || b == Border::wall || b == Border::periodic;
}

/// The tiles and the rectangle of the world they lie in.
struct TileLayout {
    int32_t tile_cells = 0;
    int32_t halo = 0;                           ///< at most tile_cells
    std::vector<TileKey> tiles;                 ///< slot order; any order gives the same results
    bool bounded = false;                       ///< else the world has no end: every missing tile is frozen
    int64_t tx0 = 0, ty0 = 0, tx1 = 0, ty1 = 0; ///< bounds, in tiles
    Border west = Border::open, east = Border::open, north = Border::open, south = Border::open;
    int32_t level_ticks = 0; ///< height of the water beyond level borders

    /// A rectangle of tiles, all resident, with one border all around (not neighbour or frozen).
    static TileLayout rectangle(int32_t tile_cells, int32_t halo, int64_t tiles_x, int64_t tiles_y, Border border,
                                int64_t first_x = 0, int64_t first_y = 0);
};

/// A rectangle of halo cells and the owned cells they copy: dst (x, y) <- src (src_x + (x - dst.x0) step_x, ...).
struct HaloCopy {
    int32_t src_slot = 0;
    int32_t dst_slot = 0;
    LocalRect dst;
    int32_t src_x = 0, src_y = 0;
    int32_t step_x = 1, step_y = 1; ///< -1: mirrored
};

/// All copies from one tile to another, in a fixed order.
struct HaloMessage {
    int32_t src_slot = 0;
    int32_t dst_slot = 0;
    int32_t first_copy = 0;
    int32_t copy_count = 0;
    int64_t cells = 0; ///< words of 4 bytes for each layer sent
};

/// Cells beyond an open or level border: filled from the nearest column or row that is not. (Frozen ones are listed for
/// the layers that are nothing there.)
struct EdgeFill {
    int32_t slot = 0;
    LocalRect dst;
    LocalRect from; ///< coordinates are clamped into this
    Border border = Border::open;
};

/// The other side of a border: what crosses border `direction` of a slot is what its partner sees cross its own, with
/// the opposite sign. A wall is its own partner; beside a corner of one it is the tile next to it along the wall.
struct BorderPartner {
    int32_t slot = -1; ///< -1: nobody is there (frozen, open, level)
    int32_t direction = 0;
};

class ExchangePlan {
  public:
    ExchangePlan() = default;
    explicit ExchangePlan(const TileLayout& layout);

    [[nodiscard]] Border border(int32_t slot, int direction) const {
        return borders_[static_cast<size_t>(slot)][static_cast<size_t>(direction)];
    }
    [[nodiscard]] BorderPartner partner(int32_t slot, int direction) const {
        return partners_[static_cast<size_t>(slot)][static_cast<size_t>(direction)];
    }
    [[nodiscard]] std::span<const HaloCopy> copies() const { return copies_; }
    [[nodiscard]] std::span<const HaloMessage> messages() const { return messages_; }
    [[nodiscard]] std::span<const EdgeFill> fills() const { return fills_; }
    [[nodiscard]] bool has_frozen() const { return has_frozen_; }
    /// Halo cells of one direction.
    [[nodiscard]] LocalRect segment(int direction) const;
    /// Owned cells and `margin` halo cells, where they are live, as few rectangles as possible.
    void cover(int32_t slot, int32_t margin, std::vector<LocalRect>& out) const;

    /// Words of 4 bytes of a message for so many layers.
    static int64_t message_words(const HaloMessage& m, int layers) { return m.cells * layers; }
    /// Copies what the message carries of one layer into `words` (m.cells of them), and from them into the halo.
    void pack(const HaloMessage& m, SimLayer layer, SlabView<const int32_t> slab, int32_t* words) const;
    void unpack(const HaloMessage& m, SlabView<int32_t> slab, const int32_t* words) const;

  private:
    int32_t n_ = 0;
    int32_t halo_ = 0;
    bool has_frozen_ = false;
    std::vector<std::array<Border, k_direction_count>> borders_;
    std::vector<std::array<BorderPartner, k_direction_count>> partners_;
    std::vector<HaloCopy> copies_; ///< grouped by message
    std::vector<HaloMessage> messages_;
    std::vector<EdgeFill> fills_;
};

/// The word that a halo cell receives: mirrored vectors change their sign.
SAHEL_HD uint32_t mirrored_word(uint32_t word, Mirror mirror, bool flip_x, bool flip_y) {
    if ((mirror == Mirror::odd_x && flip_x) || (mirror == Mirror::odd_y && flip_y))
        return word ^ 0x80000000u; // a float
    return word;
}

/// How one layer is filled beyond the borders where nothing is simulated.
enum class EdgeRule : uint8_t { as_edge, nothing, sealed, water };
struct EdgeLayers {
    SlabView<uint32_t> words;
    SlabView<const int32_t> bedrock, soil, sand; ///< for water: what lies under it
    EdgeRule rule;
    int32_t level_ticks;

    SAHEL_HD void fill(const EdgeFill& f, int32_t x, int32_t y) const {
        if (rule == EdgeRule::nothing) {
            words(f.slot, x, y) = 0;
            return;
        }
        if (rule == EdgeRule::sealed) {
            words(f.slot, x, y) = k_sealed_bits;
            return;
        }
        if (f.border == Border::frozen) return; // loaded
        if (rule == EdgeRule::water && f.border == Border::level) {
            const int32_t ground = bedrock(f.slot, x, y) + soil(f.slot, x, y) + sand(f.slot, x, y);
            words(f.slot, x, y) = level_ticks > ground ? static_cast<uint32_t>(level_ticks - ground) : 0u;
            return;
        }
        const int32_t fx = x < f.from.x0 ? f.from.x0 : (x >= f.from.x1 ? f.from.x1 - 1 : x);
        const int32_t fy = y < f.from.y0 ? f.from.y0 : (y >= f.from.y1 ? f.from.y1 - 1 : y);
        words(f.slot, x, y) = words(f.slot, fx, fy);
    }
};

} // namespace sahel
