#include "render/contact_sheet.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace sahel {
namespace {

Image plain(int width, int height, PixelColour colour, int channels = 4) {
    Image image(width, height, channels);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) std::copy_n(colour.data(), channels, image.at(x, y));
    return image;
}

TEST(ContactSheet, PicturesKeepTheirShapeAndColour) {
    const Image red = plain(320, 180, {200, 30, 20, 255});
    const Image blue = plain(400, 400, {10, 40, 220, 255}, 3);
    const Image green = plain(64, 36, {20, 180, 40, 255});
    ContactSheetOptions o;
    o.cell_width_px = 160;
    o.gap_px = 10;
    const auto sheet = make_contact_sheet({{&red, "red"}, {&blue, "blue"}, {&green, "green"}}, o);
    ASSERT_TRUE(sheet.ok()) << sheet.error().message;
    EXPECT_EQ(sheet->width_px, 10 + 2 * 170);
    const auto near = [&](int x, int y, PixelColour want) {
        for (size_t c = 0; c < 4; ++c) EXPECT_NEAR(sheet->at(x, y)[c], want[c], 1) << x << ", " << y;
    };
    near(12, 12, {200, 30, 20, 255});
    near(168, 98, {200, 30, 20, 255});
    near(12, 10 + 150, o.paper); // below the first picture, beside the square one
    near(182, 12, {10, 40, 220, 255});
    near(338, 168, {10, 40, 220, 255});
    // The third stands in the second row.
    int top = 0;
    for (int y = 170; y < sheet->height_px && top == 0; ++y)
        if (sheet->at(12, y)[1] > 150 && sheet->at(12, y)[0] < 60) top = y;
    EXPECT_GT(top, 170);
    near(12, top + 80, {20, 180, 40, 255});
}

TEST(ContactSheet, CaptionsAreWritten) {
    const Image grey = plain(64, 36, {90, 90, 90, 255});
    ContactSheetOptions o;
    o.cell_width_px = 320;
    o.columns = 1;
    const auto with = make_contact_sheet({{&grey, "Dunes at evening"}}, o);
    const auto without = make_contact_sheet({{&grey, ""}}, o);
    ASSERT_TRUE(with.ok() && without.ok());
    ASSERT_EQ(with->pixels.size(), without->pixels.size());
    size_t changed = 0;
    for (size_t i = 0; i < with->pixels.size(); i += 4) changed += with->pixels[i] != without->pixels[i];
    EXPECT_GT(changed, 150u);
    for (int y = 0; y < o.gap_px + 180; ++y) // not on the picture
        for (int x = 0; x < with->width_px; ++x) ASSERT_EQ(with->at(x, y)[0], without->at(x, y)[0]);
}

TEST(ContactSheet, LongCaptionsTakeLinesOfTheirOwn) {
    const Image grey = plain(64, 36, {90, 90, 90, 255});
    ContactSheetOptions o;
    o.cell_width_px = 160;
    o.columns = 1;
    const auto height = [&](const std::string& caption) {
        const auto sheet = make_contact_sheet({{&grey, caption}}, o);
        EXPECT_TRUE(sheet.ok());
        return sheet->height_px;
    };
    const int line = TextPainter(12.0f).line_px();
    const int one = height("short");
    EXPECT_EQ(height(""), one);
    EXPECT_EQ(height("first\nsecond"), one + line);
    EXPECT_EQ(height("first\nsecond\nthird"), one + 2 * line);
    EXPECT_GE(height("many words that together are much wider than the picture above them is"), one + 2 * line);
}

TEST(ContactSheet, TextStaysInsideThePicture) {
    Image small(20, 8, 4);
    const TextPainter text(16.0f);
    text.draw(small, -5, -4, "W\xc3\xa4ste \xe2\x9c\x93 and a long line", {255, 255, 255, 255});
    EXPECT_GT(text.width_px("wide"), text.width_px("w"));
    EXPECT_GE(text.line_px(), 12);
}

TEST(ContactSheet, ShrinkingAveragesLight) {
    Image checker(8, 8, 3);
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x) std::fill_n(checker.at(x, y), 3, static_cast<uint8_t>((x + y) % 2 ? 255 : 0));
    const Image small = shrink_image(checker, 2, 2);
    EXPECT_EQ(small.at(0, 0)[0], 188); // half the light of white, as sRGB
    EXPECT_EQ(small.at(1, 1)[2], 188);
    EXPECT_EQ(shrink_image(checker, 8, 8).pixels, checker.pixels);
}

TEST(ContactSheet, NothingToShowIsAnError) {
    EXPECT_EQ(make_contact_sheet({}).error().kind, ErrorKind::usage);
    const Image none;
    EXPECT_EQ(make_contact_sheet({{&none, "none"}}).error().kind, ErrorKind::usage);
}

} // namespace
} // namespace sahel
