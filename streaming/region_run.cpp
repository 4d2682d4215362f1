#include "streaming/region_run.h"

#include "streaming/region_tiles.h"
#include "world/cuda_runtime.h"
#include "world/memory.h"
#include "world/state_hash.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstring>
#include <limits>
#include <optional>
#include <unistd.h>
#include <vector>

namespace sahel {

namespace {

constexpr int64_t k_most_tiles = 65535;  // slots of a launch on a device
constexpr int64_t k_settle_steps = 1024; // an inbox holds 2^31 ticks a cell: emptied long before
constexpr int32_t k_usual_halo = 32;
constexpr uint64_t k_cache_bytes = uint64_t{192} << 20; // decoded tiles that a world keeps

/// What a commit leaves to go on with.
struct ResumeHeader {
    char magic[8] = {'s', 'a', 'h', 'e', 'l', 'r', 'u', 'n'};
    int64_t version = 1;
    int64_t x0 = 0, y0 = 0, x1 = 0, y1 = 0; ///< cells of the region
    int64_t step = 0;
    Digest params{};
    friend bool operator==(const ResumeHeader&, const ResumeHeader&) = default;
};
static_assert(sizeof(ResumeHeader) == 72 && std::endian::native == std::endian::little);

Digest digest_of(const SimulationParams& params, const Aeolian::Desc& desc) {
    std::string text = simulation_json(params);
    if (desc.schedule)
        for (const WindSchedule::Row& row : desc.schedule->rows())
            text += fmt::format(" {} {} {}", row.start_s, row.wind.speed_m_per_s, row.wind.angle_deg);
    if (desc.schedule) text += fmt::format(" {}", desc.schedule->length_s());
    return checksum({reinterpret_cast<const uint8_t*>(text.data()), text.size()});
}

std::string bytes_text(uint64_t bytes) {
    return fmt::format("{} MiB", (bytes + (1u << 20) - 1) >> 20);
}

uint64_t machine_bytes() {
    return static_cast<uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<uint64_t>(sysconf(_SC_PAGE_SIZE));
}

Result<bool> is_device(const std::string& name) {
    if (name == "cpu") return false;
    if (name == "auto") return cuda::available();
    if (name != "cuda:0")
        return Error{ErrorKind::usage, fmt::format("there is no device '{}': choose auto, cpu or cuda:0", name)};
    if (!cuda::available())
        return Error{ErrorKind::usage,
                     fmt::format("device cuda:0 cannot be used: {}; choose auto or cpu", cuda::status().why_not)};
    return true;
}

TileLayout layout_of(const TileRect& region, int32_t tile_cells, int32_t halo) {
    TileLayout layout; // without bounds: every tile around is asleep
    layout.tile_cells = tile_cells;
    layout.halo = halo;
    for (int64_t y = region.y0; y < region.y1; ++y)
        for (int64_t x = region.x0; x < region.x1; ++x) layout.tiles.push_back({0, x, y});
    return layout;
}

Result<int32_t> choose_halo(int32_t asked, int32_t least, int32_t tile_cells) {
    if (least > tile_cells)
        return Error{ErrorKind::usage,
                     fmt::format("these parameters need halos of {} cells, wider than the world's tiles of {}", least,
                                 tile_cells)};
    if (asked == 0) return std::min(tile_cells, std::max(k_usual_halo, (least + 7) / 8 * 8));
    if (asked < least)
        return Error{ErrorKind::usage,
                     fmt::format("a halo of {} cells is too narrow for these parameters: at least {}", asked, least)};
    if (asked > tile_cells)
        return Error{ErrorKind::usage,
                     fmt::format("a halo of {} cells is wider than the world's tiles of {}", asked, tile_cells)};
    return asked;
}

Status in_world(const World& world, Status status) {
    if (status.ok()) return {};
    Error e = status.error();
    if (e.message.find(world.folder().string()) == std::string::npos)
        e.message = world.folder().string() + ": " + e.message;
    return e;
}

} // namespace

Result<TileRect> parse_tile_rect(std::string_view text) {
    const auto bad = [&](const std::string& why) {
        return Error{ErrorKind::usage, fmt::format("region '{}': {}", text, why)};
    };
    std::array<int32_t, 4> v{};
    const char* at = text.data();
    const char* const end = at + text.size();
    for (size_t i = 0; i < v.size(); ++i) {
        const auto [next, error] = std::from_chars(at, end, v[i]);
        if (error == std::errc::result_out_of_range)
            return bad(fmt::format("tiles are numbered from {} to {}", INT32_MIN, INT32_MAX));
        const bool last = i + 1 == v.size();
        if (error != std::errc{} || (last ? next != end : next == end || *next != ','))
            return bad("write X0,Y0,X1,Y1, four whole numbers");
        at = next + 1;
    }
    const TileRect rect{v[0], v[1], v[2], v[3]};
    if (rect.x1 <= rect.x0 || rect.y1 <= rect.y0)
        return bad("it is empty: X1 must be above X0 and Y1 above Y0 (the last ones are not part of it)");
    const int64_t wide = int64_t{rect.x1} - rect.x0, high = int64_t{rect.y1} - rect.y0;
    if (wide > k_most_tiles || high > k_most_tiles || wide * high > k_most_tiles)
        return bad(fmt::format("{} x {} tiles are too many: at most {}", wide, high, k_most_tiles));
    return rect;
}

RegionMemory RegionRun::memory_needed(const RegionOptions& options, const WorldDesc& desc, int32_t halo, bool device) {
    Aeolian::Desc aeolian;
    aeolian.wind = options.simulation.wind;
    aeolian.sand = options.simulation.sand;
    aeolian.cell_m = desc.cell_m;
    const SimLayerSet layers = Aeolian::layers(aeolian);
    const TileLayout layout = layout_of(options.region, desc.tile_cells, halo);
    RegionMemory memory;
    memory.tiles_bytes = TileDomain::slab_bytes(layout, layers) + TileDomain::flow_bytes(layout, layers) +
                         avalanche_bytes(layout.tiles.size());
    // Lists of copies and of cells to compute, wind and flags of avalanches: small beside the slabs.
    if (device) memory.tiles_bytes += memory.tiles_bytes / 64 + (uint64_t{16} << 20);
    const uint64_t tile = uint64_t{4} * static_cast<uint64_t>(k_stored_layers.size()) *
                          static_cast<uint64_t>(desc.tile_cells) * static_cast<uint64_t>(desc.tile_cells);
    // A commit holds of each level up to four tiles, beside one that is made and its file; decoded tiles are kept.
    const auto wide = static_cast<uint64_t>(
        std::max(int64_t{options.region.x1} - options.region.x0, int64_t{options.region.y1} - options.region.y0));
    const auto levels = static_cast<uint64_t>(std::bit_width(wide)) + 1;
    const uint64_t coarse = static_cast<uint64_t>(options.region.count()) * static_cast<uint64_t>(desc.tile_cells) *
                            static_cast<uint64_t>(desc.tile_cells) / 16;
    memory.working_bytes = (3 * levels + 4) * tile + std::min(k_cache_bytes, 16 * tile) + 16 * coarse;
    return memory;
}

struct RegionRun::Impl {
    World* world = nullptr;
    RegionOptions options;
    Digest params{};
    std::unique_ptr<MemoryPool> pool; ///< outlives the domain
    std::optional<TileDomain> domain;
    std::optional<Aeolian> aeolian;
    std::optional<Ledger> ledger; ///< since it was settled last
    std::vector<LoadedTile> loaded;
    std::vector<TileAccount> account; ///< since the last commit, settled
    WaitingTicks waiting;             ///< since the last commit, settled
    LedgerBook book;                  ///< of the world, the tiles of the region
    LedgerBook run_book;
    int64_t step = 0;
    int64_t committed_step = 0;
    int64_t settled_step = 0;
    bool goes_on = false;
    bool first_commit = true;

