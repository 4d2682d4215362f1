#include "render/png_io.h"

#include "world/file_io.h"
#include "world/random.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace sahel {
namespace {

namespace fs = std::filesystem;

class PngTest : public ::testing::Test {
  protected:
    PngTest() : folder_(fs::path(::testing::TempDir()) / ("png_io_" + std::to_string(::getpid()))) {
        fs::create_directories(folder_);
    }
    ~PngTest() override { fs::remove_all(folder_); }
    fs::path folder_;
};

template <class T> BasicImage<T> pattern(int width, int height, int channels) {
    BasicImage<T> image(width, height, channels);
    uint32_t state = 12345;
    for (T& p : image.pixels) {
        state = state * 1664525u + 1013904223u;
        p = static_cast<T>(state >> 16);
    }
    return image;
}

TEST_F(PngTest, PicturesComeBackAsTheyWere) {
    for (const int channels : {1, 3, 4})
        for (const int level : {k_png_level_fast, k_png_level_small}) {
            const Image image = pattern<uint8_t>(37, 23, channels);
            const fs::path file = folder_ / "sub" / "a.png";
            ASSERT_TRUE(write_png(file, image, {{"Title", "a test"}, {"camera", "{\"x\": 1}"}}, level).ok());
            auto back = read_png(file);
            ASSERT_TRUE(back.ok()) << back.error().message;
            EXPECT_EQ(back->image.width_px, 37);
            EXPECT_EQ(back->image.height_px, 23);
            EXPECT_EQ(back->image.channels, channels);
            EXPECT_EQ(back->image.pixels, image.pixels);
            EXPECT_EQ(back->text, (PngText{{"Title", "a test"}, {"camera", "{\"x\": 1}"}}));
        }
}

TEST_F(PngTest, SixteenBitsKeepTheirOrder) {
    Image16 image(2, 1, 3);
    image.pixels = {0x1234, 0xffff, 0, 0x8000, 0x00ff, 0xff00};
    const fs::path file = folder_ / "a.png";
    ASSERT_TRUE(write_png(file, image).ok());
    // Big-endian samples stand in the file; as 8 bits they are v / 257, rounded.
    auto back = read_png(file);
    ASSERT_TRUE(back.ok()) << back.error().message;
    EXPECT_EQ(back->image.pixels, (std::vector<uint8_t>{0x12, 0xff, 0, 0x80, 0x01, 0xfe}));
}

TEST_F(PngTest, ATruncatedFileIsRefusedAtEveryLength) {
    auto bytes = encode_png(pattern<uint8_t>(9, 7, 4));
    ASSERT_TRUE(bytes.ok());
    const fs::path file = folder_ / "short.png";
    // The last 12 bytes are the IEND chunk.
    for (size_t size = 0; size < bytes->size(); size += 5) {
        ASSERT_TRUE(write_file(file, std::span(bytes->data(), size)).ok());
        const auto back = read_png(file);
        ASSERT_FALSE(back.ok()) << size << " of " << bytes->size();
        EXPECT_EQ(back.error().kind, ErrorKind::corrupt);
        EXPECT_NE(back.error().message.find("short.png"), std::string::npos) << back.error().message;
    }
}

TEST_F(PngTest, AFlippedByteIsRefused) {
    auto bytes = encode_png(pattern<uint8_t>(9, 7, 3));
    ASSERT_TRUE(bytes.ok());
    (*bytes)[bytes->size() / 2] ^= 0x10u;
    const fs::path file = folder_ / "bad.png";
    ASSERT_TRUE(write_file(file, *bytes).ok());
    EXPECT_FALSE(read_png(file).ok());
}

TEST_F(PngTest, WrongUseAndMissingFilesSayWhatIsWrong) {
    EXPECT_EQ(encode_png(Image()).error().kind, ErrorKind::usage);
    EXPECT_EQ(encode_png(Image(2, 2, 2)).error().kind, ErrorKind::usage);
    EXPECT_EQ(encode_png(Image(2, 2, 3), {{"", "x"}}).error().kind, ErrorKind::usage);
    EXPECT_EQ(read_png(folder_ / "none.png").error().kind, ErrorKind::not_found);
    ASSERT_TRUE(write_file(folder_ / "text.png", "hello").ok());
    EXPECT_EQ(read_png(folder_ / "text.png").error().kind, ErrorKind::corrupt);
}

TEST_F(PngTest, AFailedWriteLeavesTheOldFile) {
    const fs::path file = folder_ / "a.png";
    ASSERT_TRUE(write_png(file, Image(4, 4, 3)).ok());
    const auto before = read_file(file);
    ASSERT_TRUE(before.ok());
    EXPECT_FALSE(write_png(file, Image(4, 4, 2)).ok());
    EXPECT_FALSE(write_png(file / "below", Image(4, 4, 3)).ok());
    const auto after = read_file(file);
    ASSERT_TRUE(after.ok());
    EXPECT_EQ(before.value(), after.value());
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1);
}

TEST(Image, FlipRowsTurnsThePictureOver) {
    Image image(1, 3, 1);
    image.pixels = {1, 2, 3};
    image.flip_rows();
    EXPECT_EQ(image.pixels, (std::vector<uint8_t>{3, 2, 1}));
}

} // namespace
} // namespace sahel
