#pragma once

#include "world/field.h"

#include <benchmark/benchmark.h>

#include <cstdint>
#include <string>

/// What `sahel bench` measures, one file per group. Every case whose result is data reports its hash: a fast wrong
/// answer must not look like progress.
namespace sahel::tools {

/// Measured once, before the first case; GB/s of a triad, 0: unknown.
struct BenchMachine {
    double one_core_gb_per_s = 0.0;
    double all_cores_gb_per_s = 0.0;
    double cuda_gb_per_s = 0.0;
};

struct BenchOptions {
    BenchMachine machine;
    int tile_cells = 512; ///< side of the square that terrain cases make
};

void add_avalanche_benchmarks(const BenchOptions& options);
void add_terrain_benchmarks(const BenchOptions& options);
void add_sand_benchmarks(const BenchOptions& options);
void add_store_benchmarks(const BenchOptions& options);
void add_streaming_benchmarks(const BenchOptions& options);
void add_view_benchmarks(const BenchOptions& options);
void add_wind_benchmarks(const BenchOptions& options);

/// Twelve digits over the owned cells of all layers of the state, whatever the rows' padding.
std::string bench_hash(const LayerBlock& block);

/// Cells and bytes of one iteration: gives "Mcells/s", "GB/s" (the least that had to move) and "%mem" (of
/// `memory_gb_per_s`, where that is known).
void set_rates(benchmark::State& state, double cells, double least_bytes, double memory_gb_per_s);

} // namespace sahel::tools
