#include "tests/world/store_support.h"
#include "world/sqlite.h"
#include "world/state_hash.h"

#include <chrono>
#include <csignal>
#include <fstream>
#include <map>
#include <set>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace sahel::store_test {
namespace {

TEST_F(Store, WhatWasCommittedIsReadAgainAfterReopening) {
    {
        World world = create(desc());
        ASSERT_TRUE(commit_tiles(world, 3, {{0, 0, 0}, {0, -1, 0}, {0, 5, -7}}).ok());
    }
    auto world = World::open(folder(), OpenMode::read);
    ASSERT_TRUE(world.ok()) << world.error().message;
    for (const TileKey key : {TileKey{0, 0, 0}, TileKey{0, -1, 0}, TileKey{0, 5, -7}}) {
        auto block = world->read_tile(key);
        ASSERT_TRUE(block.ok()) << block.error().message;
        const LayerBlock expected = make_tile(key, 128);
        for (const Layer l : {Layer::bedrock, Layer::sand})
            for (int y = 0; y < 128; ++y)
                for (int x = 0; x < 128; ++x) ASSERT_EQ(block->ints(l)(x, y), expected.ints(l)(x, y));
        EXPECT_EQ(block->ints(Layer::water)(7, 7), 0);
    }
    EXPECT_EQ(world->read_tile({0, 1, 0}).error().kind, ErrorKind::not_found);
    const auto info = world->info();
    ASSERT_TRUE(info.ok());
    EXPECT_EQ(info->step, 3);
    EXPECT_EQ(info->tile_count, 3);
    EXPECT_GT(info->parent_count, 0);
    EXPECT_EQ(info->bounds, (CellRect{-128, -896, 768, 128}));
}

TEST_F(Store, TheHashDoesNotKnowTheTileSize) {
    std::map<int, std::string> hashes;
    for (const int n : {128, 256, 512}) {
        World world = create(desc(n), std::to_string(n));
        std::vector<TileKey> keys;
        for_each_tile({-512, 0, 512, 512}, 0, n, [&](TileKey key) { keys.push_back(key); });
        ASSERT_TRUE(commit_tiles(world, 1, keys).ok());
        hashes[n] = world.hash().value();
        EXPECT_EQ(hashes[n].size(), 32u);
    }
    EXPECT_EQ(hashes[128], hashes[256]);
    EXPECT_EQ(hashes[128], hashes[512]);
}

TEST_F(Store, OneTickChangesTheHashAndTheOrderOfCommitsDoesNot) {
    World a = create(desc(), "a");
    ASSERT_TRUE(commit_tiles(a, 1, {{0, 0, 0}}).ok());
    const std::string one = a.hash().value();
    ASSERT_TRUE(commit_tiles(a, 1, {{0, 1, 0}}).ok());
    World b = create(desc(), "b");
    ASSERT_TRUE(commit_tiles(b, 1, {{0, 1, 0}}).ok());
    ASSERT_TRUE(commit_tiles(b, 2, {{0, 0, 0}}).ok());
    EXPECT_EQ(a.hash().value(), b.hash().value());
    EXPECT_NE(a.hash().value(), one);
    LayerBlock changed = make_tile({0, 0, 0}, 128);
    changed.ints(Layer::sand)(64, 64) += 1;
    const TileUpdate update{{0, 0, 0}, &changed};
    ASSERT_TRUE(b.commit(3, std::span(&update, 1)).ok());
    EXPECT_NE(a.hash().value(), b.hash().value());
}

TEST_F(Store, ParentsAreTheMeansOfTheirChildrenAndTheSurfaceShowsThem) {
    World world = create(desc());
    std::vector<TileKey> keys;
    for_each_tile({0, 0, 512, 512}, 0, 128, [&](TileKey key) { keys.push_back(key); });
    ASSERT_TRUE(commit_tiles(world, 1, keys).ok());
    for (int level = 1; level <= 6; ++level) {
        const int64_t side = 512 >> level;
        auto block = LayerBlock::allocate(level, {-2, -2, side + 2, side + 2}, 0, k_surface_layers);
        ASSERT_TRUE(world.surface().read(*block).ok());
        EXPECT_EQ(block->ints(Layer::bedrock)(0, 0), 0) << "the plain around the tiles";
        for (const auto& [x, y] : {std::pair<int64_t, int64_t>{0, 0}, {side / 2, side / 3}, {side - 1, side - 1}}) {
            double sum = 0.0;
            const int64_t n = int64_t{1} << level;
            for (int64_t j = y * n; j < (y + 1) * n; ++j)
                for (int64_t i = x * n; i < (x + 1) * n; ++i) sum += cell_value(i, j, 0);
            EXPECT_NEAR(block->ints(Layer::bedrock)(static_cast<int>(x) + 2, static_cast<int>(y) + 2),
                        sum / static_cast<double>(n * n), 1.0)
                << "level " << level << " cell " << x << ", " << y;
        }
    }
}

TEST_F(Store, StoredTilesLieOverTheBaseTerrain) {
    World world = create(desc(128, "oasis"));
    const BaseTerrain terrain(1, world.desc().terrain);
    auto expected = LayerBlock::allocate(0, {-100, -100, 300, 300}, 0, k_surface_layers);
    ASSERT_TRUE(terrain.read(*expected).ok());
    ASSERT_TRUE(commit_tiles(world, 1, {{0, 0, 0}}).ok());
    auto block = LayerBlock::allocate(0, {-100, -100, 300, 300}, 0, k_surface_layers);
    ASSERT_TRUE(world.surface().read(*block).ok());
    const auto rock = block->ints(Layer::bedrock), base = expected->ints(Layer::bedrock);
    for (int y = 0; y < 400; y += 3)
        for (int x = 0; x < 400; x += 3) {
            const bool stored = x >= 100 && x < 228 && y >= 100 && y < 228;
            ASSERT_EQ(rock(x, y), stored ? cell_value(x - 100, y - 100, 0) : base(x, y)) << x << ", " << y;
        }
}

TEST_F(Store, EveryDamageIsFoundAndNamed) {
    {
        World world = create(desc());
        ASSERT_TRUE(commit_tiles(world, 1, {{0, 0, 0}, {0, 1, 1}}).ok());
    }
    const auto issues = [&] {
        auto world = World::open(folder(), OpenMode::read);
        auto report = world->verify();
        EXPECT_TRUE(report.ok());
        return report->issues;
    };
    EXPECT_TRUE(issues().empty());
    const auto files = tile_files();
    ASSERT_GE(files.size(), 3u);
    for (const fs::path& file : files) {
        const auto bytes = read_file(file).value();
        for (const size_t at : {size_t{0}, bytes.size() / 2, bytes.size() - 1}) {
            auto flipped = bytes;
            flipped[at] ^= 0x10;
            ASSERT_TRUE(write_file(file, std::span<const uint8_t>(flipped)).ok());
            const auto found = issues();
            ASSERT_EQ(found.size(), 1u) << file << " byte " << at;
            EXPECT_NE(file.string().find(found[0].path), std::string::npos);
            EXPECT_EQ(found[0].can_regenerate, file.string().find("/L00/") == std::string::npos);
        }
        fs::remove(file);
        EXPECT_EQ(issues().size(), 1u);
        ASSERT_TRUE(write_file(file, std::span<const uint8_t>(bytes)).ok());
    }
    std::ofstream(folder() / "tiles" / "stray.exr") << "x";
    EXPECT_EQ(issues().size(), 1u);
}

TEST_F(Store, EveryTruncationOfATileIsRefused) {
    auto tile = make_stored_tile({0, 3, -2}, 128, make_tile({0, 3, -2}, 128));
    ASSERT_TRUE(tile.ok());
    const auto bytes = encode_tile(*tile).value();
    EXPECT_TRUE(decode_tile(bytes, "whole").ok());
    for (size_t n = 0; n < bytes.size(); n += n < 2000 || n + 2000 > bytes.size() ? 1 : 97) {
        const std::vector<uint8_t> cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(n)); // its own memory
        const auto decoded = decode_tile(cut, "cut");
        ASSERT_FALSE(decoded.ok()) << n << " of " << bytes.size();
        ASSERT_EQ(decoded.error().kind, ErrorKind::corrupt);
    }
}

