#include "render/video_writer.h"

#include "world/file_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace sahel {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class VideoTest : public ::testing::Test {
  protected:
    VideoTest() : folder_(fs::path(::testing::TempDir()) / ("video_" + std::to_string(::getpid()))) {
        fs::create_directories(folder_);
    }
    ~VideoTest() override { fs::remove_all(folder_); }

    [[nodiscard]] size_t file_count() const {
        return static_cast<size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
    }
    /// A program that stands in for the encoder.
    [[nodiscard]] std::string script(const std::string& text) const {
        const fs::path file = folder_ / "encoder.sh";
        std::ofstream(file) << "#!/bin/sh\n" << text << "\n";
        fs::permissions(file, fs::perms::owner_all);
        return file.string();
    }
    static Image frame(int i, int width = 160, int height = 90) {
        Image image(width, height, 4);
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                uint8_t* p = image.at(x, y);
                p[0] = 200;
                p[1] = static_cast<uint8_t>(y < height / 2 ? 40 : 160);
                p[2] = static_cast<uint8_t>((x + 4 * i) % 64);
                p[3] = 255;
            }
        return image;
    }
    fs::path folder_;
};

std::string output_of(const std::string& command) {
    std::string text;
    std::FILE* pipe = ::popen((command + " 2>/dev/null").c_str(), "r");
    if (!pipe) return text;
    std::array<char, 4096> part{};
    size_t n = 0;
    while ((n = std::fread(part.data(), 1, part.size(), pipe)) > 0) text.append(part.data(), n);
    ::pclose(pipe);
    return text;
}

VideoSettings small_settings() {
    VideoSettings s;
    s.width_px = 160;
    s.height_px = 90;
    s.encoder_speed = "ultrafast";
    return s;
}

TEST_F(VideoTest, WritesAVideoThatPlayersRead) {
    if (find_program("ffmpeg").empty() || find_program("ffprobe").empty()) GTEST_SKIP() << "no ffmpeg or ffprobe";
    const fs::path file = folder_ / "sub" / "a video.mp4";
    auto writer = VideoWriter::open(file, small_settings());
    ASSERT_TRUE(writer.ok()) << writer.error().message;
    EXPECT_EQ(writer->output(), VideoOutput::mp4);
    EXPECT_TRUE(writer->note().empty());
    for (int i = 0; i < 30; ++i) ASSERT_TRUE(writer->add_frame(frame(i)).ok());
    EXPECT_FALSE(fs::exists(file)) << "the name is given when the video is whole";
    const Status done = writer->finish();
    ASSERT_TRUE(done.ok()) << done.error().message;
    EXPECT_EQ(writer->frame_count(), 30);
    const std::string probe =
        output_of("ffprobe -v error -count_frames -select_streams v:0 -show_entries "
                  "stream=codec_name,width,height,pix_fmt,color_space,r_frame_rate,nb_read_frames -of default=nw=1 '" +
                  file.string() + "'");
    for (const char* line : {"codec_name=h264", "width=160", "height=90", "pix_fmt=yuv420p", "color_space=bt709",
                             "r_frame_rate=24/1", "nb_read_frames=30"})
        EXPECT_THAT(probe, HasSubstr(line));
    // The index stands in front of the pictures.
    const auto bytes = read_text_file(file);
    ASSERT_TRUE(bytes.ok());
    EXPECT_LT(bytes->find("moov"), bytes->find("mdat"));
    // The first frame is the first that was given, upright and in its colours.
    const std::string pixels =
        output_of("ffmpeg -v error -i '" + file.string() + "' -frames:v 1 -f rawvideo -pix_fmt rgb24 -");
    ASSERT_EQ(pixels.size(), 160u * 90u * 3u);
    const auto green = [&](int y) {
        return static_cast<int>(static_cast<uint8_t>(pixels[static_cast<size_t>((y * 160 + 20) * 3 + 1)]));
    };
    EXPECT_NEAR(green(10), 40, 8);
    EXPECT_NEAR(green(80), 160, 8);
    EXPECT_EQ(std::distance(fs::directory_iterator(file.parent_path()), fs::directory_iterator()), 1);
}

TEST_F(VideoTest, AnUnfinishedVideoLeavesNothing) {
    if (find_program("ffmpeg").empty()) GTEST_SKIP() << "no ffmpeg";
    {
        auto writer = VideoWriter::open(folder_ / "a.mp4", small_settings());
        ASSERT_TRUE(writer.ok());
        for (int i = 0; i < 5; ++i) ASSERT_TRUE(writer->add_frame(frame(i)).ok());
    }
    EXPECT_EQ(file_count(), 0u);
}

