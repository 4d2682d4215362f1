#include "fake_world.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <unordered_set>

namespace sahel::test {

uint64_t hash_key(TileKey key, uint64_t salt) {
    uint64_t h = std::hash<TileKey>{}(key) + salt * 0x9E3779B97F4A7C15ull;
    h = (h ^ (h >> 30)) * 0xBF58476D1CE4E5B9ull;
    h = (h ^ (h >> 27)) * 0x94D049BB133111EBull;
    return h ^ (h >> 31);
}

Heights fake_heights(TileKey key, int root_level) {
    Heights h{-50.0f, 1500.0f};
    for (int level = root_level; level >= key.level; --level) {
        const uint64_t bits = hash_key(key.ancestor(level), 77);
        const float a = static_cast<float>(bits & 0xFFFF) / 65535.0f, b = static_cast<float>(bits >> 48) / 65535.0f;
        const float span = h.high - h.low;
        h = {h.low + 0.35f * a * span, h.high - 0.35f * b * span};
        // Half of what the selection allows a child to stick out by.
        const float more = 0.5f + 0.005f * std::ldexp(512.0f, level + 1);
        if ((bits & 0x70000) == 0) h.high += more;
        if ((bits & 0x380000) == 0) h.low -= more;
    }
    return h;
}

FakeContext::FakeContext(std::shared_ptr<Alive> alive, TileKey k, std::shared_ptr<const TileContext> above)
    : key(k), parent(std::move(above)), alive_(std::move(alive)) {
    ++alive_->contexts;
    alive_->context_bytes += static_cast<int64_t>(k_context_bytes);
}
FakeContext::~FakeContext() {
    --alive_->contexts;
    alive_->context_bytes -= static_cast<int64_t>(k_context_bytes);
}

FakePayload::FakePayload(std::shared_ptr<Alive> alive, TileKey k, int root_level, uint64_t data_version,
                         const std::shared_ptr<const TileContext>& parent)
    : key(k), version(data_version), alive_(std::move(alive)), heights_(fake_heights(k, root_level)),
      bytes_(k_payload_bytes - hash_key(k, 5) % (k_payload_bytes / 2)),
      context_(std::make_shared<FakeContext>(alive_, k, parent)) {
    ++alive_->payloads;
    alive_->payload_bytes += static_cast<int64_t>(bytes_);
}
FakePayload::~FakePayload() {
    --alive_->payloads;
    alive_->payload_bytes -= static_cast<int64_t>(bytes_);
}

FakeWorld::FakeWorld(const Options& options) : options_(options) {
    slot_key_.resize(static_cast<size_t>(options.settings.slots), TileKey{-1, 0, 0});
    StreamExternals e;
    e.load = [this](TileKey key, const std::shared_ptr<const TileContext>& parent) { return load(key, parent); };
    e.publish = [this](NodeHandle h, TileKey k, TilePayload& p) { publish(h, k, p); };
    e.evicted = [this](NodeHandle h, TileKey k) { evicted(h, k); };
    e.commit = [this](NodeHandle, TileKey k) { return on_commit && on_commit(k); };
    if (options.submit)
        e.submit = options.submit;
    else
        e.submit = [this](std::function<void()> job) {
            if (options_.run_at_once) {
                job();
                return;
            }
            const auto n = next_job_++;
            const int64_t wait = options_.latency_frames > 0
                                     ? static_cast<int64_t>(hash_key({0, static_cast<int64_t>(n), 0}, options_.salt) %
                                                            static_cast<uint64_t>(options_.latency_frames + 1))
                                     : 0;
            jobs_.push_back({frame_ + 1 + wait, n, std::move(job)});
        };
    e.now_s = options.now_s;
    e.max_payload_bytes = k_payload_bytes;
    e.max_context_bytes = k_context_bytes;
    e.slot_bytes = 1000;
    streamer_ = std::make_unique<TileStreamer>(options.settings, std::move(e));
    streamer_->record_requests(true);
}

FakeWorld::~FakeWorld() {
    streamer_.reset();
    jobs_.clear();
    EXPECT_EQ(alive_->payloads.load(), 0);
    if (!options_.submit) {
        EXPECT_EQ(alive_->contexts.load(), 0);
    } // real workers may still hold a job that will not run
}

void FakeWorld::break_key(TileKey key, ErrorKind kind) {
    const std::lock_guard lock(mutex_);
    broken_[key] = kind;
}
void FakeWorld::mend_all() {
    const std::lock_guard lock(mutex_);
    broken_.clear();
}

bool FakeWorld::is_failing(TileKey key) {
    const std::lock_guard lock(mutex_);
    return failing_.contains(key);
}

FrameResult FakeWorld::frame(const ViewState& view, double dt_s) {
    ++frame_;
    std::vector<Job> due;
    std::erase_if(jobs_, [&](Job& j) {
        if (j.due_frame > frame_) return false;
        due.push_back(std::move(j));
        return true;
    });
    if (options_.last_first) std::reverse(due.begin(), due.end());
    for (Job& j : due) j.run();
    due.clear();
    frame_publishes_ = 0;
    frame_bytes_ = 0;
    const FrameResult result = streamer_->update(view, dt_s);
    EXPECT_LE(frame_publishes_, options_.settings.publishes_per_frame);
    EXPECT_LE(frame_bytes_, static_cast<uint64_t>(options_.settings.publish_mib_per_frame) << 20);
    EXPECT_EQ(frame_bytes_, result.stats.published_bytes);
    audit(*this, view, result);
    has_shown_ = has_shown_ || result.stats.missing_roots == 0;
    return result;
}

bool FakeWorld::settle(const ViewState& view) {
    const bool settled = streamer_->settle(view);
    const FrameResult result = streamer_->frame();
    audit(*this, view, result);
    has_shown_ = has_shown_ || result.stats.missing_roots == 0;
    return settled;
}

Result<std::unique_ptr<TilePayload>> FakeWorld::load(TileKey key, const std::shared_ptr<const TileContext>& parent) {
    ++loads_;
    if (options_.on_load) options_.on_load(key);
    int attempt = 0;
    {
        const std::lock_guard lock(mutex_);
        attempt = attempts_[key]++;
        if (const auto it = broken_.find(key); it != broken_.end()) {
            failing_.insert(key);
            return Error{it->second, "broken on purpose"};
        }
    }
    const bool root = key.level == options_.settings.root_level;
    EXPECT_EQ(parent == nullptr, root);
    if (parent) {
        EXPECT_EQ(static_cast<const FakeContext&>(*parent).key, key.parent());
    }
    const auto dice = static_cast<int>(hash_key(key, 1000 + static_cast<uint64_t>(attempt)) % 1000);
    const std::lock_guard lock(mutex_);
    if (dice < options_.failures_per_mille) {
        failing_.insert(key);
        return Error{ErrorKind::io, "failed on purpose"};
    }
    failing_.erase(key);
    return std::unique_ptr<TilePayload>(
        std::make_unique<FakePayload>(alive_, key, options_.settings.root_level, version_.load(), parent));
}

void FakeWorld::publish(NodeHandle handle, TileKey key, TilePayload& payload) {
    if (on_publish) on_publish(key);
    ++frame_publishes_;
    frame_bytes_ += payload.bytes();
    auto& fake = static_cast<FakePayload&>(payload);
    EXPECT_EQ(fake.key, key);
    EXPECT_TRUE(handle);
    ASSERT_LT(handle.slot, slot_key_.size());
    if (key.level != options_.settings.root_level) {
        EXPECT_TRUE(published_.contains(key.parent()));
    }
    const auto it = published_.find(key);
    if (it != published_.end()) { // again, into the same place
        EXPECT_EQ(it->second.handle, handle);
    } else {
        EXPECT_EQ(slot_key_[handle.slot].level, -1) << "the slot is somebody else's";
    }
    slot_key_[handle.slot] = key;
    published_[key] = {handle, fake.version};
}

void FakeWorld::evicted(NodeHandle handle, TileKey key) {
    const auto it = published_.find(key);
    ASSERT_NE(it, published_.end());
    EXPECT_EQ(it->second.handle, handle);
    for (int c = 0; c < 4; ++c)
        if (key.level > 0) {
            EXPECT_FALSE(published_.contains(key.child(c))) << "an ancestor went before its descendant";
        }
    slot_key_[handle.slot] = {-1, 0, 0};
    published_.erase(it);
    evictions_.push_back(key);
}

namespace {

/// Looks at single points through the view: written without planes, so as not to repeat what it checks.
struct Looker {
    explicit Looker(const ViewState& v) : view(v) {
        const auto& f = v.forward;
        right = {f[1] * v.up[2] - f[2] * v.up[1], f[2] * v.up[0] - f[0] * v.up[2], f[0] * v.up[1] - f[1] * v.up[0]};
        const double n = std::sqrt(right[0] * right[0] + right[1] * right[1] + right[2] * right[2]);
        for (double& c : right) c /= n;
        above = {right[1] * f[2] - right[2] * f[1], right[2] * f[0] - right[0] * f[2],
                 right[0] * f[1] - right[1] * f[0]};
        tan_v = std::tan(0.5 * v.vertical_fov_rad);
        tan_h = tan_v * v.aspect;
    }
    [[nodiscard]] bool sees(double x, double y, double z) const {
        const double dx = x - view.eye_m[0], dy = y - view.eye_m[1];
        const double dz = z - view.eye_m[2] - (dx * dx + dy * dy) / (2.0 * 6371000.0);
        const double d = dx * view.forward[0] + dy * view.forward[1] + dz * view.forward[2];
        const double a = dx * right[0] + dy * right[1] + dz * right[2];
        const double b = dx * above[0] + dy * above[1] + dz * above[2];
        return d > 0.0 && std::abs(a) <= d * tan_h && std::abs(b) <= d * tan_v;
    }
    const ViewState& view;
    std::array<double, 3> right, above;
    double tan_v, tan_h;
};

struct Coverage {
    const FakeWorld& world;
    const ViewState& view;
    Looker looker;
    std::unordered_set<TileKey> drawn;  ///< quadrants, named like children (level -1 below level 0)
    std::unordered_set<TileKey> around; ///< their ancestors
    uint64_t dice = 1;