TEST_F(Store, EveryCompressionGivesTheSameCells) {
    auto tile = make_stored_tile({0, 0, 0}, 128, make_tile({0, 0, 0}, 128));
    for (const TileCompression c :
         {TileCompression::none, TileCompression::zips, TileCompression::zip, TileCompression::piz}) {
        auto decoded = decode_tile(encode_tile(*tile, c).value(), "tile");
        ASSERT_TRUE(decoded.ok());
        EXPECT_EQ(hash_blocks(*decoded), hash_blocks(*tile));
    }
}

TEST_F(Store, RefusesWhatCannotBeAWorld) {
    for (const int n : {0, 100, 64, 16384})
        EXPECT_EQ(World::create(folder("bad"), desc(n)).error().kind, ErrorKind::usage);
    EXPECT_FALSE(fs::exists(folder("bad")));
    EXPECT_EQ(World::open(folder("missing"), OpenMode::read).error().kind, ErrorKind::not_found);
    fs::create_directories(folder("empty"));
    EXPECT_EQ(World::open(folder("empty"), OpenMode::read).error().kind, ErrorKind::not_found);
    { World world = create(desc()); }
    EXPECT_EQ(World::create(folder(), desc()).error().kind, ErrorKind::usage);
    const std::string json = read_text_file(folder() / "world.json").value();
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string changed = json;
        const size_t at = changed.find(from);
        EXPECT_NE(at, std::string::npos) << from;
        changed.replace(at, from.size(), to);
        EXPECT_TRUE(write_file(folder() / "world.json", changed).ok());
        auto opened = World::open(folder(), OpenMode::read);
        EXPECT_FALSE(opened.ok()) << to;
        return opened.ok() ? Error{} : opened.error();
    };
    EXPECT_EQ(with("\"format_version\": 2", "\"format_version\": 3").kind, ErrorKind::unsupported);
    EXPECT_EQ(with("\"tile_cells\": 128", "\"tile_cells\": 256").kind, ErrorKind::corrupt);
    EXPECT_EQ(with("\"tile_cells\": 128", "\"tile_cells\": 130").kind, ErrorKind::usage);
    const Error unknown = with("\"seed\"", "\"sead\": 1, \"seed\"");
    EXPECT_NE(unknown.message.find("sead"), std::string::npos) << unknown.message;
    EXPECT_NE(unknown.message.find("world.json"), std::string::npos) << unknown.message;
    EXPECT_EQ(with("{", "[").kind, ErrorKind::corrupt);
}

