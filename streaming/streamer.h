#pragma once

#include "world/memory.h"
#include "world/params.h"
#include "world/result.h"
#include "world/tile_key.h"

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <tuple>
#include <vector>

/// Which tiles are shown, which are wanted next and what stays in memory. Knows no GL: tests drive it on a fake clock.
namespace sahel {

/// A place in the node pool; a stale handle is detected by its generation.
struct NodeHandle {
    uint32_t slot = 0;
    uint32_t generation = 0; ///< 0 is null
    friend bool operator==(const NodeHandle&, const NodeHandle&) = default;
    explicit operator bool() const { return generation != 0; }
};

/// What a resident tile leaves on the host for the loads of its children (a coarse height grid to cast shadows from).
class TileContext {
  public:
    virtual ~TileContext() = default;
    [[nodiscard]] virtual uint64_t bytes() const = 0;
};

/// What a loaded tile is to its user (the renderer's tile textures on their way to the GPU). Made on a worker.
class TilePayload {
  public:
    virtual ~TilePayload() = default;
    [[nodiscard]] virtual uint64_t bytes() const = 0; ///< host bytes held until published
    [[nodiscard]] virtual float min_height_m() const = 0;
    [[nodiscard]] virtual float max_height_m() const = 0;
    /// Kept by the streamer while the tile is resident and handed to the loads of its children; may be null.
    [[nodiscard]] virtual std::shared_ptr<const TileContext> context() const { return nullptr; }
};

/// Position and view, world metres: x east, y south, z up.
struct ViewState {
    std::array<double, 3> eye_m{};
    std::array<double, 3> velocity_m_per_s{};
    std::array<double, 3> forward{0.0, 1.0, 0.0};
    std::array<double, 3> up{0.0, 0.0, 1.0};
    double vertical_fov_rad = 0.9;
    double aspect = 16.0 / 9.0;
    int viewport_height_px = 720;
    double ground_m = 0.0; ///< height of the ground below the eye; the vertical part of LOD distances
};

/// One tile to draw. A quadrant whose child is drawn instead is masked out; what remains is drawn from this tile.
struct VisibleTile {
    TileKey key;
    NodeHandle node;
    NodeHandle parent;         ///< null at the root level
    uint8_t quadrant_mask = 0; ///< bit i: quadrant i (as TileKey::child) is drawn from this tile
    uint8_t fallback_mask = 0; ///< bit i: quadrant i wants its child, which is not here yet
    float fade = 1.0f;         ///< 0 when the tile has just appeared, 1 after fade_s
    float min_height_m = 0.0f;
    float max_height_m = 0.0f;
};

/// States of a node in the pool:
///
///       insert            parent resident, budgets          worker             publish budgets
///     absent --> queued -------------------------> loading --------> loaded -------------------> resident
///                  ^ ^                                |
///             time | | invalidated              error | error for good, or max_attempts of them
///                  | |                                +------------------------------------------> failed
///                  | +----------------------------------------------------------------------------- |
///                  +--------------------------- retry_later <-- error --- loading
///
///     back to absent (the slot is given back, handles to it go stale), when nobody wants it any more:
///       queued, retry_later, failed   at once
///       loading                       at once if no worker has begun it; else it goes on
///       loaded, resident              when its slot is needed; the least recently wanted first
///
/// A resident node whose data changed is loaded again beside its old contents, which stay drawn until the new ones are
/// published; its state does not change. Every other transition is our bug and aborts (NodePool::set_state).
enum class NodeState : uint8_t { absent, queued, loading, loaded, resident, retry_later, failed };
const char* name_of(NodeState state);

/// Why a node is wanted; every node of an earlier group goes first. The high queue of the paper is urgent and visible,
/// its normal queue around (in reach, but outside the frustum: what a turn of the head shows) and prefetch (what the
/// velocity will bring).
enum class WantGroup : uint8_t { urgent, visible, around, prefetch };

struct StreamSettings {
    int slots = 96;
    float lod_factor = 2.1f;
    int root_level = 8;
    int root_radius = 1;
    int view_cells = 512;
    int max_loads_in_flight = 4;
    int publishes_per_frame = 4;
    float publish_ms_per_frame = 4.0f;
    int publish_mib_per_frame = 64;
    int in_flight_mib = 128;
    int context_mib = 64;
    float prefetch_s = 3.0f;
    float keep_s = 1.0f;
    float fade_s = 0.4f;
    float retry_after_s = 2.0f;
    int max_attempts = 5;
};

// clang-format off
template <> inline constexpr auto fields_of<StreamSettings> = std::tuple{
    Field{&StreamSettings::slots,                "slots",                "",    8,    65536,   "Tiles that may be resident"},
    Field{&StreamSettings::lod_factor,           "lod_factor",           "",    1.5f, 6.0f,    "A square is refined nearer than this many of its sides"},
    Field{&StreamSettings::root_level,           "root_level",           "",    0,    20,      "Level of the coarsest tiles, always kept around the eye"},
    Field{&StreamSettings::root_radius,          "root_radius",          "",    0,    4,       "Root tiles in each direction around the eye's own"},
    Field{&StreamSettings::view_cells,           "view_cells",           "",    64,   4096,    "Cells along a tile's side"},
    Field{&StreamSettings::max_loads_in_flight,  "max_loads_in_flight",  "",    1,    64,      "Loads that run at once"},
    Field{&StreamSettings::publishes_per_frame,  "publishes_per_frame",  "",    1,    64,      "Tiles handed over at one frame boundary"},
    Field{&StreamSettings::publish_ms_per_frame, "publish_ms_per_frame", "ms",  0.1f, 1000.0f, "Time for handing over; the tile that crosses it is the last"},
    Field{&StreamSettings::publish_mib_per_frame,"publish_mib_per_frame","MiB", 1,    4096,    "Bytes handed over at one frame boundary"},
    Field{&StreamSettings::in_flight_mib,        "in_flight_mib",        "MiB", 1,    65536,   "Host memory of tiles that are loading or wait to be handed over"},
    Field{&StreamSettings::context_mib,          "context_mib",          "MiB", 1,    65536,   "Host memory of what loaded tiles keep for the loads of their children"},
    Field{&StreamSettings::prefetch_s,           "prefetch_s",           "s",   0.0f, 30.0f,   "Looks ahead along the velocity by this time"},
    Field{&StreamSettings::keep_s,               "keep_s",               "s",   0.0f, 600.0f,  "So long a tile that is not wanted keeps its slot from what is not visible"},
    Field{&StreamSettings::fade_s,               "fade_s",               "s",   0.0f, 5.0f,    "A new tile eases in from its parent's shape"},
    Field{&StreamSettings::retry_after_s,        "retry_after_s",        "s",   0.0f, 600.0f,  "A load that failed is tried again after this time, then twice it, ..."},
    Field{&StreamSettings::max_attempts,         "max_attempts",         "",    1,    100,     "and given up after this many attempts"},
};
// clang-format on
static_assert(covers_every_member<StreamSettings> && defaults_in_range<StreamSettings>);

/// The outside world. `load` runs on workers, everything else in the owner's thread. An exception thrown by `load`
/// counts as an error of kind io. Errors of kind usage and unsupported are final, others are tried again.
struct StreamExternals {
    std::function<Result<std::unique_ptr<TilePayload>>(TileKey, const std::shared_ptr<const TileContext>& parent)> load;
    std::function<void(NodeHandle, TileKey, TilePayload&)> publish;
    std::function<void(NodeHandle, TileKey)> evicted;  ///< may be empty
    std::function<void(std::function<void()>)> submit; ///< runs a job some time, on some thread
    std::function<double()> now_s;                     ///< for publish_ms_per_frame
    /// Writes a dirty tile back so that it may be evicted; false: not now. Empty: dirty tiles are never evicted.
    std::function<bool(NodeHandle, TileKey)> commit;
    uint64_t max_payload_bytes = 0; ///< no payload is larger
    uint64_t max_context_bytes = 0; ///< no context is larger; 0: counted, but not limited
    uint64_t slot_bytes = 0;        ///< what one slot takes where tiles are published to; for stats
    double cell_m = 1.0;            ///< of level 0
};

/// Whether these settings can be kept with these tiles: ranges, room for the roots, budgets that hold at least one
/// tile. Errors: usage, naming the setting.
Status check_stream(const StreamSettings& settings, const StreamExternals& externals);

/// Most bytes the streamer will hold: in slots (slot_bytes each), in loads and loaded payloads, in contexts.
struct StreamBytes {
    uint64_t slots = 0, in_flight = 0, contexts = 0;
    [[nodiscard]] uint64_t host() const { return in_flight + contexts; }
};
StreamBytes plan_stream_bytes(const StreamSettings& settings, const StreamExternals& externals);

/// lod_factor for which no cell of a refined tile is seen under more than `error_px` pixels (in range: 1.5 to 6).
/// A quadrant of side s = n/2 cells is drawn from its own tile where its distance is at least lod_factor s, so a cell c
/// is seen under at most c / (lod_factor n c / 2) radians: error_px = 2 / (lod_factor n pixel_rad).
float lod_factor_for(double error_px, int view_cells, double vertical_fov_rad, int viewport_height_px);
double error_px_of(float lod_factor, int view_cells, double vertical_fov_rad, int viewport_height_px);
/// The lowest root level whose tiles (root_radius in each direction) reach `view_distance_m` from anywhere.
int root_level_for(double view_distance_m, double cell_m, int view_cells, int root_radius);
/// How far the top of a mountain can be seen over a bare earth: where `eye_m` and `top_m` above the plain lose sight.
double horizon_m(double eye_m, double top_m);

struct StreamStats {
    int64_t frame = 0;
    std::array<int, 7> nodes_in_state{}; ///< by NodeState; absent counts free slots
    int wanted = 0;                      ///< nodes this view asks for
    int wanted_over_budget = 0;          ///< of them, how many the budgets cannot hold
    int unplaced = 0;                    ///< within the budgets, but their slots are not free yet
    int visible = 0;
    int fallbacks = 0;     ///< quadrants drawn from a tile although they want its child
    int missing_roots = 0; ///< roots that the view asked for needs and that are not here
    bool held = false;     ///< for them, the last view whose ground was there is drawn; else the ground has holes there
    int loads_in_flight = 0;
    int published = 0, evicted = 0, dropped = 0; ///< this frame
    int64_t published_total = 0, evicted_total = 0, failed_total = 0;
    int64_t abandoned_total = 0;       ///< loads given up before they began
    int64_t oldest_request_frames = 0; ///< age of the oldest wanted node that is not resident, failed ones aside
    int64_t oldest_visible_frames = 0; ///< the same among the groups urgent and visible
    uint64_t in_flight_bytes = 0;      ///< reserved for loads and loaded payloads
    uint64_t payload_bytes = 0;        ///< of them, really held by loaded payloads
    uint64_t context_bytes = 0;        ///< of every context alive, whoever holds it
    uint64_t slot_bytes = 0;           ///< slot_bytes of every node that is published
    uint64_t published_bytes = 0;      ///< this frame
};

struct FrameResult {
    std::span<const VisibleTile> visible; ///< front to back; valid until the next update
    const StreamStats& stats;
    /// What to draw: the view asked for, or, while its ground has yet to come (after a jump), the last one whose ground
    /// was there. Only before the first view is complete, and where roots cannot be loaded, is there less to draw.
    const ViewState& view;
};

/// One row of the tile map.
struct NodeInfo {
    TileKey key;
    NodeState state;
    bool drawn;
};

/// Owner thread only; the destructor waits for running loads.
class TileStreamer {
  public:
    TileStreamer(const StreamSettings& settings, StreamExternals externals);
    ~TileStreamer();
    TileStreamer(const TileStreamer&) = delete;
    TileStreamer& operator=(const TileStreamer&) = delete;

