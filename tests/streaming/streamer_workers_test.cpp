#include "paths.h"
#include "streaming/worker_pool.h"

#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <thread>

// Real threads: what is loaded, in which order, must not depend on how many there are or how fast. Sleeps only stir the
// schedule; no result depends on their length.
namespace sahel::test {
namespace {

/// Workers whose jobs can be waited for.
class CountedWorkers {
  public:
    explicit CountedWorkers(int threads) : pool_(threads) {}
    void submit(std::function<void()> job) {
        {
            const std::lock_guard lock(mutex_);
            ++open_;
        }
        pool_.submit([this, run = std::move(job)]() mutable {
            run();
            run = nullptr;
            const std::lock_guard lock(mutex_);
            if (--open_ == 0) done_.notify_all();
        });
    }
    void wait() {
        std::unique_lock lock(mutex_);
        done_.wait(lock, [this] { return open_ == 0; });
    }

  private:
    std::mutex mutex_;
    std::condition_variable done_;
    int open_ = 0;
    WorkerPool pool_; // last: its threads use the rest
};

FakeWorld::Options threaded_options(CountedWorkers& workers, uint64_t salt, int failures_per_mille = 0) {
    FakeWorld::Options options = path_options(0, failures_per_mille);
    options.submit = [&workers](std::function<void()> job) { workers.submit(std::move(job)); };
    options.on_load = [salt](TileKey key) {
        std::this_thread::sleep_for(std::chrono::microseconds(hash_key(key, salt) % 200));
    };
    return options;
}

TEST(StreamerWorkers, SettledPathsStartTheSameLoadsForAnyNumberOfWorkers) {
    std::vector<TileKey> requests;
    std::vector<uint64_t> pictures;
    for (const auto& [threads, salt] : {std::pair{1, 1}, {1, 2}, {4, 1}, {4, 3}, {9, 4}}) {
        CountedWorkers workers(threads);
        FakeWorld world(threaded_options(workers, static_cast<uint64_t>(salt), 20));
        std::vector<uint64_t> seen;
        for (int i = 0; i < 40; ++i) {
            ViewState view = i % 13 == 12 ? teleport(i * 50) : straight(i * 12);
            view.velocity_m_per_s = {300.0, 0.0, 0.0};
            EXPECT_TRUE(world.settle(view));
            seen.push_back(hash_visible(world.streamer().frame().visible));
        }
        workers.wait();
        EXPECT_GT(world.streamer().requests().size(), 200u);
        if (requests.empty()) {
            requests = world.streamer().requests();
            pictures = seen;
        }
        EXPECT_EQ(first_difference(world.streamer().requests(), requests), -1) << threads << " workers";
        EXPECT_EQ(first_difference(seen, pictures), -1) << threads << " workers";
    }
}

TEST(StreamerWorkers, FramesStartTheSameLoadsForAnyNumberOfWorkers) {
    for (const auto path : {straight, climb, teleport}) {
        std::vector<TileKey> requests;
        for (const int threads : {1, 4}) {
            CountedWorkers workers(threads);
            FakeWorld world(threaded_options(workers, static_cast<uint64_t>(threads)));
            for (int i = 0; i < 160; ++i) {
                world.frame(path(i * 3));
                workers.wait(); // the fake clock's frame: all loads end within it
            }
            if (requests.empty()) requests = world.streamer().requests();
            EXPECT_GT(requests.size(), 100u);
            EXPECT_EQ(first_difference(world.streamer().requests(), requests), -1);
        }
    }
}

// No waiting at all: loads end when they end. Every frame is audited.
TEST(StreamerWorkers, RandomMovesWithoutWaiting) {
    CountedWorkers workers(4);
    {
        FakeWorld world(threaded_options(workers, 5, 30));
        RandomFlight path(8);
        for (int i = 0; i < 2500; ++i) {
            world.frame(path(i));
            if (i % 400 == 399) world.streamer().invalidate_all();
            if (has_failed_at(i)) break;
        }
    } // the streamer goes while loads are running
    workers.wait();
}

TEST(StreamerWorkers, PoolRunsJobsInOrderAndStops) {
    std::vector<int> order;
    {
        WorkerPool one(1);
        EXPECT_EQ(one.threads(), 1);
        std::mutex mutex;
        std::condition_variable changed;
        bool done = false;
        for (int i = 0; i < 100; ++i)
            one.submit([&, i] {
                const std::lock_guard lock(mutex);
                order.push_back(i);
                if (i == 99) {
                    done = true;
                    changed.notify_all();
                }
            });
        std::unique_lock lock(mutex);
        changed.wait(lock, [&] { return done; });
    }
    ASSERT_EQ(order.size(), 100u);
    for (int i = 0; i < 100; ++i) EXPECT_EQ(order[static_cast<size_t>(i)], i);
}

} // namespace
} // namespace sahel::test
