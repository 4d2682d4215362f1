#pragma once

#include "sim/ledger_sources.h"
#include "sim/sim_layers.h"
#include "sim/tile_domain.h"
#include "world/result.h"
#include "world/tile_key.h"

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

/// The ledger: every tick of every conserved layer, tile by tile. What a tile held at first, what named sources added,
/// what crossed each of its eight borders, and what it holds at last:
///
///                         to a neighbour (it came from there: negative)
///     opening             to a sleeping tile: waits in its inbox
///     + sources     ---------------------------------------------------->  flows by border
///     + conversions       to the end of the world: gone
///     = closing + flows
///
/// Conversions (rock that wears down to sand, sand that is lifted into the air, water that seeps away) are not counted
/// where they happen: they are what is left over in each layer, and over the layers of one substance they must add up
/// to zero. That is the residual of a tile. The residual of a border is what the tiles on its two sides say crossed it,
/// added up; each measures it alone. All are exact: int64 ticks (2^63 ticks are 7e13 m of cells of 1 m2: sixteen
/// thousand tiles of 2048 x 2048 cells, 1 km high).
namespace sahel {

/// Substances: within one, layers may turn into each other.
enum class LedgerGroup : uint8_t { solids, waters, count_ };
inline constexpr int k_ledger_group_count = static_cast<int>(LedgerGroup::count_);
inline constexpr std::array<std::string_view, k_ledger_group_count> k_ledger_group_names = {"solids", "waters"};

/// The conserved layers in the order of the accounts.
inline constexpr std::array<SimLayer, k_conserved_count> k_ledger_layers = [] {
    std::array<SimLayer, k_conserved_count> list{};
    size_t i = 0;
    k_conserved_layers.for_each([&](SimLayer l) { list[i++] = l; });
    return list;
}();
constexpr LedgerGroup group_of(SimLayer layer) {
    return layer == SimLayer::water || layer == SimLayer::moisture ? LedgerGroup::waters : LedgerGroup::solids;
}
size_t ledger_index(SimLayer layer);

/// Ticks of one layer of one tile (or of many, added up).
struct LayerAccount {
    using Borders = std::array<int64_t, k_direction_count>; ///< left by each border; came in: negative
    int64_t opening = 0;
    int64_t closing = 0;
    std::array<int64_t, k_ledger_source_count> sources{}; ///< added; taken: negative
    Borders exchanged{};                                  ///< with tiles that were resident (or through a wall)
    Borders to_frozen{};                                  ///< into inboxes of tiles that slept
    Borders to_open{};                                    ///< over the end of the world

    [[nodiscard]] int64_t added() const;
    [[nodiscard]] int64_t outflow() const;
    /// What other layers turned into this one.
    [[nodiscard]] int64_t converted() const { return closing - opening - added() + outflow(); }
    void add(const LayerAccount& other); ///< of another tile
    friend bool operator==(const LayerAccount&, const LayerAccount&) = default;
};

struct TileAccount {
    TileKey key;
    std::array<LayerAccount, k_conserved_count> layers;

    [[nodiscard]] LayerAccount& of(SimLayer layer) { return layers[ledger_index(layer)]; }
    [[nodiscard]] const LayerAccount& of(SimLayer layer) const { return layers[ledger_index(layer)]; }
    [[nodiscard]] int64_t residual(LedgerGroup group) const;
    /// Goes on with the next run of the same tile. Errors (corrupt): it did not open with what this one closed with,
    /// named with tile, layer and ticks.
    Status append(const TileAccount& later);
    friend bool operator==(const TileAccount&, const TileAccount&) = default;
};

/// A border on which the two sides do not agree, or (partner slot -1) an inbox that does not hold what left for it.
struct BorderResidual {
    TileKey tile;
    int direction = 0;
    SimLayer layer = SimLayer::count_;
    int64_t ticks = 0;
    bool inbox = false;
};

/// What does not close. Empty text: everything does.
struct LedgerCheck {
    std::array<int64_t, k_ledger_group_count> total{}; ///< over all tiles: change - sources + what left for good
    int64_t tiles_open = 0;                            ///< tiles whose residual is not zero
    std::vector<BorderResidual> borders;
    std::string text; ///< one line: the first tile, layer and ticks
    [[nodiscard]] bool closed() const { return text.empty(); }
};

/// The account of one run over the tiles of a domain.
class Ledger {
  public:
    /// Begins: the domain keeps flows from zero, what it holds is the opening. Errors: budget, those of the device.
    static Result<Ledger> open(TileDomain& domain);
    /// Ticks that the domain already holds, but that came out of the tile's inbox: a source, not part of the opening.
    void arrived(int32_t slot, SimLayer layer, int64_t ticks);
    /// A layer that the domain lacks: the tile holds so much of it, untouched.
    void untouched(int32_t slot, SimLayer layer, int64_t ticks);
    /// Ends: what the domain holds now is the closing. Errors: those of the device.
    Status close(const TileDomain& domain);

    [[nodiscard]] LedgerCheck check() const;
    [[nodiscard]] std::span<const TileAccount> tiles() const { return tiles_; }

  private:
    std::vector<TileAccount> tiles_; ///< by slot
    std::vector<std::array<BorderPartner, k_direction_count>> partners_;
    std::vector<BorderResidual> inboxes_;
    SimLayerSet counted_;
};

/// The account of a world: every run appended, by tile.
class LedgerBook {
  public:
    Status append(std::span<const TileAccount> run);
    void insert(const TileAccount& tile) { tiles_[tile.key] = tile; }
    [[nodiscard]] const std::map<TileKey, TileAccount>& tiles() const { return tiles_; }
    [[nodiscard]] LayerAccount total(SimLayer layer) const;
    /// Both sides of every border of the endless plane, every tile, and the whole; `waiting`: what lies in the world's
    /// inboxes, which is what went to sleeping tiles and has not arrived yet.
    [[nodiscard]] LedgerCheck check(const std::array<int64_t, k_conserved_count>& waiting) const;

  private:
    std::map<TileKey, TileAccount> tiles_;
};

/// A tile's account as bytes (ledger_bytes.cpp): runs of zeros take two bytes, numbers as many as they need.
std::vector<uint8_t> ledger_bytes(const TileAccount& account);
/// Errors: corrupt; `name` is part of the message.
Result<TileAccount> parse_ledger_bytes(TileKey key, std::span<const uint8_t> bytes, std::string_view name);

} // namespace sahel