TEST_F(Store, WhatIsOnlyShownIsKeptBesideTheStateAndIsNoPartOfIt) {
    World still = create(desc(), "still"), windy = create(desc(), "windy");
    const TileKey key{0, 0, 0};
    ASSERT_TRUE(commit_tiles(still, 1, {key}).ok());
    const LayerBlock state = make_tile(key, 128);
    auto all = LayerBlock::allocate(0, tile_rect(key, 128), 0, k_stored_layers).value();
    all.clear();
    for (int y = 0; y < 128; ++y)
        for (int x = 0; x < 128; ++x) {
            for (const Layer l : {Layer::bedrock, Layer::sand}) all.ints(l)(x, y) = state.ints(l)(x, y);
            all.reals(Layer::wind_x)(x, y) = 4.0f;
            all.reals(Layer::wind_shadow)(x, y) = static_cast<float>(x) / 128.0f;
        }
    const TileUpdate update{key, &all};
    ASSERT_TRUE(windy.commit(1, std::span(&update, 1)).ok());
    EXPECT_EQ(still.hash().value(), windy.hash().value());

    constexpr LayerSet k_wind{Layer::wind_x, Layer::wind_y, Layer::wind_shadow};
    const auto read = [&](const World& world, int32_t level, const CellRect& rect) {
        auto block = LayerBlock::allocate(level, rect, 0, k_wind).value();
        EXPECT_TRUE(world.surface().read(block).ok());
        return block;
    };
    const CellRect across{120, 0, 136, 4}; // and of the tile beside it, which is not stored
    const LayerBlock near = read(windy, 0, across), none = read(still, 0, across);
    for (int x = 0; x < 16; ++x) {
        EXPECT_EQ(near.reals(Layer::wind_x)(x, 1), x < 8 ? 4.0f : 0.0f) << x;
        EXPECT_EQ(near.reals(Layer::wind_shadow)(x, 1), x < 8 ? static_cast<float>(120 + x) / 128.0f : 0.0f) << x;
        EXPECT_EQ(near.reals(Layer::wind_y)(x, 1), 0.0f);
        EXPECT_EQ(none.reals(Layer::wind_x)(x, 1), 0.0f);
    }
    const LayerBlock far = read(windy, 1, {0, 0, 80, 8}); // the mean of four cells; half of the parent is calm
    EXPECT_EQ(far.reals(Layer::wind_x)(3, 3), 4.0f);
    EXPECT_EQ(far.reals(Layer::wind_shadow)(3, 3), 6.5f / 128.0f);
    EXPECT_EQ(far.reals(Layer::wind_x)(70, 3), 0.0f);
}

