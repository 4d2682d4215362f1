#include "tests/streaming/scene_support.h"

#include "streaming/scene_ground.h"
#include "streaming/scene_terrain.h"
#include "world/exr_image.h"

#include <algorithm>
#include <cmath>

namespace sahel::test {
namespace {

TEST(SceneTerrain, HashAgreesWithAnOrdinarySine) {
    for (int i = 0; i < 2000; ++i) {
        const auto x = static_cast<float>(i % 50) * 0.02f;
        const auto y = static_cast<float>(i / 50) * 0.025f;
        const double s = 43758.5453 * std::sin(static_cast<double>(12.9898f * x + 78.233f * y));
        const double exact = s - std::floor(s);
        double difference = std::abs(scene_hash(x, y) - exact);
        difference = std::min(difference, 1.0 - difference); // on the circle
        EXPECT_LT(difference, 0.02) << x << " " << y;        // half an ulp of the sine, 43758 times
    }
    EXPECT_EQ(scene_hash(0.0f, 0.0f), 0.0f);
}

TEST(SceneTerrain, WhiteNoiseHasTheMomentsOfUniformNumbers) {
    SceneNoise noise;
    noise.uniform = true;
    noise.scale = 10.0f;
    noise.bias = 5.0f;
    const auto values = scene_layer(noise, SceneWindow::whole(512, 256));
    double sum = 0.0;
    double squares = 0.0;
    for (const float v : values) {
        EXPECT_TRUE(v >= 5.0f && v <= 15.0f);
        sum += v;
        squares += static_cast<double>(v) * v;
    }
    const auto n = static_cast<double>(values.size());
    const double mean = sum / n;
    EXPECT_NEAR(mean, 10.0, 0.05);
    EXPECT_NEAR(std::sqrt(squares / n - mean * mean), 10.0 / std::sqrt(12.0), 0.05);
}

TEST(SceneTerrain, NoiseMeetsItsLattice) {
    for (int y = 0; y < 5; ++y)
        for (int x = 0; x < 5; ++x) {
            const auto fx = static_cast<float>(x);
            const auto fy = static_cast<float>(y);
            EXPECT_EQ(scene_value_noise(fx / 4.0f, fy / 4.0f, 4.0f), scene_hash(fx, fy));
            // Half way between four points it is their mean.
            const float mean = 0.25f * (scene_hash(fx, fy) + scene_hash(fx + 1, fy) + scene_hash(fx, fy + 1) +
                                        scene_hash(fx + 1, fy + 1));
            EXPECT_NEAR(scene_value_noise((fx + 0.5f) / 4.0f, (fy + 0.5f) / 4.0f, 4.0f), mean, 1e-6f);
        }
    // One octave: the fourth power of the noise.
    const float v = scene_value_noise(0.3f, 0.7f, 4.0f);
    EXPECT_FLOAT_EQ(scene_fractal(0.3f, 0.7f, 0), v * v * v * v);
    const float w = (v + 0.5f * scene_value_noise(0.3f, 0.7f, 8.0f)) / 1.5f;
    EXPECT_FLOAT_EQ(scene_fractal(0.3f, 0.7f, 1), w * w * w * w);
    EXPECT_TRUE(std::isfinite(scene_fractal(0.3f, 0.7f, 50)));
}

TEST(SceneTerrain, HillsMeetAcrossTheSeam) {
    SceneNoise noise;
    noise.flat = false;
    noise.iterations = 2;
    for (const SceneWindow w : {SceneWindow::whole(256, 192), SceneWindow{2048, 1024, 300, 500, 256, 192}}) {
        float largest_step = 0.0f;
        float seam = 0.0f;
        for (int y = 0; y < w.height; ++y)
            for (int x = 0; x < w.width; ++x) {
                const float here = scene_hills(noise, w, x, y);
                EXPECT_TRUE(here >= 0.0f && here <= 1.0f);
                const float next = std::abs(scene_hills(noise, w, (x + 1) % w.width, y) - here);
                const float below = std::abs(scene_hills(noise, w, x, (y + 1) % w.height) - here);
                (x + 1 == w.width ? seam : largest_step) = std::max(x + 1 == w.width ? seam : largest_step, next);
                (y + 1 == w.height ? seam : largest_step) = std::max(y + 1 == w.height ? seam : largest_step, below);
            }
        EXPECT_LE(seam, largest_step);
    }
    // Inside the frame the image is not blended; without a frame it is nowhere.
    const SceneWindow whole = SceneWindow::whole(100, 100);
    EXPECT_EQ(scene_hills(noise, whole, 50, 40), scene_fractal(0.505f, 0.405f, 2));
    noise.border = {0.0f, 0.0f};
    EXPECT_EQ(scene_hills(noise, whole, 0, 99), scene_fractal(0.005f, 0.995f, 2));
}

TEST(SceneTerrain, LayersOfEachKind) {
    const SceneWindow w = SceneWindow::whole(64, 64);
    SceneNoise noise;
    noise.bias = 3.0f;
    EXPECT_EQ(scene_layer(noise, w), std::vector<float>(64 * 64, 3.0f));
    noise.enable = false;
    EXPECT_EQ(scene_layer(noise, w), std::vector<float>(64 * 64, 0.0f));
    noise.enable = noise.uniform = true; // uniform wins over flat
    const auto random = scene_layer(noise, w);
    EXPECT_NE(random[0], random[1]);
    noise.uniform = noise.flat = false;
    const auto hills = scene_layer(noise, w);
    EXPECT_EQ(hills[65], 3.0f + scene_hills(noise, w, 1, 1));
}

TEST(SceneTerrain, AWindowStandsForTheWhole) {
    SceneNoise sand;
    sand.flat = false;
    sand.scale = 100.0f;
    sand.bias = -5.0f;
    const SceneWindow w = representative_window(2048, 2048, 256, 256, {{sand, 0.0f}});
    EXPECT_EQ(w.width, 256);
    EXPECT_TRUE(w.x0 >= 0 && w.y0 >= 0 && w.x0 + w.width <= 2048 && w.y0 + w.height <= 2048);
    const auto mean = [&](const SceneWindow& window) {
        double sum = 0.0;
        for (const float v : scene_layer(sand, window)) sum += std::max(v, 0.0f);
        return sum / static_cast<double>(window.cells());
    };
    const double whole = mean(SceneWindow::whole(512, 512)); // hills are a function of uv: fewer samples, same hills
    EXPECT_NEAR(mean(w), whole, 0.35 * whole);
    EXPECT_EQ(representative_window(512, 512, 512, 512, {{sand, 0.0f}}), SceneWindow::whole(512, 512));
}

TEST(SceneGround, DunesAndOasisStartAsDescribed) {
    const auto dunes = load_scene(scene_data("scene_dunes.json"));
    ASSERT_TRUE(dunes.ok());
    const auto d = make_scene_ground(*dunes);
    ASSERT_TRUE(d.ok()) << d.error().message;
    EXPECT_EQ(d->width, 128);
    EXPECT_EQ(d->height, 64);
    EXPECT_TRUE(std::all_of(d->sand_m.begin(), d->sand_m.end(), [](float s) { return s >= 0.5f && s <= 2.0f; }));
    EXPECT_TRUE(std::all_of(d->bedrock_m.begin(), d->bedrock_m.end(), [](float b) { return b == 0.0f; }));
    EXPECT_EQ(d->object, std::vector<uint8_t>(128 * 64, 0));

    const auto oasis = load_scene(scene_data("scene_oasis.json"));
    ASSERT_TRUE(oasis.ok());
    const auto o = make_scene_ground(*oasis);
    ASSERT_TRUE(o.ok()) << o.error().message;
    int wet = 0;
    for (size_t i = 0; i < o->cells(); ++i) {
        EXPECT_EQ(o->soil_m[i], 10.0f);
        EXPECT_EQ(o->sand_m[i], 1.0f);
        EXPECT_FLOAT_EQ(o->moisture_m[i], 0.3f);
        const float ground = o->bedrock_m[i] + 11.0f;
        EXPECT_NEAR(o->water_m[i], std::max(20.0f - ground, 0.0f), 1e-4f); // a level, not a depth
        wet += o->water_m[i] > 0.0f;
    }
    EXPECT_GT(wet, 0);

    const auto half = make_scene_ground(*dunes, {.size = 64});
    ASSERT_FALSE(half.ok()); // 64 x 32: the shorter side is too short
    EXPECT_EQ(half.error().kind, ErrorKind::usage);
    const auto larger = make_scene_ground(*dunes, {.size = 256});
    ASSERT_TRUE(larger.ok()) << larger.error().message;
    EXPECT_EQ(larger->height, 128);
    EXPECT_EQ(make_scene_ground(*dunes, {.size = 100}).error().kind, ErrorKind::usage);
}

/// A scene with maps of the given sizes, in a folder of its own.
class SceneMaps : public testing::Test {
  protected:
    void write(const ExrImage* terrain, const ExrImage* resistance) {
        Json json = scene_json("scene_dunes.json");
        json["exportMaps"] = true;
        json["gridSize"] = Json::array({256, 256});
        ASSERT_TRUE(write_file(file(), json.dump()).ok());
        if (terrain) {
            ASSERT_TRUE(write_exr_image(file().string() + ".terrain.exr", *terrain).ok());
        }
        if (resistance) {
            ASSERT_TRUE(write_exr_image(file().string() + ".resistance.exr", *resistance).ok());
        }
    }
    static ExrImage planes(int width, int height, std::initializer_list<const char*> names) {
        ExrImage image{width, height, {}};
        float start = 0.0f;
        for (const char* name : names) {
            image.planes.push_back({name, {}});
            for (int i = 0; i < width * height; ++i)
                image.planes.back().values.push_back(start + 0.001f * static_cast<float>(i));
            start += 100.0f;
        }
        return image;
    }
    [[nodiscard]] std::filesystem::path file() const { return folder_.path() / "mapped.json"; }
    [[nodiscard]] Result<SceneGround> ground(const SceneGroundOptions& options = {}) const {
        auto scene = load_scene(file());
        if (!scene.ok()) return scene.error();
        return make_scene_ground(*scene, options);
    }
    TemporaryFolder folder_;
};

TEST_F(SceneMaps, TakeTheirPlacesWithoutFlip) {
    ExrImage terrain = planes(128, 64, {"G", "R", "A", "B"}); // any order of channels
    ExrImage resistance = planes(128, 64, {"A", "B", "G", "R"});
    for (float& v : resistance.planes[1].values) v = 0.5f;
    for (float& v : resistance.planes[2].values) v = 0.0f;
    resistance.planes[2].values[3 * 128 + 7] = -1.0f;
    resistance.planes[2].values[3 * 128 + 8] = 0.75f;
    write(&terrain, &resistance);
    const auto g = ground();
    ASSERT_TRUE(g.ok()) << g.error().message;
    EXPECT_EQ(g->width, 128); // the maps count, not gridSize
    EXPECT_EQ(g->height, 64);
    EXPECT_EQ(g->sand_m[5 * 128 + 9], terrain.planes[0].values[5 * 128 + 9]);
    EXPECT_EQ(g->bedrock_m[5 * 128 + 9], terrain.planes[1].values[5 * 128 + 9]);
    EXPECT_EQ(g->object[3 * 128 + 7], 1);
    EXPECT_EQ(g->object[3 * 128 + 8], 0);
    EXPECT_EQ(g->vegetation[3 * 128 + 7], 0.0f);
    EXPECT_EQ(g->vegetation[3 * 128 + 8], 0.75f);
    EXPECT_EQ(g->resistance[0], 0.5f);
    EXPECT_TRUE(g->echo.empty());
    const auto sticky = ground({.keep_sticky = true});
    ASSERT_TRUE(sticky.ok());
    EXPECT_EQ(sticky->echo[1], resistance.planes[0].values[1]);
    // Twice as large: every cell of the map becomes four.
    const auto twice = ground({.size = 256});
    ASSERT_TRUE(twice.ok()) << twice.error().message;
    EXPECT_EQ(twice->height, 128);
    EXPECT_EQ(twice->bedrock_m[11 * 256 + 19], g->bedrock_m[5 * 128 + 9]);
}

TEST_F(SceneMaps, MissingOrBrokenOnesAreNamed) {
    write(nullptr, nullptr);
    auto g = ground();
    ASSERT_TRUE(g.ok()) << g.error().message;
    EXPECT_FALSE(g->mapped);
    ASSERT_FALSE(g->notes.empty());
    EXPECT_NE(g->notes.back().find("mapped.json.terrain.exr is missing"), std::string::npos);

    const ExrImage small = planes(128, 128, {"G", "R"});
    const ExrImage other = planes(128, 64, {"G", "B"});
    write(&small, &other);
    g = ground();
    ASSERT_FALSE(g.ok());
    EXPECT_EQ(g.error().kind, ErrorKind::corrupt);
    EXPECT_NE(g.error().message.find("128 x 64"), std::string::npos) << g.error().message;

    const ExrImage lacking = planes(128, 128, {"R"});
    write(&lacking, nullptr);
    std::filesystem::remove(file().string() + ".resistance.exr");
    EXPECT_NE(ground().error().message.find("no channel G"), std::string::npos);

    for (const float bad : {-1.0f, std::nanf(""), 1.0e9f}) {
        ExrImage wrong = planes(128, 128, {"G", "R"});
        wrong.planes[0].values[130] = bad;
        write(&wrong, nullptr);
        g = ground();
        ASSERT_FALSE(g.ok());
        EXPECT_EQ(g.error().kind, ErrorKind::corrupt);
        EXPECT_NE(g.error().message.find("(2, 1)"), std::string::npos) << g.error().message;
    }
    ASSERT_TRUE(write_file(file().string() + ".terrain.exr", "no picture").ok());
    EXPECT_EQ(ground().error().kind, ErrorKind::corrupt);
}

TEST(SceneGround, TheObstacleHasItsPublishedSize) {
    int rock = 0;
    int mask = 0;
    int x0 = 2048, x1 = 0, y0 = 512, y1 = 0;
    for (int y = 0; y < 512; ++y)
        for (int x = 0; x < 2048; ++x) {
            mask += scene_obstacle(2048, 512, x, y, 2);
            if (!scene_obstacle(2048, 512, x, y, 0)) continue;
            ++rock;
            x0 = std::min(x0, x);
            x1 = std::max(x1, x);
            y0 = std::min(y0, y);
            y1 = std::max(y1, y);
        }
    EXPECT_EQ(rock, 155590);
    EXPECT_EQ(mask, 158419);
    EXPECT_EQ(x0, 774);
    EXPECT_EQ(x1, 1323);
    EXPECT_EQ(y0, 106);
    EXPECT_EQ(y1, 406);
}

/// The stored sand of wind_tunnel is 10 + 10 H(uv) by the sine of a GPU (method 3.15: 91 % within 0.05 m).
TEST(PublishedScenes, WhiteNoiseIsThatOfTheStoredMap) {
    const auto path = published_scenes("scenes-dunes");
    if (path.empty()) GTEST_SKIP() << "the published scenes are not here";
    const auto scene = load_scene(path / "wind_tunnel.json");
    ASSERT_TRUE(scene.ok());
    const auto stored = make_scene_ground(*scene);
    ASSERT_TRUE(stored.ok()) << stored.error().message;
    const auto made = scene_layer(scene->layers.sand, SceneWindow::whole(2048, 512));
    int64_t outside = 0;
    int64_t close = 0;
    for (size_t i = 0; i < made.size(); ++i) {
        const auto x = static_cast<int>(i % 2048);
        const auto y = static_cast<int>(i / 2048);
        EXPECT_EQ(stored->bedrock_m[i], scene_obstacle(2048, 512, x, y, 0) ? 100.0f : 0.0f);
        if (stored->object[i]) continue;
        ++outside;
        float difference = std::abs(made[i] - stored->sand_m[i]);
        difference = std::min(difference, 10.0f - difference);
        close += difference <= 0.05f;
    }
    const double share = static_cast<double>(close) / static_cast<double>(outside);
    RecordProperty("share_within_5_cm", std::to_string(share));
    EXPECT_GT(share, 0.88);
}

TEST(PublishedScenes, MapsAreRead) {
    const auto path = published_scenes("scenes-dunes");
    if (path.empty()) GTEST_SKIP() << "the published scenes are not here";
    const auto ground = [&](const char* name, const SceneGroundOptions& options = {}) {
        auto scene = load_scene(path / name);
        SAHEL_CHECK(scene.ok());
        auto g = make_scene_ground(*scene, options);
        SAHEL_CHECK(g.ok());
        return *std::move(g);
    };
    const SceneGround column = ground("avalanching_test.json");
    double sum = 0.0;
    int high = 0;
    for (const float s : column.sand_m) {
        sum += s;
        high += s == 402.0f;
    }
    EXPECT_EQ(high, 199 * 199);
    EXPECT_EQ(sum, 24229008.0);
    for (const char* name : {"bilinear_nearest_test_wind_warping.json", "extremeWindWarping.json"}) {
        const SceneGround rebuilt = ground(name, {.size = 1024});
        EXPECT_TRUE(rebuilt.rebuilt) << name;
        EXPECT_NEAR(static_cast<double>(std::count(rebuilt.bedrock_m.begin(), rebuilt.bedrock_m.end(), 100.0f)),
                    155590.0 / 4, 300);
    }
    EXPECT_FALSE(ground("newReptationTest.json", {.size = 256}).notes.empty());
    const SceneGround plants = ground("vegetation.json", {.size = 1024, .keep_sticky = true});
    EXPECT_EQ(*std::max_element(plants.vegetation.begin(), plants.vegetation.end()), 1.0f);
    EXPECT_EQ(plants.echo[0], 1.0f);
    EXPECT_EQ(plants.sand_m[17], 50.0f);
}

} // namespace
} // namespace sahel::test
