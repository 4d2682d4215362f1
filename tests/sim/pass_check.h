#pragma once

#include "sim/step_plan.h"
#include "sim/tile_domain.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

/// What every registered pass must pass.
namespace sahel::test {

/// Runs the pass on small tiles of random cells, then again with other noise wherever the declaration says the pass
/// does not look: beyond each read's radius, and everywhere in layers it does not read. The cells it writes must be the
/// same, all others must be untouched. Empty if so, else the first difference. `layers`: all that the pass may touch.
std::string find_dishonest(const Pass& pass, SimLayerSet layers, uint64_t seed);

/// One way to cut and run a world.
struct RunWay {
    int32_t tile_cells = 128;
    int32_t halo = 16;
    int threads = 1;
    VisitOrder order = VisitOrder::forward;
    bool v3 = false;
    bool reversed_slots = false;
    bool device = false;
};
std::string text_of(const RunWay& way);

/// All ways of the promise P1 that divide `side`; with `quick` every value of every choice, but not every combination.
std::vector<RunWay> run_ways(int32_t side, bool quick);

/// Makes a periodic domain of side x side cells cut that way; sets threads and instruction set for the whole process.
TileDomain make_periodic(int32_t side, const RunWay& way, SimLayerSet layers, MemoryPool& pool = MemoryPool::host());

/// Restores threads and instruction set when it goes.
struct RestoreMachine {
    RestoreMachine() = default;
    RestoreMachine(const RestoreMachine&) = delete;
    RestoreMachine& operator=(const RestoreMachine&) = delete;
    ~RestoreMachine();
};

bool long_tests();

} // namespace sahel::test
