#include "streaming/stream_bench.h"

#include "streaming/streamer.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>

namespace sahel {

namespace {

class BenchPayload final : public TilePayload {
  public:
    explicit BenchPayload(TileKey key)
        : low_(static_cast<float>(std::hash<TileKey>{}(key)&255)), high_(low_ + static_cast<float>(8 << key.level)) {}
    [[nodiscard]] uint64_t bytes() const override { return sizeof(*this); }
    [[nodiscard]] float min_height_m() const override { return low_; }
    [[nodiscard]] float max_height_m() const override { return high_; }

  private:
    float low_, high_;
};

double thread_ms() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}

/// Straight on, a turn of the head, a climb and a dive, and every 500 frames somewhere else.
ViewState bench_view(int frame) {
    const double t = frame / 60.0, heading = 0.4 * std::sin(0.9 * t) + 0.2 * t;
    const int place = frame / 500;
    ViewState v;
    v.ground_m = 120.0;
    v.eye_m = {300.0 * t + 4.0e6 * place, 60.0 * t - 9.0e6 * place,
               v.ground_m + 60.0 + 900.0 * (1.0 - std::cos(0.2 * t))};
    v.velocity_m_per_s = {300.0, 60.0, 180.0 * std::sin(0.2 * t)};
    v.forward = {std::cos(heading), std::sin(heading), -0.12};
    return v;
}

} // namespace

StreamBenchResult run_stream_bench(const StreamBenchOptions& options) {
    using Clock = std::chrono::steady_clock;
    std::vector<std::function<void()>> jobs;
    StreamExternals externals;
    externals.load = [](TileKey key,
                        const std::shared_ptr<const TileContext>&) -> Result<std::unique_ptr<TilePayload>> {
        return std::unique_ptr<TilePayload>(std::make_unique<BenchPayload>(key));
    };
    externals.publish = [](NodeHandle, TileKey, TilePayload&) {};
    externals.submit = [&](std::function<void()> job) { jobs.push_back(std::move(job)); };
    externals.max_payload_bytes = sizeof(BenchPayload);
    StreamSettings settings;
    settings.slots = options.known_nodes;
    settings.lod_factor = options.lod_factor;
    TileStreamer streamer(settings, externals);
    streamer.record_requests(true);
    const auto run_jobs = [&] {
        for (auto& job : jobs) job();
        jobs.clear();
    };

    // Fills the pool: the budgets allow four tiles a frame.
    int frame = 0;
    for (int i = 0; streamer.stats().nodes_in_state[0] > 0 || i == 0; ++i) {
        SAHEL_CHECK_LT(i, 200 * options.known_nodes);
        streamer.update(bench_view(frame += 7), 0.1);
        run_jobs();
    }
    StreamBenchResult result;
    result.known_nodes = options.known_nodes;
    const size_t loads_before = streamer.requests().size();
    std::vector<double> ms, wall_ms;
    ms.reserve(static_cast<size_t>(options.frames));
    wall_ms.reserve(static_cast<size_t>(options.frames));
    double wanted = 0.0;
    for (int i = 0; i < options.frames; ++i) {
        const ViewState view = bench_view(++frame);
        const auto begin = Clock::now();
        const double begin_ms = thread_ms();
        streamer.update(view, 1.0 / 60.0);
        ms.push_back(thread_ms() - begin_ms);
        wall_ms.push_back(std::chrono::duration<double, std::milli>(Clock::now() - begin).count());
        run_jobs();
        result.known_nodes = std::min(result.known_nodes, options.known_nodes - streamer.stats().nodes_in_state[0]);
        wanted += streamer.stats().wanted;
    }
    std::sort(ms.begin(), ms.end());
    std::sort(wall_ms.begin(), wall_ms.end());
    const auto place = [&](double share) {
        return static_cast<size_t>(share * static_cast<double>(ms.size() - 1) + 0.5);
    };
    result.frames = options.frames;
    result.wanted_nodes = static_cast<int>(wanted / options.frames);
    result.loads = static_cast<int64_t>(streamer.requests().size() - loads_before);
    result.p50_ms = ms[place(0.5)];
    result.p95_ms = ms[place(0.95)];
    result.p99_ms = ms[place(0.99)];
    result.wall_p99_ms = wall_ms[place(0.99)];
    result.max_ms = ms.back();
    for (const TileKey& key : streamer.requests())
        result.hash = (result.hash ^ std::hash<TileKey>{}(key)) * 0x9E3779B97F4A7C15ull;
    return result;
}

} // namespace sahel
