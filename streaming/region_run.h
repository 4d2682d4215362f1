#pragma once

#include "sim/aeolian.h"
#include "sim/ledger.h"
#include "sim/tile_domain.h"
#include "streaming/simulation_params.h"
#include "world/result.h"
#include "world/world.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

/// A rectangle of tiles of a world, resident and simulated: loaded with what waits in their inboxes, advanced step by
/// step, committed at the end, at checkpoints and when stopped.
///
///     . . . . . .      #  resident: owned by the run
///     . o o o o .      o  asleep: as far as the halo reaches, loaded once as they were committed (what waits in their
///     . o # # o .         inboxes is not part of that, so that a run that stops and goes on sees the same); what flows
///     . o # # o .         there is kept and goes into their inboxes with the commit
///     . o o o o .      .  not looked at
///
/// A commit is one transaction: tiles, inboxes, the ledger, and the wind of the running epoch, with which a later run
/// goes on to the bits of one that never stopped. A ledger that does not close is an error, and nothing is committed.
namespace sahel {

/// Tiles [x0, x1) x [y0, y1) of level 0.
struct TileRect {
    int32_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    [[nodiscard]] int64_t count() const { return (int64_t{x1} - x0) * (int64_t{y1} - y0); }
    friend bool operator==(const TileRect&, const TileRect&) = default;
};
/// "X0,Y0,X1,Y1". Errors: usage (malformed, out of range, empty, too many tiles).
Result<TileRect> parse_tile_rect(std::string_view text);

struct RegionOptions {
    TileRect region;
    SimulationParams simulation;
    std::string device = "auto";  ///< auto, cpu, cuda:0
    int32_t halo = 0;             ///< 0: chosen
    uint64_t memory_bytes = 0;    ///< of the machine that computes; 0: what it has
    int64_t checkpoint_steps = 0; ///< commits between; 0: only at the end
};

/// What a run needs at least.
struct RegionMemory {
    uint64_t tiles_bytes = 0;   ///< slabs, flows and inboxes: on the CPU exactly what is taken, on a device a bound
    uint64_t working_bytes = 0; ///< loading, wind, commits: a bound; of the host
    [[nodiscard]] uint64_t least_bytes(bool device) const { return tiles_bytes + (device ? 0 : working_bytes); }
};

struct RegionStep {
    int64_t step; ///< of the world, after it was made
    const AeolianStats& stats;
    TileDomain& domain; ///< to look at, for pictures
};

class RegionRun {
  public:
    /// Loads the region. Errors: usage (parameters, halo, device, memory: says the least), corrupt, io.
    static Result<RegionRun> open(World& world, const RegionOptions& options);
    static RegionMemory memory_needed(const RegionOptions& options, const WorldDesc& desc, int32_t halo, bool device);

    RegionRun(RegionRun&&) noexcept;
    RegionRun& operator=(RegionRun&&) noexcept;
    ~RegionRun();

    /// Called after each step; false: commit and stop.
    using OnStep = std::function<bool(const RegionStep&)>;
    /// Advances to the step and commits. False: stopped by the callback before. After an error the world is as last
    /// committed.
    Result<bool> run(int64_t until_step, const OnStep& on_step = {});

    [[nodiscard]] int64_t step() const;
    [[nodiscard]] TileDomain& domain();
    [[nodiscard]] const AeolianStats& stats() const;
    [[nodiscard]] bool goes_on() const;         ///< found the wind of the epoch that a run before it left
    [[nodiscard]] uint64_t tiles_bytes() const; ///< taken of the pool, at most so far
    /// Of the committed steps of this run.
    [[nodiscard]] const LedgerBook& ledger() const;

  private:
    struct Impl;
    explicit RegionRun(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

/// The account of a world, and what waits in its inboxes.
struct WorldLedger {
    LedgerBook book;
    std::array<int64_t, k_conserved_count> waiting{};
    LedgerCheck check;
};
/// Errors: corrupt, io. A ledger that does not close is no error here: `check` says so.
Result<WorldLedger> read_world_ledger(const World& world);
/// Also adds up what the stored tiles hold, against what the ledger says. One line for each thing that is wrong.
Result<std::vector<std::string>> verify_world_ledger(const World& world);

} // namespace sahel