TEST_F(Store, TilesCanBeAskedForOneByOne) {
    World a = create(desc(), "a"), b = create(desc(), "b");
    std::vector<TileKey> keys;
    for_each_tile({-256, 0, 512, 640}, 0, 128, [&](TileKey key) { keys.push_back(key); });
    ASSERT_TRUE(commit_tiles(a, 1, keys).ok());
    std::vector<TileUpdate> updates;
    int alive = 0, most = 0;
    for (const TileKey key : keys)
        updates.push_back({key, nullptr, [&, key](LayerBlock& to) -> Status {
                               most = std::max(most, ++alive);
                               EXPECT_EQ(to.layers(), k_stored_layers);
                               const LayerBlock from = make_tile(key, 128);
                               for (const Layer l : {Layer::bedrock, Layer::sand})
                                   for (int y = 0; y < 128; ++y)
                                       for (int x = 0; x < 128; ++x) to.ints(l)(x, y) = from.ints(l)(x, y);
                               --alive;
                               return {};
                           }});
    ASSERT_TRUE(b.commit(1, updates).ok());
    EXPECT_EQ(most, 1);
    EXPECT_EQ(a.hash().value(), b.hash().value());
    EXPECT_EQ(a.info()->parent_count, b.info()->parent_count);
    for (const char* name : {"a", "b"}) EXPECT_EQ(tile_files(name).size(), tile_files("a").size());
    auto from_a = LayerBlock::allocate(3, {-32, -8, 64, 80}, 0, k_surface_layers).value();
    auto from_b = LayerBlock::allocate(3, {-32, -8, 64, 80}, 0, k_surface_layers).value();
    ASSERT_TRUE(a.surface().read(from_a).ok() && b.surface().read(from_b).ok());
    for (int y = 0; y < 88; ++y)
        for (int x = 0; x < 96; ++x) ASSERT_EQ(from_a.ints(Layer::bedrock)(x, y), from_b.ints(Layer::bedrock)(x, y));

    updates.resize(1); // what fails to be filled leaves the world as it was
    updates[0].fill = [](LayerBlock&) -> Status { return Error{ErrorKind::io, "no"}; };
    const std::string before = b.hash().value();
    EXPECT_EQ(b.commit(2, updates).error().kind, ErrorKind::io);
    EXPECT_EQ(b.hash().value(), before);
    EXPECT_TRUE(b.verify()->issues.empty());
}

