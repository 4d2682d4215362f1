#include "render/video_writer.h"

#include "world/file_io.h"

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <optional>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>
#include <vector>

extern char** environ;

namespace sahel {

namespace fs = std::filesystem;

fs::path find_program(const std::string& name) {
    const auto usable = [](const fs::path& p) {
        std::error_code code;
        return fs::is_regular_file(p, code) && ::access(p.c_str(), X_OK) == 0;
    };
    if (name.find('/') != std::string::npos) return usable(name) ? fs::path(name) : fs::path();
    const char* variable = std::getenv("PATH");
    std::string_view rest = variable ? variable : "/usr/local/bin:/usr/bin:/bin";
    while (true) {
        const size_t end = rest.find(':');
        const std::string_view folder = rest.substr(0, end);
        if (!folder.empty() && usable(fs::path(folder) / name)) return fs::path(folder) / name;
        if (end == std::string_view::npos) return {};
        rest.remove_prefix(end + 1);
    }
}

namespace {

/// The ffmpeg process: frames go in by a socket (its send() can be told not to raise SIGPIPE), errors come out by a
/// file.
class Encoder {
  public:
    static Result<Encoder> start(const fs::path& program, const std::vector<std::string>& arguments) {
        Encoder encoder;
        std::array<int, 2> ends{};
        if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
            return Error{ErrorKind::io, fmt::format("no pipe to the video encoder: {}", std::strerror(errno))};
        encoder.frames_ = ends[0];
        encoder.words_ = ::memfd_create("encoder messages", MFD_CLOEXEC);
        ::shutdown(ends[0], SHUT_RD);

        posix_spawn_file_actions_t actions;
        posix_spawn_file_actions_init(&actions);
        posix_spawn_file_actions_adddup2(&actions, ends[1], STDIN_FILENO);
        posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
        if (encoder.words_ >= 0) posix_spawn_file_actions_adddup2(&actions, encoder.words_, STDERR_FILENO);
        std::vector<char*> argv{const_cast<char*>(program.c_str())};
        for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
        argv.push_back(nullptr);
        const int code = ::posix_spawn(&encoder.process_, program.c_str(), &actions, nullptr, argv.data(), environ);
        posix_spawn_file_actions_destroy(&actions);
        ::close(ends[1]);
        if (code != 0) {
            encoder.process_ = -1;
            return Error{ErrorKind::io, fmt::format("{}: cannot start: {}", program.string(), std::strerror(code))};
        }
        return encoder;
    }

    Encoder(Encoder&& o) noexcept
        : frames_(std::exchange(o.frames_, -1)), words_(std::exchange(o.words_, -1)),
          process_(std::exchange(o.process_, -1)) {}
    Encoder& operator=(Encoder&&) = delete;
    ~Encoder() {
        if (process_ > 0) {
            ::kill(process_, SIGKILL);
            (void)wait();
        }
        if (frames_ >= 0) ::close(frames_);
        if (words_ >= 0) ::close(words_);
    }

    [[nodiscard]] bool send(const uint8_t* data, size_t size) {
        while (size > 0) {
            const ssize_t n = ::send(frames_, data, size, MSG_NOSIGNAL);
            if (n < 0 && errno == EINTR) continue;
            if (n <= 0) return false;
            data += n;
            size -= static_cast<size_t>(n);
        }
        return true;
    }
    void end_stream() {
        if (frames_ >= 0) ::close(std::exchange(frames_, -1));
    }
    /// How the process ended, for people; empty: with success.
    [[nodiscard]] std::string wait() {
        end_stream();
        int status = 0;
        while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
        }
        process_ = -1;
        if (WIFSIGNALED(status)) return fmt::format("was killed by signal {}", WTERMSIG(status));
        if (WEXITSTATUS(status) != 0) return fmt::format("ended with exit code {}", WEXITSTATUS(status));
        return {};
    }
    /// The last line that the process wrote to its error stream.
    [[nodiscard]] std::string last_words() const {
        std::array<char, 2000> text{};
        if (words_ < 0) return {};
        const off_t size = ::lseek(words_, 0, SEEK_END);
        const off_t from = size > static_cast<off_t>(text.size()) ? size - static_cast<off_t>(text.size()) : 0;
        const ssize_t n = ::pread(words_, text.data(), text.size(), from);
        std::string_view all(text.data(), n > 0 ? static_cast<size_t>(n) : 0);
        while (!all.empty() && (all.back() == '\n' || all.back() == ' ')) all.remove_suffix(1);
        const size_t line = all.rfind('\n');
        return std::string(line == std::string_view::npos ? all : all.substr(line + 1));
    }

