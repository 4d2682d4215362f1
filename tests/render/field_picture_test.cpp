#include "render/field_picture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

namespace sahel {
namespace {

double brightness(const Image& image, int x0, int y0, int x1, int y1) {
    double sum = 0.0;
    for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x) sum += image.at(x, y)[0] + image.at(x, y)[1] + image.at(x, y)[2];
    return sum / (3.0 * (x1 - x0) * (y1 - y0));
}

/// A ridge along y, 10 m high, flanks at slope 0.5, in the middle of 128 x 128 cells of sand.
struct Ridge {
    std::vector<float> bedrock = std::vector<float>(128 * 128, 0.0f);
    std::vector<float> sand = std::vector<float>(128 * 128);
    GroundFields fields;
    Ridge() {
        for (int y = 0; y < 128; ++y)
            for (int x = 0; x < 128; ++x)
                sand[static_cast<size_t>(y * 128 + x)] =
                    2.0f + std::max(0.0f, 10.0f - 0.5f * std::abs(static_cast<float>(x) - 64.0f));
        fields.width = fields.height = 128;
        fields.bedrock_m = bedrock;
        fields.sand_m = sand;
    }
};

TEST(GroundPicture, TheSideOfTheSunIsLit) {
    const Ridge ridge;
    SunLight sun;
    sun.exaggeration = 1.0f;
    const Image image = make_ground_picture(ridge.fields, {}, sun, 128);
    ASSERT_EQ(image.width_px, 128);
    const double facing = brightness(image, 50, 20, 60, 100); // the west flank
    const double away = brightness(image, 68, 20, 78, 100);
    const double flat = brightness(image, 2, 20, 20, 100);
    EXPECT_GT(facing, flat + 10);
    EXPECT_LT(away, flat - 20);
    sun.azimuth_deg = 90.0f;
    const Image east = make_ground_picture(ridge.fields, {}, sun, 128);
    EXPECT_GT(brightness(east, 68, 20, 78, 100), brightness(east, 50, 20, 60, 100) + 20);
    // No seam where the period closes.
    EXPECT_NEAR(brightness(image, 0, 20, 2, 100), brightness(image, 126, 20, 128, 100), 3.0);
}

TEST(GroundPicture, WallsThrowShadows) {
    Ridge wall;
    for (int y = 0; y < 128; ++y)
        for (int x = 0; x < 128; ++x) wall.sand[static_cast<size_t>(y * 128 + x)] = x >= 60 && x < 68 ? 12.0f : 2.0f;
    SunLight sun;
    sun.exaggeration = 1.0f;
    const Image image = make_ground_picture(wall.fields, {}, sun, 128);
    // 10 m high, the sun at 28 degrees: 18.8 m long towards the south-east, 13 to the east.
    const double flat = brightness(image, 100, 20, 120, 100);
    EXPECT_LT(brightness(image, 70, 20, 78, 100), flat - 40);
    EXPECT_NEAR(brightness(image, 90, 20, 96, 100), flat, 12.0);
    EXPECT_NEAR(brightness(image, 30, 20, 50, 100), flat, 12.0);
}

TEST(GroundPicture, ColoursFollowTheRules) {
    Ridge ridge;
    std::fill(ridge.sand.begin(), ridge.sand.end(), 1.0f);
    SunLight sun;
    sun.exaggeration = 1.0f;
    std::vector<float> plants(128 * 128, 0.0f), hard(128 * 128, 0.0f), echo(128 * 128, 0.0f), shadow(128 * 128, 1.0f);
    std::vector<uint8_t> object(128 * 128, 0);
    const auto at = [](int x, int y) { return static_cast<size_t>(y * 128 + x); };
    for (int y = 0; y < 128; ++y)
        for (int x = 0; x < 128; ++x) {
            if (x < 32) ridge.bedrock[at(x, y)] = 1.0f; // level ground all over
            if (x < 32) ridge.sand[at(x, y)] = 0.0f;
            if (x < 16) hard[at(x, y)] = 1.0f;
            if (x >= 64 && x < 80) plants[at(x, y)] = 1.0f;
            if (x >= 80 && x < 96) object[at(x, y)] = 1;
            if (x >= 96 && x < 112) echo[at(x, y)] = -1.0f;
        }
    ridge.fields.vegetation = plants;
    ridge.fields.resistance = hard;
    ridge.fields.object = object;
    ridge.fields.echo = echo;
    ridge.fields.wind_shadow = shadow;
    GroundColours colours;
    const Image plain = make_ground_picture(ridge.fields, colours, sun, 128);
    const auto pixel = [&](const Image& image, int x) { return image.at(x, 64); };
    EXPECT_GT(pixel(plain, 48)[0], pixel(plain, 48)[2] + 30);                            // sand is yellow
    EXPECT_NEAR(pixel(plain, 24)[0], pixel(plain, 24)[2], 30);                           // rock is grey
    EXPECT_LT(brightness(plain, 4, 4, 12, 124), brightness(plain, 20, 4, 28, 124) - 20); // hard rock is dark
    EXPECT_GT(pixel(plain, 72)[1], pixel(plain, 72)[0] + 30);                            // plants are green
    EXPECT_GT(pixel(plain, 88)[2], pixel(plain, 88)[1] + 30);                            // objects are purple
    EXPECT_EQ(std::vector<uint8_t>(pixel(plain, 100), pixel(plain, 100) + 3),
              std::vector<uint8_t>(pixel(plain, 120), pixel(plain, 120) + 3)); // overlays are off
    colours.erosion[3] = 1.0f;
    colours.shadow[3] = 1.0f;
    const Image overlaid = make_ground_picture(ridge.fields, colours, sun, 128);
    EXPECT_GT(pixel(overlaid, 104)[2], pixel(overlaid, 120)[2] + 15);
    EXPECT_LT(pixel(overlaid, 120)[1], pixel(plain, 120)[1] - 15); // shadow is red
}

TEST(FieldPicture, LightnessGrowsWithTheValue) {
    for (const FieldPalette palette : {FieldPalette::viridis, FieldPalette::sand}) {
        double before = -1.0;
        for (int i = 0; i <= 50; ++i) {
            const auto c = palette_colour(palette, static_cast<float>(i) / 50.0f);
            const double lightness = 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
            EXPECT_GT(lightness, before - 0.5);
            before = lightness;
        }
    }
    EXPECT_EQ(palette_colour(FieldPalette::viridis, -3.0f), palette_colour(FieldPalette::viridis, 0.0f));
    EXPECT_EQ(palette_colour(FieldPalette::viridis, 7.0f), (std::array<uint8_t, 3>{253, 231, 37}));
}

TEST(FieldPicture, SizesRangesAndUnknownValues) {
    std::vector<float> field(64 * 32);
    std::iota(field.begin(), field.end(), 0.0f);
    field[0] = std::nanf("");
    FieldPictureOptions o{.title = "sand", .unit = "m"};
    o.bar = false;
    o.least_side_px = 200;
    const Image image = make_field_picture(field, 64, 32, o);
    EXPECT_EQ(image.width_px, 256); // the least whole factor: 4
    EXPECT_EQ(image.height_px, 128);
    EXPECT_EQ(image.at(1, 1)[0], 128);
    EXPECT_EQ(image.at(1, 1)[2], 128);
    o.low = 0.0f;
    o.high = 1.0f;
    const Image bright = make_field_picture(field, 64, 32, o);
    EXPECT_EQ(bright.at(100, 100)[0], 253);
    o.bar = true;
    const Image barred = make_field_picture(field, 64, 32, o);
    EXPECT_EQ(barred.width_px, image.width_px);
    EXPECT_GT(barred.height_px, image.height_px + 20);
    // Constant fields and fields of nothing known have a picture too.
    EXPECT_EQ(make_field_picture(std::vector<float>(64, 3.0f), 8, 8).width_px, 512);
    EXPECT_EQ(make_field_picture(std::vector<float>(64, std::nanf("")), 8, 8).width_px, 512);
}

TEST(FieldPicture, ArrowsPointAlongTheWind) {
    const std::vector<float> x(128 * 128, 4.0f), none(128 * 128, 0.0f);
    FieldPictureOptions o;
    o.bar = false;
    o.low = 0.0f;
    o.high = 8.0f;
    const Image calm = make_wind_picture(none, none, 128, 128, o);
    const Image wind = make_wind_picture(x, none, 128, 128, o);
    const Image plain = make_field_picture(x, 128, 128, o);
    int changed = 0;
    int widest = 0;
    int tallest = 0;
    for (int i = 0; i < 512; ++i) {
        int in_row = 0;
        int in_column = 0;
        for (int j = 0; j < 512; ++j) {
            in_row += wind.at(j, i)[0] != plain.at(j, i)[0];
            in_column += wind.at(i, j)[0] != plain.at(i, j)[0];
        }
        changed += in_row;
        widest = std::max(widest, in_row);
        tallest = std::max(tallest, in_column);
    }
    EXPECT_GT(changed, 1000);
    EXPECT_GT(widest, tallest); // shafts lie along x
    EXPECT_EQ(calm.pixels, make_field_picture(none, 128, 128, o).pixels);
}

} // namespace
} // namespace sahel