    void expect_out_of_sight(TileKey key) {
        const auto side = std::ldexp(static_cast<double>(world.settings().view_cells), key.level);
        const int root = world.settings().root_level;
        for (int i = 0; i < 14; ++i) {
            dice = hash_key({i, static_cast<int64_t>(dice), 0}, 3);
            double u = (i & 1) ? 0.999 : 0.001, v = (i & 2) ? 0.999 : 0.001; // corners, then anywhere
            if (i >= 4) {
                u = static_cast<double>(dice & 0xFFFFFF) / 0x1000000;
                v = static_cast<double>(dice >> 40) / 0x1000000;
            }
            const double x = (static_cast<double>(key.x) + u) * side, y = (static_cast<double>(key.y) + v) * side;
            const double cell = world.settings().view_cells;
            const TileKey ground{0, static_cast<int64_t>(std::floor(x / cell)),
                                 static_cast<int64_t>(std::floor(y / cell))};
            const Heights h = fake_heights(ground, root);
            const double z = static_cast<double>((i & 1) ? h.high : h.low);
            ASSERT_FALSE(looker.sees(x, y, z)) << "hole: quadrant " << key.level << ": " << key.x << ", " << key.y;
        }
    }
    void walk(TileKey key) {
        if (drawn.contains(key)) return;
        if (!around.contains(key)) {
            expect_out_of_sight(key);
            return;
        }
        for (int c = 0; c < 4; ++c) walk(key.child(c));
    }
};

} // namespace

void audit(FakeWorld& world, const ViewState& asked, const FrameResult& frame) {
    const ViewState& view = frame.view;
    const StreamSettings& settings = world.settings();
    const StreamStats& stats = frame.stats;
    TileStreamer& streamer = world.streamer();

    // Slots: none lost, none used twice.
    int slots = 0;
    for (const int n : stats.nodes_in_state) slots += n;
    EXPECT_EQ(slots, settings.slots);
    EXPECT_EQ(stats.nodes_in_state[static_cast<size_t>(NodeState::resident)],
              static_cast<int>(world.published().size()));
    EXPECT_EQ(stats.slot_bytes, 1000 * world.published().size());

    // Bytes: what is alive is what is accounted for, and within the budgets.
    EXPECT_LE(stats.in_flight_bytes, static_cast<uint64_t>(settings.in_flight_mib) << 20);
    EXPECT_LE(stats.context_bytes, static_cast<uint64_t>(settings.context_mib) << 20);
    EXPECT_LE(world.alive().payload_bytes.load(), static_cast<int64_t>(stats.in_flight_bytes));
    EXPECT_GE(world.alive().payload_bytes.load(), static_cast<int64_t>(stats.payload_bytes));
    if (!world.is_threaded()) {
        EXPECT_EQ(world.alive().context_bytes.load(),
                  static_cast<int64_t>(stats.context_bytes) +
                      world.alive().payloads.load() * static_cast<int64_t>(k_context_bytes));
    }
    EXPECT_LE(stats.loads_in_flight, settings.max_loads_in_flight);

    Coverage cover{world, view, Looker(view), {}, {}, static_cast<uint64_t>(stats.frame)};
    double distance = -1.0;
    for (const VisibleTile& t : frame.visible) {
        ASSERT_TRUE(streamer.is_current(t.node));
        const auto it = world.published().find(t.key);
        ASSERT_NE(it, world.published().end());
        ASSERT_EQ(it->second.handle, t.node);
        ASSERT_EQ(static_cast<bool>(t.parent), t.key.level != settings.root_level);
        if (t.parent) {
            ASSERT_EQ(world.published().at(t.key.parent()).handle, t.parent);
        }
        ASSERT_NE(t.quadrant_mask, 0);
        ASSERT_EQ(t.fallback_mask & ~t.quadrant_mask, 0);
        ASSERT_GE(t.fade, 0.0f);
        ASSERT_LE(t.fade, 1.0f);
        const double side = std::ldexp(static_cast<double>(settings.view_cells), t.key.level);
        const double x = static_cast<double>(t.key.x) * side - view.eye_m[0],
                     y = static_cast<double>(t.key.y) * side - view.eye_m[1];
        const double d = std::hypot(std::max({x, -(x + side), 0.0}), std::max({y, -(y + side), 0.0}));
        ASSERT_GE(d, distance - 1e-6 * distance) << "not front to back";
        distance = d;
        for (int q = 0; q < 4; ++q) {
            if (!((t.quadrant_mask >> q) & 1)) continue;
            ASSERT_TRUE(cover.drawn.insert(t.key.child(q)).second) << "drawn twice";
        }
    }
    for (const TileKey& q : cover.drawn)
        for (TileKey k = q.parent(); k.level <= settings.root_level; k = k.parent()) {
            ASSERT_FALSE(cover.drawn.contains(k)) << "overlap";
            cover.around.insert(k);
        }
    if (stats.held) {
        EXPECT_TRUE(world.has_shown());
        EXPECT_GT(stats.missing_roots, 0);
    } else {
        EXPECT_EQ(view.eye_m, asked.eye_m);
        EXPECT_EQ(view.forward, asked.forward);
    }
    const double root_side = std::ldexp(static_cast<double>(settings.view_cells), settings.root_level);
    const auto ex = static_cast<int64_t>(std::floor(view.eye_m[0] / root_side)),
               ey = static_cast<int64_t>(std::floor(view.eye_m[1] / root_side));
    size_t roots_with_drawn = 0;
    for (int64_t dy = -settings.root_radius; dy <= settings.root_radius; ++dy)
        for (int64_t dx = -settings.root_radius; dx <= settings.root_radius; ++dx) {
            const TileKey root{settings.root_level, ex + dx, ey + dy};
            roots_with_drawn += cover.around.contains(root) ? 1 : 0;
            if (world.published().contains(root))
                cover.walk(root);
            else
                EXPECT_TRUE(!world.has_shown() || (!stats.held && world.is_failing(root))) << "a root is missing";
        }
    const auto drawn_roots = static_cast<size_t>(std::count_if(
        cover.around.begin(), cover.around.end(), [&](const TileKey& k) { return k.level == settings.root_level; }));
    EXPECT_EQ(roots_with_drawn, drawn_roots) << "drawn outside the roots";
}

int greatest_level_step(std::span<const VisibleTile> visible) {
    std::unordered_set<TileKey> drawn;
    for (const VisibleTile& t : visible)
        for (int q = 0; q < 4; ++q)
            if ((t.quadrant_mask >> q) & 1) drawn.insert(t.key.child(q));
    int step = 0;
    for (const TileKey& k : drawn)
        for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
            for (TileKey n{k.level, k.x + dx, k.y + dy}; n.level < k.level + 12; n = n.parent())
                if (drawn.contains(n)) step = std::max(step, n.level - k.level);
    return step;
}

uint64_t hash_visible(std::span<const VisibleTile> visible) {
    uint64_t h = 17;
    for (const VisibleTile& t : visible) {
        const auto fade = static_cast<uint64_t>(std::lround(static_cast<double>(t.fade) * 1e6));
        h = hash_key(t.key, h) ^ (static_cast<uint64_t>(t.quadrant_mask) << 8) ^ t.fallback_mask ^ (fade << 20);
    }
    return h;
}

ViewState view_at(double x, double y, double height_m, double heading_rad, double pitch_rad) {
    ViewState v;
    v.ground_m = 400.0;
    v.eye_m = {x, y, v.ground_m + height_m};
    v.forward = {std::cos(heading_rad) * std::cos(pitch_rad), std::sin(heading_rad) * std::cos(pitch_rad),
                 std::sin(pitch_rad)};
    return v;
}

} // namespace sahel::test
