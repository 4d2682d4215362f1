#pragma once

#include "fake_world.h"

#include <map>
#include <random>
#include <vector>

/// Camera paths that the tests fly, and what they showed.
namespace sahel::test {

StreamSettings path_settings();
FakeWorld::Options path_options(int latency_frames, int failures_per_mille);

ViewState straight(int frame); ///< 300 m/s
ViewState spin(int frame);     ///< on the spot, at a corner of four roots
ViewState climb(int frame);    ///< 600 m/s up, 20 km at frame 2000
ViewState teleport(int frame); ///< thousands of kilometres away every 150 frames

/// Speeds, turns, climbs, looks and jumps by dice.
class RandomFlight {
  public:
    explicit RandomFlight(uint64_t seed) : dice_(seed) {}
    ViewState operator()(int frame);
    int teleports = 0;

  private:
    double uniform(double a, double b);
    std::mt19937_64 dice_;
    double x_ = 0, y_ = 0, height_ = 100, heading_ = 0, pitch_ = -0.1, vx_ = 0, vy_ = 0, turn_ = 0, lift_ = 0;
};

/// For comparing two runs and for a run's own limits.
struct Seen {
    std::vector<TileKey> requests;
    std::vector<uint64_t> pictures;
    int64_t oldest_visible = 0; ///< frames
    int first_full = -1;        ///< frame that had all its ground
    int held_frames = 0, longest_hold = 0;
    int64_t fallbacks = 0; ///< quadrants drawn coarser than they should be, summed over the frames
    int64_t published = 0, evicted = 0, failed = 0;

    void add(int frame_number, const FrameResult& frame);
    void finish(FakeWorld& world);

  private:
    int hold_ = 0;
};

/// Watches that nodes change their state along the drawn arrows only.
class StateWatch {
  public:
    void look(const TileStreamer& streamer);

  private:
    std::map<TileKey, NodeState> before_;
    bool is_first_ = true;
    std::vector<NodeInfo> nodes_;
};

bool has_failed_at(int frame);

/// Flies; every frame is audited (FakeWorld::frame).
template <class Path> Seen fly(FakeWorld& world, int frames, Path&& path) {
    Seen seen;
    StateWatch watch;
    for (int i = 0; i < frames; ++i) {
        const FrameResult frame = world.frame(path(i));
        watch.look(world.streamer());
        seen.add(i, frame);
        if (has_failed_at(i)) break;
    }
    seen.finish(world);
    return seen;
}

/// -1 when they are the same, else where they differ first.
int64_t first_difference(const std::vector<TileKey>& a, const std::vector<TileKey>& b);
int64_t first_difference(const std::vector<uint64_t>& a, const std::vector<uint64_t>& b);

/// After the last frame nothing may be under way, alive or lost.
void expect_nothing_leaked(FakeWorld& world);

} // namespace sahel::test
