#include "streaming/scene_run.h"
#include "tests/streaming/scene_support.h"

#include "world/executor.h"
#include "world/exr_image.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace sahel::test {
namespace {

Result<SceneRun> make_run(const std::filesystem::path& file, const SceneRunOptions& options = {}) {
    auto scene = load_scene(file);
    if (!scene.ok()) return scene.error();
    return SceneRun::create(*scene, options);
}

TEST(SceneLayout, TilesDivideTheGrid) {
    const auto cut = [](int32_t w, int32_t h, int32_t halo) {
        auto layout = scene_layout(w, h, halo);
        SAHEL_CHECK(layout.ok());
        return *layout;
    };
    EXPECT_EQ(cut(2048, 512, 8).tile_cells, 512);
    EXPECT_EQ(cut(2048, 512, 8).tiles.size(), 4u);
    EXPECT_EQ(cut(2048, 512, 8).halo, 32);
    EXPECT_EQ(cut(128, 64, 8).tile_cells, 64);
    EXPECT_EQ(cut(128, 64, 8).halo, 16);
    EXPECT_EQ(cut(768, 768, 61).tile_cells, 256);
    EXPECT_EQ(cut(768, 768, 61).halo, 64);
    EXPECT_FALSE(scene_layout(96, 96, 61).ok()); // tiles of 32
    EXPECT_FALSE(scene_layout(100, 96, 8).ok());
}

TEST(SceneRunTest, StartsAsItsGroundSays) {
    const auto run = make_run(scene_data("scene_oasis.json"));
    ASSERT_TRUE(run.ok()) << run.error().message;
    for (const auto& [layer, metres] :
         {std::pair{SimLayer::bedrock, &run->ground().bedrock_m}, std::pair{SimLayer::soil, &run->ground().soil_m},
          std::pair{SimLayer::sand, &run->ground().sand_m}, std::pair{SimLayer::water, &run->ground().water_m},
          std::pair{SimLayer::moisture, &run->ground().moisture_m}}) {
        const auto field = run->field(layer);
        ASSERT_TRUE(field.ok());
        for (size_t i = 0; i < field->size(); ++i)
            ASSERT_NEAR((*field)[i], (*metres)[i], 0.5f / k_ticks_per_m) << info_of(layer).name;
    }
    const auto report = run->report();
    ASSERT_TRUE(report.ok());
    EXPECT_EQ(report->steps, 0);
    EXPECT_EQ(report->drift_ticks, 0);
    EXPECT_EQ(report->coverage, 1.0);
    EXPECT_NEAR(report->sand_mean_m, 1.0, 1e-6);
    EXPECT_NEAR(report->sand_std_m, 0.0, 1e-3);
}

TEST(SceneRunTest, MovesSandAndKeepsTheBooks) {
    for (const char* name : {"scene_dunes.json", "scene_dunes_2023.json", "scene_oasis.json"}) {
        auto run = make_run(scene_data(name));
        ASSERT_TRUE(run.ok()) << run.error().message;
        const auto before = run->field(SimLayer::sand);
        for (int i = 0; i < 12; ++i) ASSERT_TRUE(run->step().ok());
        const auto after = run->field(SimLayer::sand);
        ASSERT_TRUE(before.ok() && after.ok());
        const auto report = run->report();
        ASSERT_TRUE(report.ok());
        EXPECT_EQ(report->steps, 12);
        EXPECT_EQ(report->drift_ticks, 0) << name;
        EXPECT_TRUE(std::all_of(after->begin(), after->end(), [](float s) { return s >= 0.0f; }));
        EXPECT_GT(report->max_wind_m_per_s, 0.0);
        if (std::string(name) == "scene_oasis.json") continue; // its ground is too wet for the wind
        EXPECT_NE(*before, *after) << name;
        EXPECT_GT(report->airborne_mean_m, 0.0) << name;
        // The old scene is supplied: its target is full cover.
        if (std::string(name) == "scene_dunes.json") {
            EXPECT_EQ(report->supplied_ticks, 0);
        }
    }
}

TEST(SceneRunTest, SupplyIsOnTheBooks) {
    Json json = scene_json("scene_dunes.json");
    json["calcCoverage"] = true;
    json["constantCoverage"] = true;
    json["coverageSpawnUniform"] = true;
    json["coverageThreshold"] = 5.0;
    json["spawnSteps"] = 2;
    const auto scene = parse_scene(json.dump(), "x");
    ASSERT_TRUE(scene.ok());
    auto run = SceneRun::create(*scene);
    ASSERT_TRUE(run.ok()) << run.error().message;
    for (int i = 0; i < 4; ++i) ASSERT_TRUE(run->step().ok());
    const auto report = run->report();
    ASSERT_TRUE(report.ok());
    EXPECT_EQ(report->drift_ticks, 0);
    // Two events of 1 m on average.
    const double cells = 128.0 * 64.0;
    EXPECT_NEAR(static_cast<double>(report->supplied_ticks) / k_ticks_per_m / cells, 2.0, 0.05);
}

TEST(SceneRunTest, ThreadsAndSizesAreFree) {
    const auto hash = [](int threads) {
        set_thread_count(threads);
        auto run = make_run(scene_data("scene_dunes.json"), {.ground = {.size = 256}});
        SAHEL_CHECK(run.ok());
        for (int i = 0; i < 3; ++i) SAHEL_CHECK(run->step().ok());
        SAHEL_CHECK_EQ(run->width(), 256);
        auto h = run->domain().hash({SimLayer::bedrock, SimLayer::sand, SimLayer::airborne_sand});
        SAHEL_CHECK(h.ok());
        set_thread_count(0);
        return *h;
    };
    EXPECT_EQ(hash(1), hash(2));
    // A disc of supply keeps its share of a smaller grid.
    Json json = scene_json("scene_dunes.json");
    json["gridSize"] = Json::array({512, 512});
    json["calcCoverage"] = true;
    json["constantCoverage"] = true;
    const auto scene = parse_scene(json.dump(), "x");
    ASSERT_TRUE(scene.ok());
    const auto run = SceneRun::create(*scene, {.ground = {.size = 128}});
    ASSERT_TRUE(run.ok());
    EXPECT_EQ(run->aeolian().desc().sand.supply_radius_cells, 25);
    EXPECT_EQ(run->aeolian().desc().wind.epoch_steps, 1);
}

/// Every cell fully sticky: half the lift, and all that lands stays (Desertscape method 4.4).
TEST(SceneRunTest, StickyMapsMayBeKept) {
    const TemporaryFolder folder;
    const auto file = folder.path() / "sticky.json";
    Json json = scene_json("scene_dunes.json");
    json["exportMaps"] = true;
    json["initializationParameters"]["Sand"]["uniform_random"] = false;
    json["initializationParameters"]["Sand"]["flat"] = true;
    json["initializationParameters"]["Sand"]["bias"] = 5.0;
    ASSERT_TRUE(write_file(file, json.dump()).ok());
    ExrImage map{128, 64, {}};
    for (const char* name : {"A", "B", "G", "R"})
        map.planes.push_back({name, std::vector<float>(128 * 64, name[0] == 'A' ? 1.0f : 0.0f)});
    ASSERT_TRUE(write_exr_image(file.string() + ".resistance.exr", map).ok());
    for (const bool keep : {true, false}) {
        auto run = make_run(file, {.ground = {.keep_sticky = keep}});
        ASSERT_TRUE(run.ok()) << run.error().message;
        for (int i = 0; i < 3; ++i) ASSERT_TRUE(run->step().ok());
        const auto report = run->report();
        ASSERT_TRUE(report.ok());
        EXPECT_EQ(report->drift_ticks, 0);
        // Of the 1 m that is lifted, 60 % land at once without classes: 0.4 + 0.16 + 0.064 m are in the air.
        EXPECT_NEAR(report->airborne_mean_m, keep ? 0.0 : 0.624, 2e-3);
    }
}

/// P2 over every published dune scene, with abrasion on, on two by two tiles (wind tunnels: two).
TEST(PublishedScenes, TheLedgerOfEachClosesToZero) {
    if (!std::getenv("SAHEL_LONG_TESTS")) GTEST_SKIP() << "runs with SAHEL_LONG_TESTS=1";
    const auto dunes = published_scenes("scenes-dunes");
    if (dunes.empty()) GTEST_SKIP() << "the published scenes are not here";
    int scenes = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(dunes)) {
        if (entry.path().extension() != ".json") continue;
        auto scene = load_scene(entry.path());
        ASSERT_TRUE(scene.ok()) << scene.error().message;
        scene->sand.abrasion = std::max(scene->sand.abrasion, 0.1f);
        const std::string name = entry.path().filename().string();
        const bool longer = name == "barchans.json" || name == "abrasion.json" || name == "bidir_64_105.json";
        auto run = SceneRun::create(*scene, {.ground = {.size = 256}, .most_tile_cells = 128, .ledger = true});
        ASSERT_TRUE(run.ok()) << entry.path() << ": " << run.error().message;
        const int steps = longer ? 2000 : 200;
        for (int i = 0; i < steps; ++i) {
            const Status status = run->step();
            ASSERT_TRUE(status.ok()) << entry.path() << ": " << status.error().message;
        }
        const auto check = run->ledger_check();
        ASSERT_TRUE(check.ok());
        EXPECT_TRUE(check->closed()) << entry.path() << ": " << check->text;
        const auto report = run->report();
        ASSERT_TRUE(report.ok());
        EXPECT_EQ(report->drift_ticks, 0) << entry.path();
        std::printf("%-45s %2d tiles, %d steps: residual %lld ticks\n", name.c_str(), run->domain().slots(), steps,
                    static_cast<long long>(check->total[0] + report->drift_ticks));
        std::fflush(stdout);
        ++scenes;
    }
    EXPECT_GE(scenes, 20);
}