    Status load();
    Status find_wind();
    Status settle();
    Status commit();
    [[nodiscard]] ResumeHeader header() const {
        const int64_t n = world->desc().tile_cells;
        ResumeHeader h;
        h.x0 = options.region.x0 * n;
        h.y0 = options.region.y0 * n;
        h.x1 = options.region.x1 * n;
        h.y1 = options.region.y1 * n;
        h.step = step;
        h.params = params;
        return h;
    }
};

Status RegionRun::Impl::load() {
    for (int32_t slot = 0; slot < domain->slots(); ++slot) {
        SAHEL_ASSIGN(LoadedTile tile, load_tile(*world, *domain, slot, MemoryPool::host()));
        loaded.push_back(std::move(tile));
        SAHEL_TRY(load_rims(*world, *domain, slot));
    }
    SAHEL_ASSIGN(ledger, Ledger::open(*domain));
    SAHEL_ASSIGN(const std::vector<LedgerRow> rows, world->ledger());
    for (const LedgerRow& row : rows) {
        SAHEL_ASSIGN(TileAccount tile, parse_ledger_bytes(row.key, row.bytes, "index.sqlite"));
        book.insert(tile);
    }
    for (int32_t slot = 0; slot < domain->slots(); ++slot) {
        const LoadedTile& tile = loaded[static_cast<size_t>(slot)];
        for (const auto& [layer, ticks] : tile.untouched) ledger->untouched(slot, layer, ticks);
        for (const auto& [layer, ticks] : tile.arrived) ledger->arrived(slot, layer, ticks);
    }
    LedgerBook trial = book; // the tiles are what the ledger says, or nothing may start
    return trial.append(ledger->tiles());
}

// The wind of an epoch that a run before left unfinished.
Status RegionRun::Impl::find_wind() {
    SAHEL_ASSIGN(const std::vector<uint8_t> bytes, world->resume());
    ResumeHeader found;
    if (bytes.size() <= sizeof(found)) return {};
    std::memcpy(static_cast<void*>(&found), bytes.data(), sizeof(found));
    if (!(found == header())) return {}; // of another region, or other parameters
    SAHEL_TRY(aeolian->wind().restore({bytes.begin() + sizeof(found), bytes.end()}));
    goes_on = true;
    return {};
}

// Closes the ledger over the steps since it was opened, and opens it again.
Status RegionRun::Impl::settle() {
    if (settled_step == step && !account.empty()) return {};
    SAHEL_TRY(ledger->close(*domain));
    const LedgerCheck check = ledger->check();
    if (!check.closed())
        return Error{ErrorKind::corrupt, fmt::format("steps {} to {}: {}", settled_step, step, check.text)};
    SAHEL_TRY(collect_inboxes(*domain, waiting));
    if (account.empty()) {
        account.assign(ledger->tiles().begin(), ledger->tiles().end());
    } else {
        for (size_t i = 0; i < account.size(); ++i) SAHEL_TRY(account[i].append(ledger->tiles()[i]));
    }
    SAHEL_ASSIGN(ledger, Ledger::open(*domain));
    for (int32_t slot = 0; slot < domain->slots(); ++slot)
        for (const auto& [layer, ticks] : loaded[static_cast<size_t>(slot)].untouched)
            ledger->untouched(slot, layer, ticks);
    settled_step = step;
    return {};
}

Status RegionRun::Impl::commit() {
    if (step == committed_step) return {};
    SAHEL_TRY(settle());
    LedgerBook next = book;
    SAHEL_TRY(next.append(account));
    std::vector<LedgerRow> rows;
    for (const TileAccount& tile : account) rows.push_back({tile.key, ledger_bytes(next.tiles().at(tile.key))});
    std::vector<TileUpdate> updates;
    for (int32_t slot = 0; slot < domain->slots(); ++slot)
        updates.push_back({domain->layout().tiles[static_cast<size_t>(slot)], nullptr,
                           [this, slot](LayerBlock& block) {
                               static const std::vector<Inbox> none;
                               return store_tile(*world, *domain, slot,
                                                 first_commit ? loaded[static_cast<size_t>(slot)].taken : none, block);
                           },
                           true});
    const ResumeHeader h = header();
    std::vector<uint8_t> resume(sizeof(h));
    std::memcpy(resume.data(), &h, sizeof(h));
    const std::vector<uint8_t> wind = aeolian->wind().save();
    resume.insert(resume.end(), wind.begin(), wind.end());
    const std::vector<Inbox> inboxes = inboxes_of(waiting);
    SAHEL_TRY(world->commit(step, updates, {inboxes, rows, resume}));
    book = std::move(next);
    SAHEL_TRY(run_book.append(account));
    account.clear();
    waiting.clear();
    first_commit = false;
    committed_step = step;
    return {};
}

RegionRun::RegionRun(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
RegionRun::RegionRun(RegionRun&&) noexcept = default;
RegionRun& RegionRun::operator=(RegionRun&&) noexcept = default;
RegionRun::~RegionRun() = default;

Result<RegionRun> RegionRun::open(World& world, const RegionOptions& options) {
    const WorldDesc& desc = world.desc();
    SAHEL_ASSIGN(const bool device, is_device(options.device));
    SAHEL_ASSIGN(const Aeolian::Desc aeolian, aeolian_desc(options.simulation, desc, world.folder()));
    SAHEL_ASSIGN(const int32_t halo, choose_halo(options.halo, Aeolian::least_halo(aeolian), desc.tile_cells));
    const RegionMemory need = memory_needed(options, desc, halo, device);
    const uint64_t least = need.least_bytes(device);
    const uint64_t has = options.memory_bytes != 0 ? options.memory_bytes
                         : device                  ? cuda::status().memory_bytes
                                                   : machine_bytes();
    if (has < least)
        return Error{ErrorKind::usage,
                     fmt::format("{} x {} tiles of {} cells with halos of {} need at least {} of memory, more than the "
                                 "{} {}; choose a smaller region",
                                 options.region.x1 - options.region.x0, options.region.y1 - options.region.y0,
                                 desc.tile_cells, halo, bytes_text(least), bytes_text(has),
                                 options.memory_bytes != 0 ? "given" : "there are")};
    auto impl = std::make_unique<Impl>();
    impl->world = &world;
    impl->options = options;
    impl->params = digest_of(options.simulation, aeolian);
    impl->pool = std::make_unique<MemoryPool>("region", device ? MemoryKind::cuda : MemoryKind::host,
                                              device ? has : has - need.working_bytes);
    SAHEL_ASSIGN(TileDomain domain, TileDomain::create(layout_of(options.region, desc.tile_cells, halo),
                                                       Aeolian::layers(aeolian), *impl->pool));
    impl->domain.emplace(std::move(domain));
    SAHEL_ASSIGN(Aeolian run, Aeolian::create(aeolian, *impl->domain));
    impl->aeolian.emplace(std::move(run));
    SAHEL_ASSIGN(const WorldInfo info, world.info());
    impl->step = impl->committed_step = impl->settled_step = info.step;
    SAHEL_TRY(in_world(world, impl->load()));
    SAHEL_TRY(in_world(world, impl->find_wind()));
    return RegionRun(std::move(impl));
}

Result<bool> RegionRun::run(int64_t until_step, const OnStep& on_step) {
    Impl& r = *impl_;
    bool stopped = false;
    while (r.step < until_step && !stopped) {
        SAHEL_TRY(in_world(*r.world, r.aeolian->step(*r.domain, r.step)));
        ++r.step;
        if (on_step) stopped = !on_step({r.step, r.aeolian->stats(), *r.domain});
        const int64_t every = r.options.checkpoint_steps;
        if (every > 0 && r.step - r.committed_step >= every) SAHEL_TRY(in_world(*r.world, r.commit()));
        if (r.step - r.settled_step >= k_settle_steps) SAHEL_TRY(in_world(*r.world, r.settle()));
    }
    SAHEL_TRY(in_world(*r.world, r.commit()));
    return r.step >= until_step;
}

int64_t RegionRun::step() const {
    return impl_->step;
}
TileDomain& RegionRun::domain() {
    return *impl_->domain;
}
const AeolianStats& RegionRun::stats() const {
    return impl_->aeolian->stats();
}
bool RegionRun::goes_on() const {
    return impl_->goes_on;
}
uint64_t RegionRun::tiles_bytes() const {
    return impl_->pool->peak_bytes();
}
const LedgerBook& RegionRun::ledger() const {
    return impl_->run_book;
}

Result<WorldLedger> read_world_ledger(const World& world) {
    WorldLedger ledger;
    SAHEL_ASSIGN(const std::vector<LedgerRow> rows, world.ledger());
    for (const LedgerRow& row : rows) {
        SAHEL_ASSIGN(const TileAccount tile,
                     parse_ledger_bytes(row.key, row.bytes, (world.folder() / "index.sqlite").string()));
        ledger.book.insert(tile);
    }
    SAHEL_ASSIGN(const std::vector<Inbox> inboxes, world.inboxes());
    for (const Inbox& inbox : inboxes)
        for (const SimLayer layer : k_ledger_layers)
            if (info_of(layer).world == inbox.layer)
                for (const InboxCell& c : inbox.cells) ledger.waiting[ledger_index(layer)] += c.ticks;
    ledger.check = ledger.book.check(ledger.waiting);
    return ledger;
}

Result<std::vector<std::string>> verify_world_ledger(const World& world) {
    std::vector<std::string> wrong;
    SAHEL_ASSIGN(const WorldLedger ledger, read_world_ledger(world));
    if (!ledger.check.closed()) wrong.push_back(ledger.check.text);
    for (const auto& [key, tile] : ledger.book.tiles()) {
        auto block = world.read_tile(key);
        if (!block.ok()) {
            wrong.push_back(
                fmt::format("tile {},{} has an account but cannot be read: {}", key.x, key.y, block.error().message));
            continue;
        }
        for (const SimLayer layer : k_ledger_layers) {
            const FieldView<const int32_t> cells = std::as_const(*block).ints(*info_of(layer).world);
            int64_t sum = 0;
            for (int32_t y = 0; y < cells.height(); ++y)
                for (int32_t x = 0; x < cells.width(); ++x) sum += cells(x, y);
            if (sum != tile.of(layer).closing)
                wrong.push_back(fmt::format("tile {},{} holds {} ticks of {}, the ledger says {}", key.x, key.y, sum,
                                            info_of(layer).name, tile.of(layer).closing));
        }
    }
    return wrong;
}

} // namespace sahel
