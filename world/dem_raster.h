#pragma once

#include "world/result.h"
#include "world/tile_key.h"

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <string>
#include <unistd.h>
#include <utility>

/// A raster that may be larger than memory: rows in one scratch file, read and written by windows. The file has no name
/// any more once it is open, so nothing stays behind after a crash. What was never written reads as zero.
namespace sahel {

template <class T> class ScratchRaster {
  public:
    ScratchRaster() = default;
    ScratchRaster(ScratchRaster&& o) noexcept
        : fd_(std::exchange(o.fd_, -1)), width_(o.width_), height_(o.height_), folder_(std::move(o.folder_)) {}
    ScratchRaster& operator=(ScratchRaster&& o) noexcept {
        if (this != &o) {
            if (fd_ >= 0) ::close(fd_);
            fd_ = std::exchange(o.fd_, -1);
            width_ = o.width_;
            height_ = o.height_;
            folder_ = std::move(o.folder_);
        }
        return *this;
    }
    ~ScratchRaster() {
        if (fd_ >= 0) ::close(fd_);
    }

    /// Errors: io.
    static Result<ScratchRaster> create(const std::filesystem::path& folder, int64_t width, int64_t height) {
        ScratchRaster raster;
        raster.width_ = width;
        raster.height_ = height;
        raster.folder_ = folder.string();
        std::string name = (folder / "scratch-XXXXXX").string();
        raster.fd_ = ::mkostemp(name.data(), O_CLOEXEC);
        if (raster.fd_ < 0) return raster.failed("no scratch file can be made");
        ::unlink(name.c_str());
        if (::ftruncate(raster.fd_, width * height * static_cast<int64_t>(sizeof(T))) != 0)
            return raster.failed("a scratch file cannot grow");
        return raster;
    }

    [[nodiscard]] int64_t width() const { return width_; }
    [[nodiscard]] int64_t height() const { return height_; }

    /// The rows of the window one after the other. Errors: io.
    Status read(const CellRect& window, T* out) const { return transfer<false>(window, out); }
    Status write(const CellRect& window, const T* in) { return transfer<true>(window, const_cast<T*>(in)); }
    Status read_row(int64_t y, T* out) const { return read({0, y, width_, y + 1}, out); }
    Status write_row(int64_t y, const T* in) { return write({0, y, width_, y + 1}, in); }

  private:
    [[nodiscard]] Error failed(const char* what) const {
        return {ErrorKind::io, std::string(what) + " in " + folder_ + ": " + std::strerror(errno)};
    }

    template <bool k_write> Status transfer(const CellRect& window, T* data) const {
        SAHEL_CHECK((CellRect{0, 0, width_, height_}.contains(window)));
        if (window.empty()) return {};
        const bool whole_rows = window.width() == width_;
        const int64_t pieces = whole_rows ? 1 : window.height();
        const auto bytes = static_cast<size_t>(window.area() / pieces) * sizeof(T);
        auto* memory = reinterpret_cast<char*>(data);
        for (int64_t i = 0; i < pieces; ++i, memory += bytes) {
            const int64_t at = ((window.y0 + i) * width_ + window.x0) * static_cast<int64_t>(sizeof(T));
            for (size_t done = 0; done < bytes;) {
                ssize_t n = 0;
                if constexpr (k_write)
                    n = ::pwrite(fd_, memory + done, bytes - done, at + static_cast<int64_t>(done));
                else
                    n = ::pread(fd_, memory + done, bytes - done, at + static_cast<int64_t>(done));
                if (n < 0 && errno == EINTR) continue;
                if (n <= 0) return failed(k_write ? "scratch data cannot be written" : "scratch data cannot be read");
                done += static_cast<size_t>(n);
            }
        }
        return {};
    }

    int fd_ = -1;
    int64_t width_ = 0;
    int64_t height_ = 0;
    std::string folder_;
};

} // namespace sahel