TEST_F(VideoTest, WithoutAnEncoderFramesBecomePictures) {
    VideoSettings s = small_settings();
    s.ffmpeg = "no_such_encoder_program";
    auto writer = VideoWriter::open(folder_ / "a.mp4", s);
    ASSERT_TRUE(writer.ok());
    EXPECT_EQ(writer->output(), VideoOutput::png_folder);
    EXPECT_EQ(writer->path(), folder_ / "a_frames");
    EXPECT_THAT(writer->note(), HasSubstr("install ffmpeg"));
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(writer->add_frame(frame(i)).ok());
    ASSERT_TRUE(writer->finish().ok());
    const auto third = read_png(folder_ / "a_frames" / "frame_00003.png");
    ASSERT_TRUE(third.ok());
    EXPECT_EQ(third->image.pixels, frame(2).pixels);
    EXPECT_EQ(file_count(), 1u);
}

TEST_F(VideoTest, AFolderNameMeansPictures) {
    auto writer = VideoWriter::open(folder_ / "stills", small_settings());
    ASSERT_TRUE(writer.ok());
    EXPECT_TRUE(writer->note().empty());
    ASSERT_TRUE(writer->add_frame(frame(0)).ok());
    ASSERT_TRUE(writer->finish().ok());
    EXPECT_TRUE(fs::exists(folder_ / "stills" / "frame_00001.png"));
}

TEST_F(VideoTest, AnEncoderThatDiesIsAnErrorWithItsLastWords) {
    VideoSettings s = small_settings();
    // Takes a little, then dies as if killed from outside.
    s.ffmpeg = script("head -c 100000 > /dev/null; echo 'out of cheese' >&2; kill -KILL $$");
    const size_t before = file_count();
    auto writer = VideoWriter::open(folder_ / "a.mp4", s);
    ASSERT_TRUE(writer.ok());
    Status status;
    for (int i = 0; i < 2000 && status.ok(); ++i) status = writer->add_frame(frame(i));
    ASSERT_FALSE(status.ok());
    EXPECT_EQ(status.error().kind, ErrorKind::io);
    EXPECT_THAT(status.error().message, HasSubstr("a.mp4"));
    EXPECT_THAT(status.error().message, HasSubstr("signal 9"));
    EXPECT_THAT(status.error().message, HasSubstr("out of cheese"));
    EXPECT_EQ(file_count(), before);
}

TEST_F(VideoTest, AnEncoderThatFailsAtTheEndIsAnError) {
    VideoSettings s = small_settings();
    s.ffmpeg = script("for last; do :; done; touch \"${last#file:}\"; cat > /dev/null; echo 'disk full' >&2; exit 3");
    const size_t before = file_count();
    auto writer = VideoWriter::open(folder_ / "a.mp4", s);
    ASSERT_TRUE(writer.ok());
    ASSERT_TRUE(writer->add_frame(frame(0)).ok());
    const Status status = writer->finish();
    ASSERT_FALSE(status.ok());
    EXPECT_THAT(status.error().message, HasSubstr("exit code 3"));
    EXPECT_THAT(status.error().message, HasSubstr("disk full"));
    EXPECT_EQ(file_count(), before) << "the partial video is removed";
}

TEST_F(VideoTest, AnOldVideoStaysWhenTheNewOneFails) {
    ASSERT_TRUE(write_file(folder_ / "a.mp4", "the old one").ok());
    VideoSettings s = small_settings();
    s.ffmpeg = script("cat > /dev/null; exit 1");
    auto writer = VideoWriter::open(folder_ / "a.mp4", s);
    ASSERT_TRUE(writer.ok());
    ASSERT_TRUE(writer->add_frame(frame(0)).ok());
    EXPECT_FALSE(writer->finish().ok());
    EXPECT_EQ(read_text_file(folder_ / "a.mp4").value(), "the old one");
}

TEST_F(VideoTest, WrongSizesAreErrors) {
    VideoSettings s = small_settings();
    s.width_px = 161;
    s.ffmpeg = "/bin/true";
    EXPECT_EQ(VideoWriter::open(folder_ / "a.mp4", s).error().kind, ErrorKind::usage);
    s = small_settings();
    s.frames_per_s = 0;
    EXPECT_EQ(VideoWriter::open(folder_ / "a.mp4", s).error().kind, ErrorKind::usage);
    auto writer = VideoWriter::open(folder_ / "stills", small_settings());
    ASSERT_TRUE(writer.ok());
    EXPECT_EQ(writer->add_frame(frame(0, 80, 90)).error().kind, ErrorKind::usage);
    EXPECT_EQ(writer->finish().error().kind, ErrorKind::usage) << "a video without a frame";
}

} // namespace
} // namespace sahel
