#include "tests/streaming/scene_support.h"

#include "world/random.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <vector>

namespace sahel::test {
namespace {

using Edit = std::function<void(Json&)>;

/// The error that the changed scene gives; fails the test if there is none.
Error error_after(const std::string& name, const Edit& edit) {
    Json json = scene_json(name);
    edit(json);
    const auto scene = parse_scene(json.dump(), "x.json");
    EXPECT_FALSE(scene.ok()) << "read without an error";
    return scene.ok() ? Error{} : scene.error();
}

bool has_note(const Scene& scene, const std::string& part) {
    return std::any_of(scene.notes.begin(), scene.notes.end(),
                       [&](const std::string& note) { return note.find(part) != std::string::npos; });
}

TEST(SceneFile, DunesBecomeRates) {
    const auto scene = load_scene(scene_data("scene_dunes.json"));
    ASSERT_TRUE(scene.ok()) << scene.error().message;
    EXPECT_EQ(scene->name, "scene_dunes");
    EXPECT_EQ(scene->format, SceneFormat::dunes_2025);
    EXPECT_EQ(scene->cell_m, 2.0);
    EXPECT_EQ(scene->step_s, 1.0);
    EXPECT_EQ(scene->wind.speed_m_per_s, 5.0f);
    EXPECT_EQ(scene->wind.angle_deg, 10.0f);
    EXPECT_TRUE(scene->wind.bidirectional && scene->wind.strength_based);
    EXPECT_EQ(scene->wind.second_angle_deg, 105.0f);
    EXPECT_EQ(scene->wind.venturi_radius_m, 0.0f);
    EXPECT_TRUE(scene->wind.warp);
    EXPECT_EQ(scene->wind.warp_gain, 2.0f); // the divisor is 0.5
    EXPECT_EQ(scene->wind.warp_radius_2_m, 50.0f);
    EXPECT_TRUE(scene->wind.project);
    EXPECT_EQ(scene->wind.epoch_steps, 1);
    EXPECT_EQ(scene->sand.lift_rate_m_per_s, 1.0f);
    EXPECT_EQ(scene->sand.reptation_repose_s2_per_m2, 0.05f);
    // 0.5 of the file is more than one pass can: what meets a flat bed in a step, 1 m / 0.6, times it makes 0.8 of a
    // cell.
    EXPECT_NEAR(scene->sand.reptation_smooth_wind_s_per_m * scene->wind.speed_m_per_s / 0.6f,
                0.8f * static_cast<float>(scene->cell_m), 1e-5f);
    EXPECT_EQ(scene->sand.reptation_smooth, 0.0f);
    EXPECT_TRUE(scene->sand.reptation_shadowed);
    EXPECT_FALSE(scene->sand.abrasion_by_amount);
    EXPECT_EQ(scene->sand.avalanche_sweeps, 13);
    EXPECT_EQ(scene->sand.soil_sweeps, 0);
    EXPECT_FALSE(scene->sand.supply);
    EXPECT_TRUE(has_note(*scene, "Backward is run forward"));
    EXPECT_TRUE(has_note(*scene, "it smooths as much as one pass can"));
    EXPECT_EQ(scene->notes.size(), 2u);
    // The viewer's keys and those of another scheme are listed, without a note.
    EXPECT_NE(std::find(scene->ignored.begin(), scene->ignored.end(), "vSync"), scene->ignored.end());
    EXPECT_NE(std::find(scene->ignored.begin(), scene->ignored.end(), "multigridLevelCount"), scene->ignored.end());
    EXPECT_EQ(scene->ignored.size(), 5u);
}

TEST(SceneFile, OldFilesKeepTheirMeaning) {
    const auto scene = load_scene(scene_data("scene_dunes_2023.json"));
    ASSERT_TRUE(scene.ok()) << scene.error().message;
    EXPECT_EQ(scene->format, SceneFormat::dunes_2023);
    EXPECT_FALSE(scene->wind.project);
    EXPECT_EQ(scene->step_s, 0.5);
    EXPECT_EQ(scene->sand.step_s, 0.5f);
    EXPECT_EQ(scene->sand.lift_rate_m_per_s, 2.0f); // 1 m in a step of half a second
    EXPECT_EQ(scene->sand.echo_rate_m_per_s, 2.0f);
    EXPECT_EQ(scene->sand.reptation_repose_s2_per_m2, 0.0f);
    EXPECT_NEAR(scene->sand.reptation_smooth / 0.6f, 0.8f * static_cast<float>(scene->cell_m), 1e-5f); // of 3
    EXPECT_EQ(scene->sand.reptation_smooth_wind_s_per_m, 0.0f);
    EXPECT_TRUE(scene->sand.abrasion_by_amount);
    EXPECT_TRUE(scene->sand.supply);
    EXPECT_TRUE(has_note(*scene, "reptationStrength 3 is the smoothing"));
    EXPECT_TRUE(has_note(*scene, "not projected"));

    // Each sign of age alone is enough, as long as the newer key is absent; with it the file is new.
    for (const char* key : {"saltationMode", "multigridPresweepCount", "multigridPostsweepCount"}) {
        Json json = scene_json("scene_dunes.json");
        json.erase("reptationSmoothingStrength");
        const auto plain = parse_scene(json.dump(), "x");
        ASSERT_TRUE(plain.ok());
        EXPECT_EQ(plain->format, SceneFormat::dunes_2025);
        if (std::string(key) == "saltationMode")
            json[key] = "Continuous";
        else
            json[key] = 0;
        const auto old = parse_scene(json.dump(), "x");
        ASSERT_TRUE(old.ok());
        EXPECT_EQ(old->format, SceneFormat::dunes_2023) << key;
        json["reptationSmoothingStrength"] = 0.25;
        const auto newer = parse_scene(json.dump(), "x");
        ASSERT_TRUE(newer.ok());
        EXPECT_EQ(newer->format, SceneFormat::dunes_2025) << key;
    }
}

TEST(SceneFile, OasisWithItsSpecies) {
    const auto scene = load_scene(scene_data("scene_oasis.json"));
    ASSERT_TRUE(scene.ok()) << scene.error().message;
    EXPECT_EQ(scene->format, SceneFormat::oasis);
    EXPECT_EQ(scene->sand.soil_sweeps, 1);
    EXPECT_EQ(scene->sand.avalanche_strength, 1.0f);
    EXPECT_EQ(scene->sand.lift_rate_m_per_s, 2.0f);
    EXPECT_EQ(scene->values.water_border_level, 20.0f);
    EXPECT_EQ(scene->layers.water.bias, 20.0f);
    ASSERT_EQ(scene->species.size(), 2u);
    EXPECT_EQ(scene->species[0].name, "Trees");
    EXPECT_EQ(scene->species[0].params.max_radius_m, 10.0f);
    EXPECT_EQ(scene->species[0].params.stem_height, 4.0f); // after the first padding
    EXPECT_EQ(scene->species[0].params.max_stem_cover, 0.25f);
    EXPECT_EQ(scene->species[0].params.max_light, 1.7f);
    EXPECT_EQ(scene->species[0].dominance[1], 0.25f);
    EXPECT_EQ(scene->species[0].dominance[7], 1.0f);
    EXPECT_EQ(scene->species[1].params.separation, 0.25f); // its list is shorter
    EXPECT_TRUE(has_note(*scene, "only wind and sand are run"));
    // Any key may be absent.
    const auto bare = parse_scene(R"({"vegTypeCount": 0, "windSpeed": 3})", "x");
    ASSERT_TRUE(bare.ok()) << bare.error().message;
    EXPECT_EQ(bare->wind.speed_m_per_s, 3.0f);
    EXPECT_EQ(bare->step_s, 0.5);
    EXPECT_EQ(bare->layers.soil.bias, 10.0f);
}

struct Mistake {
    const char* name;
    const char* file;
    Edit edit;
    std::vector<std::string> parts; ///< of the message
};

class SceneMistakes : public testing::TestWithParam<Mistake> {};

TEST_P(SceneMistakes, NamesFileKeyAndRange) {
    const Error error = error_after(GetParam().file, GetParam().edit);
    EXPECT_EQ(error.kind, ErrorKind::usage);
    EXPECT_EQ(error.exit_code(), 2);
    EXPECT_NE(error.message.find("x.json"), std::string::npos) << error.message;
    EXPECT_EQ(error.message.find('\n'), std::string::npos);
    for (const std::string& part : GetParam().parts)
        EXPECT_NE(error.message.find(part), std::string::npos) << part << " in: " << error.message;
}

const char* const k_dunes = "scene_dunes.json";
const char* const k_oasis = "scene_oasis.json";

INSTANTIATE_TEST_SUITE_P(
    All, SceneMistakes,
    testing::Values(
        Mistake{"missing_key", k_dunes, [](Json& j) { j.erase("windSpeed"); }, {"windSpeed", "missing"}},
        Mistake{"missing_layers",
                k_dunes,
                [](Json& j) { j.erase("initializationParameters"); },
                {"initializationParameters", "missing"}},
        Mistake{"missing_in_layer",
                k_dunes,
                [](Json& j) { j["initializationParameters"]["Sand"].erase("bias"); },
                {"initializationParameters.Sand.bias", "missing"}},
        Mistake{"text_for_number", k_dunes, [](Json& j) { j["windSpeed"] = "fast"; }, {"windSpeed", "60", "\"fast\""}},
        Mistake{"number_for_bool", k_dunes, [](Json& j) { j["bilinear"] = 1; }, {"bilinear", "true or false"}},
        Mistake{"fraction_for_integer",
                k_dunes,
                [](Json& j) { j["avalancheIterations"] = 12.5; },
                {"avalancheIterations", "integer"}},
        Mistake{"text_for_projection",
                k_dunes,
                [](Json& j) { j["projectionMode"] = "FFT"; },
                {"projectionMode", "integer"}},
        Mistake{"out_of_range", k_dunes, [](Json& j) { j["windSpeed"] = 61; }, {"windSpeed", "61", "0 to 60"}},
        Mistake{"soft_modulus_0",
                k_dunes,
                [](Json& j) { j["avalancheSoftIterationModulus"] = 0; },
                {"avalancheSoftIterationModulus", "1 to"}},
        Mistake{"spawn_steps_0", k_dunes, [](Json& j) { j["spawnSteps"] = 0; }, {"spawnSteps", "1 to"}},
        Mistake{"divisor_0", k_dunes, [](Json& j) { j["windWarpingDivisor"] = 0.0; }, {"windWarpingDivisor", "0.001"}},
        Mistake{"short_list",
                k_dunes,
                [](Json& j) {
                    j["windWarpingRadii"] = Json::array({200.0, 50.0});
                },
                {"windWarpingRadii", "list of 4", "list of 2"}},
        Mistake{"number_for_list", k_dunes, [](Json& j) { j["stickyRange"] = 2; }, {"stickyRange", "list of 2"}},
        Mistake{"bad_element",
                k_dunes,
                [](Json& j) {
                    j["gridSize"] = Json::array({128, 0});
                },
                {"gridSize[1]", "1 to"}},
        Mistake{"unused_radius", k_dunes, [](Json& j) { j["windWarpingCount"] = 3; }, {"windWarpingRadii[2]", "1 to"}},
        Mistake{"weights_0",
                k_dunes,
                [](Json& j) {
                    j["windWarpingStrengths"] = Json::array({0.0, 0.0, 1.0, 1.0});
                },
                {"windWarpingStrengths", "add up to 0"}},
        Mistake{"shadow_angles",
                k_dunes,
                [](Json& j) { j["maxWindShadowAngle"] = 10.0; },
                {"maxWindShadowAngle", "minWindShadowAngle"}},
        Mistake{"sticky_order",
                k_dunes,
                [](Json& j) {
                    j["stickyRange"] = Json::array({2.0, 0.4});
                },
                {"stickyRange"}},
        Mistake{"step_0",
                k_dunes,
                [](Json& j) {
                    j["timeScale"] = 0.001;
                    j["fixedDeltaTime"] = 0.5;
                },
                {"fixedDeltaTime", "timeScale"}},
        Mistake{"rate_too_high", k_dunes, [](Json& j) { j["fixedDeltaTime"] = 0.01; }, {"sand.lift_rate", "10"}},
        Mistake{"layer_iterations",
                k_dunes,
                [](Json& j) { j["initializationParameters"]["Sand"]["iterations"] = 51; },
                {"initializationParameters.Sand.iterations", "0 to 50"}},
        Mistake{"layer_too_high",
                k_dunes,
                [](Json& j) {
                    j["initializationParameters"]["Bedrock"]["scale"] = 9000;
                    j["initializationParameters"]["Bedrock"]["bias"] = 9000;
                },
                {"initializationParameters.Bedrock", "12000"}},
        Mistake{"layer_no_object",
                k_dunes,
                [](Json& j) { j["initializationParameters"]["Sand"] = 3; },
                {"initializationParameters.Sand", "object"}},
        Mistake{"species_count", k_oasis, [](Json& j) { j["vegTypeCount"] = 3; }, {"vegTypeCount", "2 species"}},
        Mistake{"species_long",
                k_oasis,
                [](Json& j) { j["vegTypes"][0]["arr"].push_back(1.0); },
                {"vegTypes[0].arr", "30"}},
        Mistake{"species_range",
                k_oasis,
                [](Json& j) { j["vegTypes"][1]["arr"][0] = 21.0; },
                {"vegTypes[1].arr[0] (maxRadius)", "20"}},
        Mistake{"species_light",
                k_oasis,
                [](Json& j) { j["vegTypes"][0]["arr"][27] = j["vegTypes"][0]["arr"][26]; },
                {"vegTypes[0].arr[26]", "differ"}},
        Mistake{"species_dominance",
                k_oasis,
                [](Json& j) { j["vegTypes"][0]["dominance"][1] = -1.0; },
                {"vegTypes[0].dominance[1]"}},
        Mistake{"species_unknown", k_oasis, [](Json& j) { j["vegTypes"][0]["size"] = 1.0; }, {"vegTypes[0].size"}},
        Mistake{"species_no_numbers", k_oasis, [](Json& j) { j["vegTypes"][0].erase("arr"); }, {"arr"}}),
    [](const auto& mistake) { return std::string(mistake.param.name); });

TEST(SceneFile, WhatDiffersIsSaid) {
    Json json = scene_json("scene_dunes.json");
    json["saltationMode"] = "Sideways";
    json["avalancheMode"] = "Multigrid";
    json["windWarpingCount"] = 0;
    json["constantCoverage"] = true;
    json["timeMode"] = "Delta Time";
    json["projectionMode"] = 1;
    json["windSped"] = 4.0;
    json["initializationParameters"]["Fog"] = 1;
    const auto scene = parse_scene(json.dump(), "x");
    ASSERT_TRUE(scene.ok()) << scene.error().message;
    for (const char* part : {"\"Sideways\": Forward", "Multigrid", "windWarpingCount 0", "inactive", "Delta Time",
                             "Jacobi", "'windSped'", "'initializationParameters.Fog'"})
        EXPECT_TRUE(has_note(*scene, part)) << part;
    EXPECT_FALSE(scene->wind.warp);
    EXPECT_FALSE(scene->sand.supply);
    json["calcCoverage"] = true;
    const auto supplied = parse_scene(json.dump(), "x");
    ASSERT_TRUE(supplied.ok());
    EXPECT_TRUE(supplied->sand.supply);
}

TEST(SceneFile, WhatIsNoSceneIsRefused) {
    EXPECT_EQ(load_scene("/nonexistent.json").error().kind, ErrorKind::not_found);
    EXPECT_EQ(load_scene(SAHEL_SOURCE_DIR).error().kind, ErrorKind::usage);
    for (const char* text : {"", "{", "[1, 2]", "3", "null", "{\"windSpeed\": 1, \"windSpeed\": 2}", "{\"a\": 1e999}"})
        EXPECT_FALSE(parse_scene(text, "x").ok()) << text;
}

/// Texts that are a few bytes away from a scene: read or refused in one line, never more.
TEST(SceneFile, DamagedTextsNeverDoHarm) {
    int read = 0;
    int refused = 0;
    for (const char* name : {"scene_dunes.json", "scene_dunes_2023.json", "scene_oasis.json"}) {
        const auto text = read_text_file(scene_data(name));
        ASSERT_TRUE(text.ok());
        for (uint32_t trial = 0; trial < 1500; ++trial) {
            std::string damaged = *text;
            const Random4 r = philox(trial, static_cast<uint32_t>(text->size()), 0, 0, 1, 2);
            const auto at = [&](uint32_t word) { return static_cast<size_t>(word) % damaged.size(); };
            switch (trial % 5) {
            case 0: // a flipped bit
                damaged[at(r.v[0])] = static_cast<char>(damaged[at(r.v[0])] ^ (1 << (r.v[1] % 8)));
                break;
            case 1: // cut short
                damaged.resize(at(r.v[0]));
                break;
            case 2: { // a piece lost
                const size_t from = at(r.v[0]);
                damaged.erase(from, r.v[1] % 64);
                break;
            }
            case 3: { // a piece twice
                const size_t from = at(r.v[0]);
                damaged.insert(at(r.v[1]), text->substr(from, r.v[2] % 64));
                break;
            }
            default: { // a digit or a sign where another stood: mostly JSON still
                const size_t digit = damaged.find_first_of("0123456789", at(r.v[0]));
                if (digit != std::string::npos) damaged[digit] = "0123456789-e"[r.v[1] % 12];
            }
            }
            const auto scene = parse_scene(damaged, name);
            if (scene.ok()) {
                ++read;
                EXPECT_TRUE(check_ranges(scene->wind, name).ok() && check_ranges(scene->sand, name).ok());
            } else {
                ++refused;
                EXPECT_EQ(scene.error().message.find('\n'), std::string::npos) << scene.error().message;
            }
        }
    }
    EXPECT_GT(read, 100);
    EXPECT_GT(refused, 1000);
}

TEST(PublishedScenes, AllAreRead) {
    int count = 0;
    for (const char* folder : {"scenes-dunes", "scenes-dunes/2023", "scenes-oasis"}) {
        const auto path = published_scenes(folder);
        if (path.empty()) GTEST_SKIP() << "the published scenes are not here: " << folder;
        for (const auto& entry : std::filesystem::directory_iterator(path)) {
            if (entry.path().extension() != ".json") continue;
            const auto scene = load_scene(entry.path());
            ASSERT_TRUE(scene.ok()) << scene.error().message;
            ++count;
            EXPECT_FALSE(has_note(*scene, "is unknown")) << entry.path();
            if (std::string(folder) == "scenes-dunes/2023") {
                EXPECT_EQ(scene->format, SceneFormat::dunes_2023);
            }
            if (std::string(folder) == "scenes-oasis") {
                EXPECT_EQ(scene->format, SceneFormat::oasis);
                EXPECT_GE(scene->species.size(), 3u);
            }
        }
    }
    EXPECT_EQ(count, 36 + 21 + 15);
}

/// Some rows of the table of all scenes (Desertscape method 4.5).
TEST(PublishedScenes, HaveTheValuesOfTheTable) {
    const auto path = published_scenes("scenes-dunes");
    if (path.empty()) GTEST_SKIP() << "the published scenes are not here";
    const auto read = [&](const char* name) {
        auto scene = load_scene(path / name);
        SAHEL_CHECK(scene.ok());
        return *std::move(scene);
    };
    int old = 0;
    for (const auto& entry : std::filesystem::directory_iterator(path))
        if (entry.path().extension() == ".json")
            old += read(entry.path().filename().c_str()).format == SceneFormat::dunes_2023;
    EXPECT_EQ(old, 7); // those that are still of 2023

    const Scene a = read("A_4k.json");
    EXPECT_EQ(a.cell_m, 0.25);
    EXPECT_EQ(a.sand.avalanche_sweeps, 100);
    EXPECT_EQ(a.sand.reptation_repose_s2_per_m2, 0.05f);
    EXPECT_NEAR(a.sand.reptation_smooth_wind_s_per_m * 5.0f / 0.6f, 0.8f * 0.25f, 1e-5f);
    EXPECT_TRUE(a.layers.sand.uniform);
    const Scene star = read("star.json");
    EXPECT_TRUE(star.wind.project); // the key is absent: a fresh program projects
    EXPECT_TRUE(star.wind.bidirectional);
    EXPECT_EQ(star.wind.ratio, 1.0f);
    EXPECT_EQ(star.wind.period_s, 30.0f);
    EXPECT_FALSE(star.sand.supply);
    EXPECT_TRUE(read("bidir_22_105.json").sand.supply_removes);
    EXPECT_TRUE(read("bidir_7_45.json").sand.supply);
    const Scene echo = read("bilinear_nearest_test_echo_dune.json");
    EXPECT_EQ(echo.format, SceneFormat::dunes_2023);
    EXPECT_EQ(echo.wind.angle_deg, 31.0f);
    EXPECT_FALSE(echo.wind.warp);
    EXPECT_EQ(echo.sand.echo_max_cliff_m, 50.0f);
    EXPECT_NEAR(echo.sand.reptation_smooth / 0.6f, 0.8f * static_cast<float>(echo.cell_m), 1e-5f); // of 1
    const Scene abrasion = read("abrasion.json");
    EXPECT_EQ(abrasion.sand.abrasion, 0.01f);
    EXPECT_FALSE(abrasion.sand.bedrock_to_sand);
    EXPECT_EQ(abrasion.layers.bedrock.iterations, 8);
    EXPECT_EQ(read("strongVenturiDivergence.json").wind.venturi_per_m, 0.08f);
    EXPECT_FLOAT_EQ(read("extremeWindWarping.json").wind.warp_gain, 100.0f);
}

} // namespace
} // namespace sahel::test