TEST_F(Store, WhatWaitsInAnInboxIsStateAndArrives) {
    World world = create(desc());
    ASSERT_TRUE(commit_tiles(world, 1, {{0, 0, 0}, {0, 1, 0}}).ok());
    const std::string empty = world.hash().value();
    const Inbox first{{0, 1, 0}, Layer::sand, {{5 * 128 + 3, 40}, {7, 2}, {5 * 128 + 3, 60}}};
    ASSERT_TRUE(world.commit(2, {}, {.inboxes = std::span(&first, 1), .ledger = {}, .resume = {}}).ok());
    const Inbox second{{0, 1, 0}, Layer::sand, {{7, 1}, {127 * 128 + 127, 9}}};
    const std::string half = world.hash().value();
    ASSERT_TRUE(world.commit(2, {}, {.inboxes = std::span(&second, 1), .ledger = {}, .resume = {}}).ok());
    const auto waiting = world.inboxes(TileKey{0, 1, 0});
    ASSERT_TRUE(waiting.ok());
    ASSERT_EQ(waiting->size(), 1u);
    const std::vector<InboxCell> expected = {{7, 3}, {643, 100}, {16383, 9}};
    EXPECT_EQ((*waiting)[0].cells, expected);
    EXPECT_EQ(world.inboxes()->size(), 1u);
    EXPECT_TRUE(world.inboxes(TileKey{0, 0, 0})->empty());
    const std::string hash = world.hash().value();
    EXPECT_NE(hash, empty);
    EXPECT_NE(hash, half);
    EXPECT_TRUE(world.verify()->issues.empty());

    // Nobody may overwrite the tile and lose it.
    const Status lost = commit_tiles(world, 3, {{0, 1, 0}});
    ASSERT_FALSE(lost.ok());
    EXPECT_EQ(lost.error().kind, ErrorKind::usage);
    EXPECT_NE(lost.error().message.find("1,0"), std::string::npos) << lost.error().message;

    LayerBlock block = make_tile({0, 1, 0}, 128);
    for (const InboxCell& c : expected)
        block.ints(Layer::sand)(c.cell % 128, c.cell / 128) += static_cast<int32_t>(c.ticks);
    const TileUpdate update{{0, 1, 0}, &block, {}, true};
    ASSERT_TRUE(world.commit(3, std::span(&update, 1)).ok());
    EXPECT_TRUE(world.inboxes()->empty());
    EXPECT_EQ(world.hash().value(), hash) << "arriving changes nothing";

    const Inbox nowhere{{0, 1, 0}, Layer::sand, {{128 * 128, 1}}};
    EXPECT_EQ(world.commit(4, {}, {.inboxes = std::span(&nowhere, 1), .ledger = {}, .resume = {}}).error().kind,
              ErrorKind::usage);
}

TEST_F(Store, WaitingAtAnyPlaceHashesAlikeForEveryTileSize) {
    std::set<std::string> hashes;
    for (const int n : {128, 256, 512}) {
        World world = create(desc(n, "dunes"), std::to_string(n));
        std::vector<TileKey> keys;
        for_each_tile({0, 0, 512, 512}, 0, n, [&](TileKey key) { keys.push_back(key); });
        std::map<TileKey, Inbox> inboxes; // around, on land that is not stored, and one inside
        for (const auto& [x, y] : {std::pair<int64_t, int64_t>{-1, 5}, {-3, -3}, {512, 511}, {200, 517}, {130, 300}}) {
            const TileKey key = tile_of({x, y}, 0, n);
            Inbox& inbox = inboxes[key];
            inbox.key = key;
            inbox.layer = Layer::sand;
            inbox.cells.push_back({static_cast<int32_t>((y - key.y * n) * n + x - key.x * n), 1000 + x});
        }
        std::vector<Inbox> list;
        for (auto& [key, inbox] : inboxes) list.push_back(inbox);
        ASSERT_TRUE(commit_tiles(world, 1, keys).ok());
        const std::string before = world.hash().value();
        ASSERT_TRUE(world.commit(1, {}, {.inboxes = list, .ledger = {}, .resume = {}}).ok());
        EXPECT_NE(world.hash().value(), before);
        hashes.insert(world.hash().value());
    }
    EXPECT_EQ(hashes.size(), 1u);
}

