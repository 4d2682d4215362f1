#include "world/exr_image.h"

#include "world/file_io.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

namespace sahel {
namespace {

namespace fs = std::filesystem;

class ExrImageFile : public testing::Test {
  protected:
    void SetUp() override {
        std::string pattern = (fs::temp_directory_path() / "sahel-exr-XXXXXX").string();
        ASSERT_NE(mkdtemp(pattern.data()), nullptr);
        folder_ = pattern;
    }
    void TearDown() override { fs::remove_all(folder_); }
    fs::path folder_;
};

TEST_F(ExrImageFile, PlanesComeBackToTheBit) {
    ExrImage image{37, 11, {}};
    for (const char* name : {"wind.x", "R", "bedrock"}) {
        image.planes.push_back({name, {}});
        for (int i = 0; i < 37 * 11; ++i)
            image.planes.back().values.push_back(std::sin(static_cast<float>(i)) * 1.0e-3f * static_cast<float>(i * i));
    }
    image.planes[0].values[5] = -0.0f;
    image.planes[1].values[6] = HUGE_VALF;
    const fs::path file = folder_ / "new" / "fields.exr";
    ASSERT_TRUE(write_exr_image(file, image).ok());
    const auto back = read_exr_image(file);
    ASSERT_TRUE(back.ok()) << back.error().message;
    EXPECT_EQ(back->width, 37);
    EXPECT_EQ(back->height, 11);
    EXPECT_EQ(back->planes.size(), 3u);
    for (const ExrPlane& plane : image.planes) {
        ASSERT_NE(back->find(plane.name), nullptr) << plane.name;
        EXPECT_EQ(*back->find(plane.name), plane.values);
    }
    EXPECT_EQ(back->find("G"), nullptr);
}

TEST_F(ExrImageFile, MistakesAreNamed) {
    const fs::path file = folder_ / "a.exr";
    EXPECT_EQ(read_exr_image(file).error().kind, ErrorKind::not_found);
    EXPECT_EQ(write_exr_image(file, {}).error().kind, ErrorKind::usage);
    EXPECT_EQ(write_exr_image(file, {4, 4, {{"R", std::vector<float>(15)}}}).error().kind, ErrorKind::usage);
    EXPECT_FALSE(fs::exists(file));
    EXPECT_FALSE(write_exr_image("/proc/nowhere/a.exr", {1, 1, {{"R", {1.0f}}}}).ok());
}

TEST_F(ExrImageFile, CutAndFlippedFilesAreRefusedOrRead) {
    ExrImage image{64, 64, {{"G", std::vector<float>(64 * 64)}, {"R", std::vector<float>(64 * 64, 2.0f)}}};
    for (size_t i = 0; i < 64 * 64; ++i) image.planes[0].values[i] = static_cast<float>(i % 97);
    const fs::path file = folder_ / "a.exr";
    ASSERT_TRUE(write_exr_image(file, image).ok());
    const auto whole = read_file(file);
    ASSERT_TRUE(whole.ok());
    int refused = 0;
    for (size_t trial = 0; trial < 120; ++trial) {
        auto bytes = *whole;
        if (trial % 2 == 0)
            bytes.resize(bytes.size() * trial / 120);
        else
            bytes[(trial * 7919) % std::min<size_t>(bytes.size(), 600)] ^= static_cast<uint8_t>(1u << (trial % 8));
        ASSERT_TRUE(write_file(file, std::span<const uint8_t>(bytes)).ok());
        const auto read = read_exr_image(file);
        if (read.ok()) continue;
        ++refused;
        EXPECT_EQ(read.error().message.find('\n'), std::string::npos);
    }
    EXPECT_GT(refused, 60);
}

} // namespace
} // namespace sahel
