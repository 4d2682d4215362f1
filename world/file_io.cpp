#include "world/file_io.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace sahel {

namespace {

namespace fs = std::filesystem;

/// Closes at the end of its scope; close() reports what a network disk could not write.
class FileDescriptor {
  public:
    explicit FileDescriptor(int fd) : fd_(fd) {}
    FileDescriptor(const FileDescriptor&) = delete;
    FileDescriptor& operator=(const FileDescriptor&) = delete;
    ~FileDescriptor() {
        if (fd_ >= 0) ::close(fd_);
    }
    [[nodiscard]] int get() const { return fd_; }
    [[nodiscard]] bool close() {
        const int fd = fd_;
        fd_ = -1;
        return ::close(fd) == 0;
    }

  private:
    int fd_;
};

Error io_error(std::string_view what, const fs::path& path, int code) {
    const char* hint = code == ENOSPC || code == EDQUOT                   ? "; free some space"
                       : code == EACCES || code == EROFS || code == EPERM ? "; choose a folder that can be written"
                                                                          : "";
    return {code == ENOENT ? ErrorKind::not_found : ErrorKind::io,
            fmt::format("{}: cannot {}: {}{}", path.string(), what, std::strerror(code), hint)};
}

template <class Bytes> Result<Bytes> read_whole(const fs::path& path, uint64_t max_bytes) {
    FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
    if (file.get() < 0) return io_error("open", path, errno);
    struct stat info {};
    if (::fstat(file.get(), &info) != 0) return io_error("read", path, errno);
    if (!S_ISREG(info.st_mode)) return Error{ErrorKind::io, fmt::format("{}: not a file", path.string())};
    const auto size = static_cast<uint64_t>(info.st_size);
    if (size > max_bytes)
        return Error{ErrorKind::budget, fmt::format("{}: {} bytes, more than the {} that such a file may have",
                                                    path.string(), size, max_bytes)};
    Bytes bytes;
    bytes.resize(size);
    size_t done = 0;
    while (done < bytes.size()) {
        const ssize_t n = ::read(file.get(), bytes.data() + done, bytes.size() - done);
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) return io_error("read", path, errno);
        if (n == 0) break;
        done += static_cast<size_t>(n);
    }
    bytes.resize(done);
    return bytes;
}

Status write_all(int fd, std::span<const uint8_t> bytes, const fs::path& path) {
    size_t done = 0;
    while (done < bytes.size()) {
        const ssize_t n = ::write(fd, bytes.data() + done, bytes.size() - done);
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) return io_error("write", path, errno);
        done += static_cast<size_t>(n);
    }
    return {};
}

fs::path folder_of(const fs::path& path) {
    return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

Status write_aside(const fs::path& aside, std::span<const uint8_t> bytes) {
    FileDescriptor file(::open(aside.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
    if (file.get() < 0) return io_error("create", aside, errno);
    SAHEL_TRY(write_all(file.get(), bytes, aside));
    if (!file.close()) return io_error("write", aside, errno);
    return {};
}

} // namespace

Result<std::vector<uint8_t>> read_file(const fs::path& path, uint64_t max_bytes) {
    return read_whole<std::vector<uint8_t>>(path, max_bytes);
}
Result<std::string> read_text_file(const fs::path& path, uint64_t max_bytes) {
    return read_whole<std::string>(path, max_bytes);
}

fs::path aside_path(const fs::path& path) {
    fs::path aside = path;
    aside.replace_filename(fmt::format(".{}.{}.aside", path.filename().string(), ::getpid()));
    return aside;
}

Status make_folder(const fs::path& folder) {
    std::error_code code;
    fs::create_directories(folder, code);
    if (code) return io_error("make the folder", folder, code.value());
    return {};
}

Status sync_folder(const fs::path& folder) {
    FileDescriptor handle(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (handle.get() < 0) return io_error("open the folder", folder, errno);
    // Some file systems cannot sync a folder and need not.
    if (::fsync(handle.get()) != 0 && errno != EINVAL && errno != ENOTSUP) return io_error("sync", folder, errno);
    return {};
}

Status commit_aside_file(const fs::path& aside, const fs::path& path) {
    const auto give_up = [&](const char* what, const fs::path& name, int code) {
        ::unlink(aside.c_str());
        return io_error(what, name, code);
    };
    {
        FileDescriptor file(::open(aside.c_str(), O_RDONLY | O_CLOEXEC));
        if (file.get() < 0) return io_error("open", aside, errno);
        if (::fsync(file.get()) != 0) return give_up("sync", path, errno);
    }
    if (::rename(aside.c_str(), path.c_str()) != 0) return give_up("replace", path, errno);
    return sync_folder(folder_of(path));
}

Status write_file(const fs::path& path, std::span<const uint8_t> bytes) {
    SAHEL_TRY(make_folder(folder_of(path)));
    const fs::path aside = aside_path(path);
    if (const Status written = write_aside(aside, bytes); !written.ok()) {
        ::unlink(aside.c_str());
        return written;
    }
    return commit_aside_file(aside, path);
}
Status write_file(const fs::path& path, std::string_view text) {
    return write_file(path, std::span(reinterpret_cast<const uint8_t*>(text.data()), text.size()));
}

} // namespace sahel