TEST_F(Store, LedgerAndResumeAreKeptWithTheStep) {
    const std::vector<uint8_t> wind = {1, 2, 3};
    const std::vector<LedgerRow> rows = {{{0, 0, 0}, {9, 9}}, {{0, -5, 2}, {7}}};
    {
        World world = create(desc());
        EXPECT_TRUE(world.ledger()->empty());
        EXPECT_TRUE(world.resume()->empty());
        ASSERT_TRUE(world.commit(1, {}, {.inboxes = {}, .ledger = rows, .resume = wind}).ok());
    }
    auto world = World::open(folder(), OpenMode::write);
    ASSERT_TRUE(world.ok()) << world.error().message;
    EXPECT_EQ(world->resume().value(), wind);
    ASSERT_EQ(world->ledger()->size(), 2u);
    EXPECT_EQ(world->ledger().value()[1].key, (TileKey{0, -5, 2}));
    EXPECT_EQ(world->ledger().value()[1].bytes, rows[1].bytes);
    const LedgerRow newer{{0, 0, 0}, {1}};
    ASSERT_TRUE(world->commit(2, {}, {.inboxes = {}, .ledger = std::span(&newer, 1), .resume = {}}).ok());
    EXPECT_TRUE(world->resume()->empty()) << "of another step";
    EXPECT_EQ(world->ledger().value()[0].bytes, newer.bytes);
    EXPECT_EQ(world->ledger()->size(), 2u);
}

TEST_F(Store, DamagedRowsAreFoundAndNamed) {
    {
        World world = create(desc());
        const Inbox inbox{{0, 4, -2}, Layer::sand, {{1, 1}}};
        const LedgerRow row{{0, 3, 3}, {1, 2, 3, 4}};
        const std::vector<uint8_t> wind = {5, 5};
        ASSERT_TRUE(world.commit(1, {}, {std::span(&inbox, 1), std::span(&row, 1), wind}).ok());
    }
    const auto spoil = [&](const char* sql) {
        auto db = sqlite::Database::open(folder() / "index.sqlite", sqlite::Database::Mode::write);
        ASSERT_TRUE(db.ok() && db->run(sql).ok());
    };
    auto issues = [&] { return World::open(folder(), OpenMode::read)->verify()->issues; };
    EXPECT_TRUE(issues().empty());
    spoil("UPDATE inbox SET cells = x'010000000200000000000000'");
    ASSERT_EQ(issues().size(), 1u);
    EXPECT_NE(issues()[0].what.find("4,-2"), std::string::npos) << issues()[0].what;
    EXPECT_EQ(World::open(folder(), OpenMode::read)->inboxes().error().kind, ErrorKind::corrupt);
    EXPECT_EQ(World::open(folder(), OpenMode::read)->hash().error().kind, ErrorKind::corrupt);
    spoil("UPDATE ledger SET account = x'01'");
    ASSERT_EQ(issues().size(), 2u);
    EXPECT_NE(issues()[1].what.find("3,3"), std::string::npos) << issues()[1].what;
    spoil("UPDATE resume SET blob = x'0505ff'");
    EXPECT_EQ(issues().size(), 3u);
}

TEST_F(Store, TheSimulationIsKeptAsItIs) {
    WorldDesc d = desc();
    d.simulation = R"({"sand":{"lift_rate":0.5},"wind":{}})";
    { World world = create(d); }
    auto world = World::open(folder(), OpenMode::read);
    ASSERT_TRUE(world.ok()) << world.error().message;
    EXPECT_EQ(world->desc().simulation, d.simulation);
    d.simulation = "[1]";
    EXPECT_EQ(World::create(folder("b"), d).error().kind, ErrorKind::usage);
    d.simulation = "{";
    EXPECT_FALSE(World::create(folder("b"), d).ok());
}

TEST_F(Store, OneWriterAtATimeAndManyReaders) {
    World world = create(desc());
    ASSERT_TRUE(commit_tiles(world, 1, {{0, 0, 0}}).ok());
    const auto second = World::open(folder(), OpenMode::write);
    ASSERT_FALSE(second.ok());
    EXPECT_EQ(second.error().kind, ErrorKind::busy);
    auto reader = World::open(folder(), OpenMode::read);
    ASSERT_TRUE(reader.ok());
    EXPECT_EQ(reader->hash().value(), world.hash().value());
    EXPECT_EQ(reader->commit(2, {}).error().kind, ErrorKind::usage);
    EXPECT_EQ(commit_tiles(world, 0, {{0, 1, 0}}).error().kind, ErrorKind::usage) << "steps do not go back";
}