    /// One frame: takes what was loaded, hands over within the budgets, asks for what is missing, says what to draw.
    FrameResult update(const ViewState& view, double dt_s);
    /// What the last update or settle gave.
    [[nodiscard]] FrameResult frame() const;
    /// Everything the last view needs to be drawn as it should be (within the slots there are) is there, up to date and
    /// faded in: no parent stands in for a child that could come. What is then visible depends on the view alone.
    [[nodiscard]] bool ready() const;
    /// Updates until ready, waiting for loads in between; the streamer's clock runs ahead over fades and retries.
    /// False when nothing more can come and something is missing (a tile failed for good). A path of settled views
    /// starts the same loads in the same order for any number and speed of workers; jobs must run without the owner.
    bool settle(const ViewState& view);

    /// The tile's data changed: load it again (and nothing else). A failed tile gets a new chance. Unknown keys are
    /// ignored.
    void invalidate(TileKey key);
    /// Everything changed (the sun moved): load all of it again, coarse tiles first.
    void invalidate_all();

    /// A resident tile whose contents are not stored yet: evicted after the clean ones, and only once committed.
    void set_dirty(TileKey key, bool dirty);

    [[nodiscard]] const StreamSettings& settings() const;
    [[nodiscard]] const StreamStats& stats() const;
    [[nodiscard]] bool is_current(NodeHandle handle) const;
    void list_nodes(std::vector<NodeInfo>& nodes) const;
    /// Keys in the order their loads were started; for tests. Empty unless recording.
    void record_requests(bool on);
    [[nodiscard]] const std::vector<TileKey>& requests() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace sahel
