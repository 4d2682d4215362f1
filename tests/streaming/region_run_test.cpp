#include "streaming/region_run.h"

#include "streaming/region_tiles.h"
#include "world/cuda_runtime.h"
#include "world/executor.h"
#include "world/state_hash.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <unistd.h>
#include <utility>

namespace sahel {
namespace {

namespace fs = std::filesystem;

class Region : public testing::Test {
  protected:
    void SetUp() override {
        std::string pattern = (fs::temp_directory_path() / "sahel-region-XXXXXX").string();
        ASSERT_NE(mkdtemp(pattern.data()), nullptr);
        base_ = pattern;
    }
    void TearDown() override {
        set_thread_count(0);
        fs::remove_all(base_);
    }
    World create(const std::string& name, int tile_cells = 128) {
        WorldDesc desc;
        desc.name = name;
        desc.preset = "dunes";
        desc.terrain = base_terrain_preset("dunes").value();
        desc.tile_cells = tile_cells;
        return World::create(base_ / name, desc).value();
    }
    World reopen(const std::string& name) { return World::open(base_ / name, OpenMode::write).value(); }
    fs::path base_;
};

/// Much wind, quick avalanches and rock that wears: whatever crosses a border does so in a few steps.
SimulationParams lively() {
    SimulationParams p;
    p.wind.angle_deg = -18.0f;
    p.wind.speed_m_per_s = 7.0f;
    p.wind.epoch_steps = 4;
    p.sand.abrasion = 0.2f;
    p.sand.soil_abrasion = 0.2f;
    p.sand.reptation_smooth = 0.3f;
    return p;
}

RegionOptions options_for(TileRect region, int32_t halo = 0) {
    RegionOptions o;
    o.region = region;
    o.simulation = lively();
    o.device = "cpu";
    o.halo = halo;
    return o;
}

RegionRun open_run(World& world, const RegionOptions& options) {
    auto run = RegionRun::open(world, options);
    EXPECT_TRUE(run.ok()) << (run.ok() ? "" : run.error().message);
    return std::move(run).value();
}

void expect_closed(const World& world) {
    const auto ledger = read_world_ledger(world);
    ASSERT_TRUE(ledger.ok()) << ledger.error().message;
    EXPECT_TRUE(ledger->check.closed()) << ledger->check.text;
    for (const int64_t ticks : ledger->check.total) EXPECT_EQ(ticks, 0);
    const auto report = world.verify();
    ASSERT_TRUE(report.ok());
    for (const VerifyIssue& issue : report->issues) ADD_FAILURE() << issue.path << ": " << issue.what;
    const auto wrong = verify_world_ledger(world);
    ASSERT_TRUE(wrong.ok()) << wrong.error().message;
    for (const std::string& what : *wrong) ADD_FAILURE() << what;
}

/// What the tiles hold and what waits, of one layer.
int64_t held(const World& world, Layer layer) {
    int64_t sum = 0;
    for (const TileKey key : world.tiles(0).value()) {
        const LayerBlock block = world.read_tile(key, {layer}).value();
        for (int y = 0; y < world.desc().tile_cells; ++y)
            for (int x = 0; x < world.desc().tile_cells; ++x) sum += block.ints(layer)(x, y);
    }
    for (const Inbox& inbox : world.inboxes().value())
        if (inbox.layer == layer)
            for (const InboxCell& c : inbox.cells) sum += c.ticks;
    return sum;
}

TEST_F(Region, TheSameBitsForEveryTileSizeHaloAndThreadCount) {
    struct Way {
        int tile_cells;
        int32_t halo;
        int threads;
    };
    std::map<std::string, std::string> hashes;
    for (const Way w : {Way{512, 16, 2}, {256, 64, 1}, {128, 0, 5}, {128, 128, 2}}) {
        const std::string name = std::to_string(w.tile_cells) + "-" + std::to_string(w.halo);
        set_thread_count(w.threads);
        World world = create(name, w.tile_cells);
        const int32_t tiles = 512 / w.tile_cells;
        RegionRun run = open_run(world, options_for({-tiles, 0, 0, tiles}, w.halo));
        const auto finished = run.run(6);
        ASSERT_TRUE(finished.ok()) << finished.error().message;
        EXPECT_TRUE(*finished);
        hashes[name] = world.hash().value();
        EXPECT_FALSE(world.inboxes()->empty()) << "nothing left the region: the test shows little";
        expect_closed(world);
    }
    for (const auto& [name, hash] : hashes) EXPECT_EQ(hash, hashes.begin()->second) << name;
}

TEST_F(Region, StoppedAnywhereItGoesOnToTheSameBits) {
    const TileRect region{0, 0, 2, 1};
    {
        World whole = create("whole");
        RegionRun run = open_run(whole, options_for(region, 16));
        ASSERT_TRUE(run.run(10).ok());
        EXPECT_FALSE(run.goes_on());
    }
    { World parts = create("parts"); }
    int64_t at = 0;
    for (const int64_t until : {3, 4, 9, 10}) { // within epochs of four steps and at their ends
        set_thread_count(at == 3 ? 5 : 1);
        World world = reopen("parts");
        RegionRun run = open_run(world, options_for(region, until == 9 ? 48 : 16));
        EXPECT_EQ(run.step(), at);
        EXPECT_EQ(run.goes_on(), at > 0);
        const auto finished = run.run(10, [&](const RegionStep& s) { return s.step < until; });
        ASSERT_TRUE(finished.ok()) << finished.error().message;
        EXPECT_EQ(*finished, until == 10);
        at = until;
    }
    World whole = reopen("whole"), parts = reopen("parts");
    EXPECT_EQ(whole.info()->step, 10);
    EXPECT_EQ(parts.info()->step, 10);
    EXPECT_EQ(whole.hash().value(), parts.hash().value());
    expect_closed(parts);
    const auto a = read_world_ledger(whole), b = read_world_ledger(parts);
    EXPECT_EQ(a->book.tiles(), b->book.tiles()) << "the accounts add up to the same";
    EXPECT_EQ(a->waiting, b->waiting);
}

TEST_F(Region, CheckpointsChangeNothingAndAreWhole) {
    const TileRect region{0, 0, 1, 1};
    World plain = create("plain"), often = create("often");
    RegionRun one = open_run(plain, options_for(region));
    ASSERT_TRUE(one.run(7).ok());
    RegionOptions options = options_for(region);
    options.checkpoint_steps = 2;
    RegionRun two = open_run(often, options);
    std::vector<int64_t> committed;
    ASSERT_TRUE(two.run(7,
                        [&](const RegionStep& s) {
                            EXPECT_EQ(s.domain.slots(), 1);
                            committed.push_back(often.info()->step);
                            return true;
                        })
                    .ok());
    EXPECT_EQ(committed, (std::vector<int64_t>{0, 0, 2, 2, 4, 4, 6}));
    EXPECT_EQ(plain.hash().value(), often.hash().value());
    expect_closed(often);
}

TEST_F(Region, WhatFlowsOverArrivesWhenTheNeighbourWakes) {
    World world = create("world");
    { // both tiles stored as they are: what they hold before anything moved
        std::vector<LayerBlock> blocks;
        std::vector<TileUpdate> updates;
        for (const int64_t x : {0, 1}) {
            blocks.push_back(LayerBlock::allocate(0, tile_rect({0, x, 0}, 128), 0, k_state_layers).value());
            ASSERT_TRUE(world.surface().read(blocks.back()).ok());
        }
        for (const int64_t x : {0, 1}) updates.push_back({{0, x, 0}, &blocks[static_cast<size_t>(x)]});
        ASSERT_TRUE(world.commit(0, updates).ok());
    }
    const auto solids = [&] {
        int64_t sum = 0;
        for (const Layer l : {Layer::bedrock, Layer::soil, Layer::sand, Layer::sediment, Layer::airborne_sand})
            sum += held(world, l);
        return sum;
    };
    const auto waits_at = [&](TileKey key) {
        int64_t sum = 0;
        for (const Inbox& inbox : world.inboxes(key).value())
            for (const InboxCell& c : inbox.cells) sum += c.ticks;
        return sum;
    };
    const int64_t opening = solids();
    const TileKey east{0, 1, 0};
    {
        RegionRun run = open_run(world, options_for({0, 0, 1, 1}));
        ASSERT_TRUE(run.run(5).ok());
    }
    EXPECT_EQ(solids(), opening) << "the tile, its sleeping neighbour and what waits";
    const int64_t waiting = waits_at(east);
    EXPECT_GT(waiting, 0);
    expect_closed(world);
    const std::string hash = world.hash().value();
    {
        RegionRun run = open_run(world, options_for({1, 0, 2, 1}));
        EXPECT_EQ(world.hash().value(), hash) << "waking alone changes nothing";
        ASSERT_TRUE(run.run(9).ok());
        const LayerAccount sand = run.ledger().tiles().at(east).of(SimLayer::sand);
        const LayerAccount air = run.ledger().tiles().at(east).of(SimLayer::airborne_sand);
        const auto inbox = static_cast<size_t>(LedgerSource::inbox);
        EXPECT_EQ(sand.sources[inbox] + air.sources[inbox], waiting);
    }
    EXPECT_EQ(waits_at(east), 0);
    EXPECT_EQ(solids(), opening);
    expect_closed(world);
    // And back again, both together.
    RegionRun run = open_run(world, options_for({0, 0, 2, 1}));
    ASSERT_TRUE(run.run(12).ok());
    EXPECT_EQ(solids(), opening);
    expect_closed(world);
}

TEST_F(Region, TheLastWindIsStoredToLookAt) {
    World world = create("world");
    RegionRun run = open_run(world, options_for({0, 0, 1, 1}));
    ASSERT_TRUE(run.run(3).ok());
    auto stored =
        LayerBlock::allocate(0, tile_rect({0, 0, 0}, 128), 0, {Layer::wind_x, Layer::wind_y, Layer::wind_shadow})
            .value();
    ASSERT_TRUE(world.surface().read(stored).ok());
    float fastest = 0.0f, most_shelter = 0.0f;
    for (const auto& [sim, layer] : {std::pair{SimLayer::wind_x, Layer::wind_x},
                                     {SimLayer::wind_y, Layer::wind_y},
                                     {SimLayer::wind_shadow, Layer::wind_shadow}}) {
        std::vector<float> cells(128 * 128);
        ASSERT_TRUE(run.domain().store(0, sim, cells.data()).ok());
        for (int y = 0; y < 128; ++y)
            for (int x = 0; x < 128; ++x) {
                const float v = stored.reals(layer)(x, y);
                ASSERT_EQ(v, cells[static_cast<size_t>(y * 128 + x)]) << info_of(layer).name;
                (layer == Layer::wind_shadow ? most_shelter : fastest) =
                    std::max(layer == Layer::wind_shadow ? most_shelter : fastest, std::abs(v));
            }
    }
    EXPECT_GT(fastest, 1.0f);
    EXPECT_GT(most_shelter, 0.5f);
}

TEST_F(Region, SupplyIsANamedSource) {
    World world = create("world");
    RegionOptions options = options_for({0, 0, 1, 1});
    options.simulation.sand.supply = true;
    options.simulation.sand.supply_uniform = true;
    options.simulation.sand.supply_threshold_m = 50.0f;
    options.simulation.sand.supply_every_steps = 2;
    RegionRun run = open_run(world, options);
    ASSERT_TRUE(run.run(3).ok());
    const LayerAccount sand = run.ledger().total(SimLayer::sand);
    EXPECT_GT(sand.sources[static_cast<size_t>(LedgerSource::supply_added)], 0);
    expect_closed(world);
}

TEST_F(Region, TheMemoryIsWhatWasPredicted) {
    World world = create("world");
    const RegionOptions options = options_for({0, 0, 2, 1}, 24);
    const RegionMemory need = RegionRun::memory_needed(options, world.desc(), 24, false);
    RegionRun run = open_run(world, options);
    ASSERT_TRUE(run.run(2).ok());
    EXPECT_EQ(run.tiles_bytes(), need.tiles_bytes);

    RegionOptions poor = options;
    poor.memory_bytes = need.least_bytes(false) - 1;
    const auto refused = RegionRun::open(world, poor);
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(refused.error().kind, ErrorKind::usage);
    const std::string least = std::to_string((need.least_bytes(false) + (1u << 20) - 1) >> 20) + " MiB";
    EXPECT_NE(refused.error().message.find(least), std::string::npos) << refused.error().message;
    poor.memory_bytes += 1;
    EXPECT_TRUE(RegionRun::open(world, poor).ok());
}

TEST_F(Region, RefusalsNameWhatToDo) {
    World world = create("world");
    const auto refused = [&](const std::function<void(RegionOptions&)>& change) {
        RegionOptions options = options_for({0, 0, 1, 1});
        change(options);
        const auto run = RegionRun::open(world, options);
        EXPECT_FALSE(run.ok());
        return run.ok() ? Error{} : run.error();
    };
    const Error narrow = refused([](RegionOptions& o) { o.halo = 3; });
    EXPECT_EQ(narrow.kind, ErrorKind::usage);
    EXPECT_NE(narrow.message.find("at least"), std::string::npos) << narrow.message;
    EXPECT_EQ(refused([](RegionOptions& o) { o.halo = 129; }).kind, ErrorKind::usage);
    EXPECT_EQ(refused([](RegionOptions& o) { o.device = "gpu"; }).kind, ErrorKind::usage);
    if (!cuda::available()) {
        EXPECT_EQ(refused([](RegionOptions& o) { o.device = "cuda:0"; }).kind, ErrorKind::usage);
    }
    EXPECT_EQ(refused([](RegionOptions& o) { o.simulation.sand.shadow_length_m = 500.0f; }).kind, ErrorKind::usage)
        << "shelter is looked for further than a tile is wide";
    EXPECT_EQ(refused([](RegionOptions& o) { o.simulation.rose = "missing.csv"; }).kind, ErrorKind::not_found);
    EXPECT_EQ(world.info()->tile_count, 0);
}

TEST_F(Region, AnOpenLedgerCommitsNothing) {
    World world = create("world");
    RegionRun run = open_run(world, options_for({0, 0, 1, 1}));
    ASSERT_TRUE(run.run(1).ok());
    const std::string before = world.hash().value();
    const auto lost = run.run(3, [](const RegionStep& s) {
        s.domain.ints(SimLayer::sand)(0, 40, 40) += 1;
        return true;
    });
    ASSERT_FALSE(lost.ok());
    EXPECT_EQ(lost.error().kind, ErrorKind::corrupt);
    EXPECT_NE(lost.error().message.find("2 ticks"), std::string::npos) << lost.error().message;
    EXPECT_EQ(world.hash().value(), before);
    EXPECT_EQ(world.info()->step, 1);
}

TEST_F(Region, ATileThatSomethingElseChangedIsNotTaken) {
    World world = create("world");
    {
        RegionRun run = open_run(world, options_for({0, 0, 1, 1}));
        ASSERT_TRUE(run.run(1).ok());
    }
    LayerBlock block = world.read_tile({0, 0, 0}).value();
    block.ints(Layer::soil)(3, 3) += 7;
    const TileUpdate update{{0, 0, 0}, &block};
    ASSERT_TRUE(world.commit(2, std::span(&update, 1)).ok());
    const auto wrong = verify_world_ledger(world);
    ASSERT_EQ(wrong->size(), 1u);
    EXPECT_NE(wrong->at(0).find("soil"), std::string::npos) << wrong->at(0);
    const auto run = RegionRun::open(world, options_for({0, 0, 1, 1}));
    ASSERT_FALSE(run.ok());
    EXPECT_NE(run.error().message.find("soil"), std::string::npos) << run.error().message;
}

TEST_F(Region, LayersThatTheSimulationLacksStayAsTheyAre) {
    World world = create("world");
    LayerBlock block = LayerBlock::allocate(0, tile_rect({0, 0, 0}, 128), 0, k_state_layers).value();
    ASSERT_TRUE(world.surface().read(block).ok());
    block.ints(Layer::sediment)(5, 6) = 12345;
    block.ints(Layer::mask)(7, 8) = 2;
    const TileUpdate update{{0, 0, 0}, &block};
    const Inbox inbox{{0, 0, 0}, Layer::sediment, {{6 * 128 + 5, 5}}};
    ASSERT_TRUE(world.commit(0, std::span(&update, 1)).ok());
    ASSERT_TRUE(world.commit(0, {}, {.inboxes = std::span(&inbox, 1), .ledger = {}, .resume = {}}).ok());
    RegionOptions options = options_for({0, 0, 1, 1});
    options.checkpoint_steps = 1;
    RegionRun run = open_run(world, options);
    ASSERT_TRUE(run.run(3).ok());
    const LayerBlock after = world.read_tile({0, 0, 0}).value();
    EXPECT_EQ(after.ints(Layer::sediment)(5, 6), 12350);
    EXPECT_EQ(after.ints(Layer::mask)(7, 8), 2);
}

TEST_F(Region, DevicesGiveTheSameBits) {
    if (!cuda::available()) GTEST_SKIP() << "no CUDA device: " << cuda::status().why_not;
    std::set<std::string> hashes;
    for (const char* device : {"cpu", "cuda:0"}) {
        World world = create(device);
        RegionOptions options = options_for({0, 0, 2, 2});
        options.device = device;
        RegionRun run = open_run(world, options);
        ASSERT_TRUE(run.run(6).ok());
        hashes.insert(world.hash().value());
        expect_closed(world);
    }
    EXPECT_EQ(hashes.size(), 1u);
}

TEST(TileRects, AreReadStrictly) {
    EXPECT_EQ(parse_tile_rect("-1,0,2,3").value(), (TileRect{-1, 0, 2, 3}));
    for (const char* text :
         {"", "1", "0,0,1", "0,0,1,1,", "0,0,1,1,2", "a,0,1,1", "0, 0,1,1", "0,0,1.5,1", "0,0,0,1", "1,0,0,1",
          "0,0,99999999999,1", "0,0,2147483647,2147483647", "-2147483648,0,2147483647,1", "0;0;1;1"}) {
        const auto rect = parse_tile_rect(text);
        ASSERT_FALSE(rect.ok()) << text;
        EXPECT_EQ(rect.error().kind, ErrorKind::usage);
        EXPECT_EQ(rect.error().message.find('\n'), std::string::npos);
    }
}

TEST(SimulationText, IsReadAsItIsWrittenAndStrictly) {
    SimulationParams p = lively();
    p.rose = "winds.csv";
    WorldDesc desc;
    desc.simulation = simulation_json(p);
    const auto read = simulation_of(desc, "world.json");
    ASSERT_TRUE(read.ok()) << read.error().message;
    EXPECT_EQ(simulation_json(*read), desc.simulation);
    EXPECT_TRUE(set_simulation(p, "sand.lift_rate=0.5", "--set").ok());
    EXPECT_EQ(p.sand.lift_rate_m_per_s, 0.5f);
    EXPECT_TRUE(set_simulation(p, "wind.bidirectional=true", "--set").ok());
    EXPECT_TRUE(p.wind.bidirectional);
    for (const char* text : {"sand.lift_rat=1", "lift_rate=1", "sand.lift_rate", "sand.lift_rate=x",
                             "sand.lift_rate=", "sand.lift_rate=1e9", "sand.soil_sweeps=1.5", "=1", "wind.warp=2"}) {
        const Status refused = set_simulation(p, text, "--set");
        ASSERT_FALSE(refused.ok()) << text;
        EXPECT_EQ(refused.error().kind, ErrorKind::usage);
        EXPECT_NE(refused.error().message.find("--set"), std::string::npos) << refused.error().message;
    }
    EXPECT_NE(set_simulation(p, "sand.lift_rat=1", "--set").error().message.find("sand.lift_rate"), std::string::npos);
    desc.simulation = R"({"sand": {"nosuch": 1}})";
    EXPECT_NE(simulation_of(desc, "world.json").error().message.find("simulation.sand.nosuch"), std::string::npos);
    desc.simulation = R"({"sandy": {}})";
    EXPECT_EQ(simulation_of(desc, "world.json").error().kind, ErrorKind::usage);
    desc.simulation.clear();
    desc.preset = "dunes";
    desc.terrain = base_terrain_preset("dunes").value();
    EXPECT_NEAR(simulation_of(desc, "w")->wind.angle_deg, -18.1f, 0.05f) << "as the wind that shaped the dunes";
}

} // namespace
} // namespace sahel
