#pragma once

#include "streaming/streamer.h"

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <vector>

/// A world of numbers for the streamer: payloads without pictures, workers that run when told to, a clock that stands
/// still unless it is turned. Everything is a pure function of the key, so that two runs can be compared.
namespace sahel::test {

inline constexpr uint64_t k_payload_bytes = 6u << 20;
inline constexpr uint64_t k_context_bytes = 70000;

uint64_t hash_key(TileKey key, uint64_t salt);

struct Heights {
    float low, high;
};
/// Ranges nest from the root level down, but for a little more that only finer tiles show.
Heights fake_heights(TileKey key, int root_level);

/// What is alive, counted by constructors and destructors.
struct Alive {
    std::atomic<int64_t> payloads{0}, payload_bytes{0}, contexts{0}, context_bytes{0};
};

class FakeContext final : public TileContext {
  public:
    FakeContext(std::shared_ptr<Alive> alive, TileKey k, std::shared_ptr<const TileContext> above);
    ~FakeContext() override;
    [[nodiscard]] uint64_t bytes() const override { return k_context_bytes; }
    const TileKey key;
    const std::shared_ptr<const TileContext> parent;

  private:
    std::shared_ptr<Alive> alive_;
};

class FakePayload final : public TilePayload {
  public:
    FakePayload(std::shared_ptr<Alive> alive, TileKey k, int root_level, uint64_t data_version,
                const std::shared_ptr<const TileContext>& parent);
    ~FakePayload() override;
    [[nodiscard]] uint64_t bytes() const override { return bytes_; }
    [[nodiscard]] float min_height_m() const override { return heights_.low; }
    [[nodiscard]] float max_height_m() const override { return heights_.high; }
    [[nodiscard]] std::shared_ptr<const TileContext> context() const override { return context_; }
    const TileKey key;
    const uint64_t version;

  private:
    std::shared_ptr<Alive> alive_;
    Heights heights_;
    uint64_t bytes_;
    std::shared_ptr<const TileContext> context_;
};

/// Owns a streamer and plays the outside world to it; checks every call the streamer makes.
class FakeWorld {
  public:
    struct Options {
        StreamSettings settings;
        int latency_frames = 0;     ///< a job takes 0 .. this many frames, by key and attempt
        int failures_per_mille = 0; ///< of loads, by key and attempt
        bool run_at_once = false;   ///< jobs run inside submit, as if workers were infinitely fast
        bool last_first = false;    ///< jobs that are due run in the other order
        uint64_t salt = 1;
        std::function<void(TileKey)> on_load; ///< runs first in every load, on its thread; may throw
        std::function<double()> now_s;        ///< clock of the publish budget; empty: time costs nothing
        /// Replaces submit, for real workers; `failures_per_mille` and versions still apply.
        std::function<void(std::function<void()>)> submit;
    };
    explicit FakeWorld(const Options& options);
    ~FakeWorld();
    FakeWorld(const FakeWorld&) = delete;
    FakeWorld& operator=(const FakeWorld&) = delete;

    /// Runs the jobs that are due, then one frame, and audits it.
    FrameResult frame(const ViewState& view, double dt_s = 1.0 / 60.0);
    TileStreamer& streamer() { return *streamer_; }
    [[nodiscard]] const StreamSettings& settings() const { return options_.settings; }
    [[nodiscard]] Alive& alive() { return *alive_; }

    struct Published {
        NodeHandle handle;
        uint64_t version;
    };
    [[nodiscard]] const std::map<TileKey, Published>& published() const { return published_; }
    [[nodiscard]] size_t waiting_jobs() const { return jobs_.size(); }
    [[nodiscard]] int64_t loads() const { return loads_.load(); }
    [[nodiscard]] const std::vector<TileKey>& evictions() const { return evictions_; }
    /// Keys that fail whatever the attempt, with this kind.
    void break_key(TileKey key, ErrorKind kind);
    void mend_all();
    /// Its last load failed.
    [[nodiscard]] bool is_failing(TileKey key);
    [[nodiscard]] bool has_shown() const { return has_shown_; }
    /// Loads see this from now on.
    void set_version(uint64_t v) { version_ = v; }
    [[nodiscard]] bool is_threaded() const { return static_cast<bool>(options_.submit); }
    /// Waits until the streamer has settled on the view, and audits what is drawn.
    bool settle(const ViewState& view);
    std::function<bool(TileKey)> on_commit;
    std::function<void(TileKey)> on_publish;

  private:
    struct Job {
        int64_t due_frame;
        uint64_t number;
        std::function<void()> run;
    };
    Result<std::unique_ptr<TilePayload>> load(TileKey key, const std::shared_ptr<const TileContext>& parent);
    void publish(NodeHandle handle, TileKey key, TilePayload& payload);
    void evicted(NodeHandle handle, TileKey key);

    Options options_;
    std::shared_ptr<Alive> alive_ = std::make_shared<Alive>();
    std::mutex mutex_; ///< guards attempts_ and broken_: loads may run on real workers
    std::map<TileKey, int> attempts_;
    std::map<TileKey, ErrorKind> broken_;
    std::set<TileKey> failing_;
    bool has_shown_ = false; ///< a frame before this one had all its ground
    std::atomic<uint64_t> version_{1};
    std::atomic<int64_t> loads_{0};
    std::vector<Job> jobs_;
    uint64_t next_job_ = 0;
    int64_t frame_ = 0;
    int64_t frame_publishes_ = 0;
    uint64_t frame_bytes_ = 0;
    std::map<TileKey, Published> published_;
    std::vector<TileKey> slot_key_;
    std::vector<TileKey> evictions_;
    std::unique_ptr<TileStreamer> streamer_;
};

/// Holes, overlaps, handles, budgets of one frame; adds gtest failures. FakeWorld::frame calls it. Coverage is checked
/// in integers on the quadrants inside the roots, what is not drawn by an independent look through the frustum.
void audit(FakeWorld& world, const ViewState& asked, const FrameResult& frame);

/// Greatest difference of levels between neighbours that are drawn.
int greatest_level_step(std::span<const VisibleTile> visible);

/// Everything that decides the picture.
uint64_t hash_visible(std::span<const VisibleTile> visible);

/// A view from (x, y) at height above the fake ground, looking along heading and pitch.
ViewState view_at(double x, double y, double height_m, double heading_rad, double pitch_rad = -0.15);

} // namespace sahel::test