  private:
    Encoder() = default;
    int frames_ = -1;
    int words_ = -1;
    pid_t process_ = -1;
};

std::vector<std::string> encoder_arguments(const VideoSettings& s, bool alpha, const fs::path& out) {
    const std::string rate = fmt::format("{}", s.frames_per_s);
    std::vector<std::string> a{
        "-hide_banner", "-loglevel", "error", "-nostdin", "-y", "-f", "rawvideo", "-pix_fmt", alpha ? "rgba" : "rgb24",
        "-s", fmt::format("{}x{}", s.width_px, s.height_px), "-r", rate, "-i", "pipe:0",
        // Players take untagged video of this size for BT.709: convert to it, and say so.
        "-vf",
        "scale=out_color_matrix=bt709:out_range=tv:flags=accurate_rnd+full_chroma_int,"
        "format=yuv420p",
        "-c:v", "libx264", "-preset", s.encoder_speed, "-crf", fmt::format("{}", s.crf), "-colorspace", "bt709",
        "-color_primaries", "bt709", "-color_trc", "bt709", "-color_range", "tv", "-movflags", "+faststart"};
    if (!s.title.empty()) a.insert(a.end(), {"-metadata", "title=" + s.title});
    const std::string extension = out.extension().string();
    a.insert(a.end(), {"-f", extension == ".mkv" ? "matroska" : extension == ".mov" ? "mov" : "mp4"});
    return a;
}

bool is_video_name(const fs::path& path) {
    const std::string e = path.extension().string();
    return e == ".mp4" || e == ".mov" || e == ".mkv";
}

} // namespace

struct VideoWriter::Impl {
    VideoSettings settings;
    VideoOutput output = VideoOutput::mp4;
    fs::path path;
    fs::path aside;
    fs::path program;
    std::string note;
    std::optional<Encoder> encoder; ///< started with the first frame, which says whether there is alpha
    int channels = 0;
    int64_t frames = 0;
    bool ended = false;

    ~Impl() { discard(); }

    void discard() {
        encoder.reset();
        if (output == VideoOutput::mp4) {
            std::error_code ignored;
            fs::remove(aside, ignored);
        }
    }

    Error encoder_error(const std::string& how) {
        const std::string words = encoder ? encoder->last_words() : std::string();
        ended = true;
        discard();
        return {ErrorKind::io, fmt::format("{}: the video encoder {} {}{}; no video was written", path.string(),
                                           program.string(), how, words.empty() ? "" : ": " + words)};
    }

    Status add_to_video(const Image& frame) {
        if (!encoder) {
            channels = frame.channels;
            std::vector<std::string> arguments = encoder_arguments(settings, channels == 4, path);
            arguments.push_back("file:" + aside.string());
            SAHEL_ASSIGN(Encoder started, Encoder::start(program, arguments));
            encoder.emplace(std::move(started));
        }
        if (frame.channels != channels)
            return Error{ErrorKind::usage, fmt::format("{}: frame {} has {} channels, the first had {}", path.string(),
                                                       frames, frame.channels, channels)};
        if (!encoder->send(frame.pixels.data(), frame.pixels.size())) {
            const std::string how = encoder->wait();
            return encoder_error(how.empty() ? "stopped reading" : how);
        }
        return {};
    }
};