TEST(PublishedScenes, AHandfulRuns) {
    const auto dunes = published_scenes("scenes-dunes");
    const auto oasis = published_scenes("scenes-oasis");
    if (dunes.empty() || oasis.empty()) GTEST_SKIP() << "the published scenes are not here";
    for (const auto& file : {dunes / "A_512.json", dunes / "2023" / "B_512.json", dunes / "star.json",
                             dunes / "abrasion.json", dunes / "vegetation.json", dunes / "extremeWindWarping.json",
                             dunes / "bidir_22_105.json", oasis / "desert.json"}) {
        auto run = make_run(file, {.ground = {.size = 128}, .most_tile_cells = 64, .ledger = true});
        ASSERT_TRUE(run.ok()) << run.error().message;
        EXPECT_EQ(run->domain().slots(), 4);
        for (int i = 0; i < 3; ++i) {
            const Status status = run->step();
            ASSERT_TRUE(status.ok()) << file << ": " << status.error().message;
        }
        const auto report = run->report();
        ASSERT_TRUE(report.ok());
        EXPECT_EQ(report->drift_ticks, 0) << file;
        const auto check = run->ledger_check();
        ASSERT_TRUE(check.ok());
        EXPECT_TRUE(check->closed()) << file << ": " << check->text;
        EXPECT_GT(report->airborne_mean_m, 0.0) << file;
        EXPECT_TRUE(std::isfinite(report->excess_max)) << file;
    }
}

} // namespace
} // namespace sahel::test
