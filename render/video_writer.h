#pragma once

#include "render/png_io.h"
#include "world/result.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

/// Frames to an MP4 file, or to a folder of PNG files.
///
/// Raw frames go through a socket to an ffmpeg process (H.264, yuv420p, BT.709, index at the front): encoding runs
/// beside rendering, and nothing is linked. The video grows in a file aside and gets its name when it is whole; an
/// encoder that fails, or a writer that is thrown away unfinished, leaves nothing behind.
namespace sahel {

struct VideoSettings {
    int width_px = 1280; ///< even, for a video
    int height_px = 720;
    int frames_per_s = 24;
    int crf = 19;                         ///< quality of H.264: 0 lossless, 51 worst
    std::string encoder_speed = "medium"; ///< preset of x264
    std::string title;
    std::string ffmpeg = "ffmpeg"; ///< program name (searched in PATH) or path
};

enum class VideoOutput { mp4, png_folder };

class VideoWriter {
  public:
    /// A path that ends in .mp4, .mov or .mkv is a video; any other is a folder for frame_00001.png and so on. Without
    /// an ffmpeg program a video falls back to the folder NAME_frames beside it, and note() says so.
    /// Errors: usage (sizes, rates), io.
    static Result<VideoWriter> open(const std::filesystem::path& path, const VideoSettings& settings);

    VideoWriter(VideoWriter&&) noexcept;
    VideoWriter& operator=(VideoWriter&&) noexcept;
    ~VideoWriter(); ///< without finish(): stops the encoder and removes what it wrote

    /// An RGBA or RGB frame of the given size, top row first. Waits while the encoder is behind. Errors: usage (size),
    /// io (the encoder died: its last words are in the message).
    Status add_frame(const Image& frame);

    /// Ends the stream, waits for the encoder, renames. Errors: usage (no frame was added), io.
    Status finish();

    [[nodiscard]] VideoOutput output() const;
    [[nodiscard]] const std::filesystem::path& path() const; ///< of the video or the folder that is written
    [[nodiscard]] const std::string& note() const;           ///< one line when the output is not what was asked for
    [[nodiscard]] int64_t frame_count() const;

  private:
    struct Impl;
    explicit VideoWriter(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

/// Full path of a program named by path or found in PATH; empty if there is none.
std::filesystem::path find_program(const std::string& name);

} // namespace sahel
