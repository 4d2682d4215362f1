#include "streaming/stream_bench.h"

#include <gtest/gtest.h>

#include <cstdio>

namespace sahel {

TEST(StreamBench, SameOrderEveryRunAndFullPool) {
    StreamBenchOptions options;
    options.known_nodes = 2000;
    options.frames = 200;
    const StreamBenchResult a = run_stream_bench(options), b = run_stream_bench(options);
    EXPECT_EQ(a.hash, b.hash);
    EXPECT_NE(a.hash, 0u);
    EXPECT_EQ(a.loads, b.loads);
    EXPECT_GT(a.loads, 0);
    EXPECT_GE(a.known_nodes, 1900);
    EXPECT_LE(a.p50_ms, a.p99_ms);
    EXPECT_LE(a.p99_ms, a.max_ms);
}

TEST(StreamBench, TenThousandKnownNodes) { // prints; no time decides
    for (const float lod_factor : {2.1f, 6.0f}) {
        StreamBenchOptions options;
        options.lod_factor = lod_factor;
        const StreamBenchResult r = run_stream_bench(options);
        EXPECT_GE(r.known_nodes, 9900);
        std::printf("lod_factor %.1f: %d known, %d wanted, %lld loads in %d frames; p50 %.3f p95 %.3f p99 %.3f max "
                    "%.3f ms, wall p99 %.3f ms\n",
                    static_cast<double>(lod_factor), r.known_nodes, r.wanted_nodes, static_cast<long long>(r.loads),
                    r.frames, r.p50_ms, r.p95_ms, r.p99_ms, r.max_ms, r.wall_p99_ms);
    }
}

} // namespace sahel