VideoWriter::VideoWriter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
VideoWriter::VideoWriter(VideoWriter&&) noexcept = default;
VideoWriter& VideoWriter::operator=(VideoWriter&&) noexcept = default;
VideoWriter::~VideoWriter() = default;

VideoOutput VideoWriter::output() const {
    return impl_->output;
}
const fs::path& VideoWriter::path() const {
    return impl_->path;
}
const std::string& VideoWriter::note() const {
    return impl_->note;
}
int64_t VideoWriter::frame_count() const {
    return impl_->frames;
}

Result<VideoWriter> VideoWriter::open(const fs::path& path, const VideoSettings& settings) {
    const auto usage = [&](const std::string& what) {
        return Error{ErrorKind::usage, fmt::format("{}: {}", path.string(), what)};
    };
    const VideoSettings& s = settings;
    if (path.empty()) return Error{ErrorKind::usage, "a video needs a file name"};
    if (s.width_px < 16 || s.height_px < 16 || s.width_px > 16384 || s.height_px > 16384)
        return usage(fmt::format("frames of {} x {} pixels; 16 to 16384 a side", s.width_px, s.height_px));
    if (s.frames_per_s < 1 || s.frames_per_s > 240)
        return usage(fmt::format("{} frames per second; 1 to 240", s.frames_per_s));
    if (s.crf < 0 || s.crf > 51) return usage(fmt::format("quality (crf) {}; 0 to 51", s.crf));

    auto impl = std::make_unique<Impl>();
    impl->settings = settings;
    impl->path = path;
    if (is_video_name(path)) {
        if (s.width_px % 2 != 0 || s.height_px % 2 != 0)
            return usage(fmt::format("a video needs an even width and height, not {} x {}", s.width_px, s.height_px));
        impl->program = find_program(s.ffmpeg);
        if (impl->program.empty()) {
            impl->path.replace_filename(path.stem().string() + "_frames");
            impl->note = fmt::format("no program '{}': the frames of {} go to {} as PNG files; install ffmpeg for a "
                                     "video",
                                     s.ffmpeg, path.filename().string(), impl->path.string());
        }
    }
    impl->output = impl->program.empty() ? VideoOutput::png_folder : VideoOutput::mp4;
    if (impl->output == VideoOutput::png_folder) {
        SAHEL_TRY(make_folder(impl->path));
    } else {
        if (path.has_parent_path()) SAHEL_TRY(make_folder(path.parent_path()));
        impl->aside = aside_path(path);
    }
    return VideoWriter(std::move(impl));
}

Status VideoWriter::add_frame(const Image& frame) {
    Impl& w = *impl_;
    SAHEL_CHECK(!w.ended);
    if (frame.width_px != w.settings.width_px || frame.height_px != w.settings.height_px ||
        (frame.channels != 3 && frame.channels != 4))
        return Error{ErrorKind::usage,
                     fmt::format("{}: frame of {} x {} x {} in a video of {} x {}", w.path.string(), frame.width_px,
                                 frame.height_px, frame.channels, w.settings.width_px, w.settings.height_px)};
    if (w.output == VideoOutput::mp4)
        SAHEL_TRY(w.add_to_video(frame));
    else
        SAHEL_TRY(write_png(w.path / fmt::format("frame_{:05}.png", w.frames + 1), frame));
    ++w.frames;
    return {};
}

Status VideoWriter::finish() {
    Impl& w = *impl_;
    SAHEL_CHECK(!w.ended);
    if (w.frames == 0) {
        w.ended = true;
        w.discard();
        return Error{ErrorKind::usage, fmt::format("{}: no frame was added", w.path.string())};
    }
    if (w.output == VideoOutput::mp4) {
        const std::string how = w.encoder->wait();
        if (!how.empty()) return w.encoder_error(how);
        SAHEL_TRY(commit_aside_file(w.aside, w.path));
    }
    w.ended = true;
    return {};
}

} // namespace sahel
