#include "world/executor.h"

#include "world/check.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <string_view>
#include <thread>

// Debian's oneTBB is not instrumented: under the thread sanitizer plain threads do its work, so that what is reported
// is about kernels and not about the library.
#if defined(__SANITIZE_THREAD__)
#define SAHEL_PLAIN_THREADS 1
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define SAHEL_PLAIN_THREADS 1
#endif
#endif
#if !defined(SAHEL_PLAIN_THREADS)
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#endif

namespace sahel {

namespace {

int cores() {
#if defined(SAHEL_PLAIN_THREADS)
    return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
#else
    return std::max(1, oneapi::tbb::info::default_concurrency()); // respects the affinity mask
#endif
}

class Threads {
  public:
    static Threads& get() {
        static Threads threads;
        return threads;
    }
    void set(int asked) {
        SAHEL_CHECK_LE(0, asked);
        const int count = asked == 0 ? cores() : asked;
#if !defined(SAHEL_PLAIN_THREADS)
        // More threads than cores are a request like any other (tests do it): the library would quietly start fewer.
        more_ = count <= cores()
                    ? nullptr
                    : std::make_unique<oneapi::tbb::global_control>(
                          oneapi::tbb::global_control::max_allowed_parallelism, static_cast<size_t>(count));
        arena_ = count == 1 ? nullptr : std::make_unique<oneapi::tbb::task_arena>(count);
#endif
        count_.store(count);
    }
    [[nodiscard]] int count() const {
        return count_.load(std::memory_order_relaxed);
    }

    void run(int64_t blocks, void (*run_block)(const void*, int64_t), const void* context) {
        if (count() == 1 || blocks == 1) {
            for (int64_t i = 0; i < blocks; ++i) run_block(context, i);
            return;
        }
#if defined(SAHEL_PLAIN_THREADS)
        std::atomic<int64_t> next{0};
        const auto work = [&] {
            for (int64_t i = next++; i < blocks; i = next++) run_block(context, i);
        };
        std::vector<std::thread> helpers;
        const auto wanted = static_cast<size_t>(std::min<int64_t>(count(), blocks) - 1);
        for (size_t t = 0; t < wanted; ++t) helpers.emplace_back(work);
        work();
        for (std::thread& helper : helpers) helper.join();
#else
        arena_->execute(
            [&] { oneapi::tbb::parallel_for(int64_t{0}, blocks, [&](int64_t i) { run_block(context, i); }); });
#endif
    }

  private:
    Threads() {
        set(0);
    }
    std::atomic<int> count_{1};
#if !defined(SAHEL_PLAIN_THREADS)
    std::unique_ptr<oneapi::tbb::global_control> more_;
    std::unique_ptr<oneapi::tbb::task_arena> arena_;
#endif
};

struct Records {
    std::atomic<bool> on{false};
    std::mutex mutex;
    std::map<std::string, LaunchRecord, std::less<>> by_name;
    static Records& get() {
        static Records records;
        return records;
    }
};

} // namespace

void set_thread_count(int threads) {
    Threads::get().set(threads);
}

int thread_count() {
    return Threads::get().count();
}

void record_launches(bool on) {
    Records::get().on.store(on);
}

void clear_launch_records() {
    const std::lock_guard lock(Records::get().mutex);
    Records::get().by_name.clear();
}

std::vector<LaunchRecord> launch_records() {
    std::vector<LaunchRecord> rows;
    {
        const std::lock_guard lock(Records::get().mutex);
        for (const auto& [name, record] : Records::get().by_name) rows.push_back(record);
    }
    std::stable_sort(rows.begin(), rows.end(), [](const auto& a, const auto& b) { return a.ms > b.ms; });
    return rows;
}

std::string launch_table(const std::vector<LaunchRecord>& records) {
    LaunchRecord total{.name = "total"};
    size_t width = total.name.size();
    for (const LaunchRecord& r : records) {
        total.launches += r.launches;
        total.cells += r.cells;
        total.ms += r.ms;
        width = std::max(width, r.name.size());
    }
    std::string out = fmt::format("{:<{}} {:>9} {:>14} {:>11} {:>10} {:>7}\n", "name", width, "launches", "cells", "ms",
                                  "Mcells/s", "share");
    const auto row = [&](const LaunchRecord& r) {
        out += fmt::format("{:<{}} {:>9} {:>14} {:>11.3f} {:>10.1f} {:>6.1f}%\n", r.name, width, r.launches, r.cells,
                           r.ms, r.ms > 0.0 ? static_cast<double>(r.cells) / r.ms * 1e-3 : 0.0,
                           total.ms > 0.0 ? 100.0 * r.ms / total.ms : 0.0);
    };
    for (const LaunchRecord& r : records) row(r);
    row(total);
    return out;
}

namespace detail {

bool launches_recorded() {
    return Records::get().on.load(std::memory_order_relaxed);
}

void add_launch(const char* name, int64_t cells, double ms) {
    Records& records = Records::get();
    const std::lock_guard lock(records.mutex);
    auto found = records.by_name.find(std::string_view(name));
    if (found == records.by_name.end()) found = records.by_name.emplace(name, LaunchRecord{.name = name}).first;
    found->second.launches += 1;
    found->second.cells += cells;
    found->second.ms += ms;
}

void run_blocks(const char* name, int64_t cells, int64_t count, void (*run)(const void*, int64_t),
                const void* context) {
    if (!launches_recorded()) {
        Threads::get().run(count, run, context);
        return;
    }
    const auto start = std::chrono::steady_clock::now();
    Threads::get().run(count, run, context);
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
    add_launch(name, cells, took.count());
}

} // namespace detail
} // namespace sahel
