#pragma once

#include <cstdint>

/// How long one frame of the streamer takes in the owner's thread, with a pool full of known nodes. Loads cost nothing
/// and run between the frames, so what is timed is selection, residency, hand-over and the queues alone.
namespace sahel {

struct StreamBenchOptions {
    int known_nodes = 10000; ///< slots; the timing starts when all of them hold a node
    float lod_factor = 2.1f; ///< 2.1: some 200 nodes wanted at once; 6: some 2000
    int frames = 2000;       ///< timed: straight at 300 m/s, turns, a climb, a teleport now and then
};

struct StreamBenchResult {
    int frames = 0;
    int known_nodes = 0;                                           ///< least number in any timed frame
    int wanted_nodes = 0;                                          ///< mean of the timed frames
    int64_t loads = 0;                                             ///< during the timed frames
    double p50_ms = 0.0, p95_ms = 0.0, p99_ms = 0.0, max_ms = 0.0; ///< time of the core spent on a frame
    double wall_p99_ms = 0.0;                                      ///< with what other processes took from it meanwhile
    uint64_t hash = 0; ///< of the order of all loads: the same on every machine
};

/// Some seconds. Uses one core.
StreamBenchResult run_stream_bench(const StreamBenchOptions& options);

} // namespace sahel