TEST_F(Store, AFullDiskLeavesTheLastCommit) {
    std::string before;
    {
        World world = create(desc());
        ASSERT_TRUE(commit_tiles(world, 1, {{0, 0, 0}}).ok());
        before = world.hash().value();
    }
    // No file may grow beyond 20 kB in the child: its writes fail as on a full disk.
    const pid_t child = fork();
    if (child == 0) {
        std::signal(SIGXFSZ, SIG_IGN);
        auto world = World::open(folder(), OpenMode::write);
        const rlimit limit{20000, 20000};
        setrlimit(RLIMIT_FSIZE, &limit);
        const Status failed = commit_tiles(*world, 2, {{0, 0, 0}, {0, 1, 0}}, 9);
        _exit(!failed.ok() && failed.error().kind == ErrorKind::io ? 0 : 1);
    }
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_EQ(WEXITSTATUS(status), 0);
    auto world = World::open(folder(), OpenMode::write);
    ASSERT_TRUE(world.ok()) << world.error().message;
    EXPECT_EQ(world->hash().value(), before);
    EXPECT_TRUE(world->verify()->issues.empty());
}

TEST_F(Store, KilledAtAnyInstantTheLastCommitIsThereWhole) {
    // What the world hashes to after each step.
    constexpr int k_steps = 4;
    const std::vector<TileKey> keys = {{0, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    std::vector<std::string> expected;
    const auto begin = std::chrono::steady_clock::now();
    {
        World world = create(desc(), "reference");
        expected.push_back(world.hash().value());
        for (int s = 1; s <= k_steps; ++s) {
            ASSERT_TRUE(commit_whole_step(world, s, keys).ok());
            expected.push_back(world.hash().value());
        }
    }
    // Kills fall anywhere in the time that all steps take on this machine.
    const auto whole_us =
        std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() - begin).count();
    { World world = create(desc()); }
    uint64_t random = 12345;
    int seen_steps = 0;
    for (int round = 0; round < 200; ++round) {
        const pid_t child = fork();
        if (child == 0) {
            auto world = World::open(folder(), OpenMode::write);
            if (!world.ok()) _exit(2);
            for (int64_t s = world->info()->step + 1; s <= k_steps; ++s)
                if (!commit_whole_step(*world, s, keys).ok()) _exit(3);
            _exit(0);
        }
        random = random * 6364136223846793005ull + 1442695040888963407ull;
        usleep(static_cast<useconds_t>((random >> 33) % static_cast<uint64_t>(whole_us)));
        kill(child, SIGKILL);
        int status = 0;
        waitpid(child, &status, 0);
        ASSERT_TRUE(WIFSIGNALED(status) || WEXITSTATUS(status) == 0) << "exit code " << WEXITSTATUS(status);
        auto world = World::open(folder(), OpenMode::write);
        ASSERT_TRUE(world.ok()) << world.error().message;
        const auto info = world->info();
        ASSERT_TRUE(info.ok());
        ASSERT_EQ(world->hash().value(), expected[static_cast<size_t>(info->step)]) << "round " << round;
        if (info->step > 0) {
            ASSERT_EQ(world->inboxes().value().at(0).cells.at(0).ticks, info->step);
            ASSERT_EQ(world->ledger().value().at(0).bytes.at(0), info->step);
            ASSERT_EQ(world->resume().value().at(2), info->step);
        }
        const auto report = world->verify();
        ASSERT_TRUE(report.ok());
        ASSERT_TRUE(report->issues.empty()) << report->issues[0].path << ": " << report->issues[0].what;
        seen_steps |= 1 << info->step;
        if (info->step == k_steps) { // start over
            world = Error{};
            fs::remove_all(folder());
            World fresh = create(desc());
        }
    }
    EXPECT_NE(seen_steps, 1) << "no kill left a committed step behind";
}

} // namespace
} // namespace sahel::store_test
