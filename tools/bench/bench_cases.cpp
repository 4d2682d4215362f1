#include "tools/bench/bench_cases.h"

#include "world/state_hash.h"

#include <vector>

namespace sahel::tools {

std::string bench_hash(const LayerBlock& block) {
    std::vector<int32_t> cells;
    const auto w = static_cast<int32_t>(block.owned().width());
    block.layers().intersected(k_state_layers).for_each([&](Layer l) {
        const auto view = block.ints(l);
        for (int32_t y = 0; y < static_cast<int32_t>(block.owned().height()); ++y)
            cells.insert(cells.end(), view.row(y), view.row(y) + w);
    });
    return to_hex(checksum({reinterpret_cast<const uint8_t*>(cells.data()), cells.size() * 4})).substr(0, 12);
}

void set_rates(benchmark::State& state, double cells, double least_bytes, double memory_gb_per_s) {
    using benchmark::Counter;
    state.counters["Mcells/s"] = Counter(cells * 1e-6, Counter::kIsIterationInvariantRate);
    state.counters["GB/s"] = Counter(least_bytes * 1e-9, Counter::kIsIterationInvariantRate);
    if (memory_gb_per_s > 0.0)
        state.counters["%mem"] =
            Counter(100.0 * least_bytes * 1e-9 / memory_gb_per_s, Counter::kIsIterationInvariantRate);
}

} // namespace sahel::tools
