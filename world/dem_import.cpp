#include "world/dem_import.h"

#include "world/file_io.h"

#include <fmt/format.h>

#include <unistd.h>

namespace sahel {

namespace fs = std::filesystem;

namespace {

class WorldSink final : public DemSink {
  public:
    explicit WorldSink(fs::path folder) : folder_(std::move(folder)) {}
    Status begin(const WorldDesc& desc) override {
        auto world = World::create(folder_, desc);
        if (!world.ok()) return world.error();
        world_.emplace(std::move(world).value());
        return {};
    }
    Status commit(std::span<const TileUpdate> tiles) override { return world_->commit(0, tiles); }
    void close() { world_.reset(); }

  private:
    fs::path folder_;
    std::optional<World> world_;
};

/// A folder that is removed unless it has been renamed away.
struct WorkFolder {
    fs::path path;
    explicit WorkFolder(fs::path p) : path(std::move(p)) {}
    WorkFolder(const WorkFolder&) = delete;
    WorkFolder& operator=(const WorkFolder&) = delete;
    ~WorkFolder() {
        std::error_code ignored;
        fs::remove_all(path, ignored);
    }
};

} // namespace

Result<DemImportReport> import_dem(const fs::path& world, std::span<const fs::path> files,
                                   const DemImportOptions& options, const DemProgress& progress) {
    std::error_code failed;
    fs::path target = fs::absolute(world, failed).lexically_normal();
    if (target.filename().empty()) target = target.parent_path();
    if (failed || target.filename().empty())
        return Error{ErrorKind::usage, fmt::format("'{}' is no name for a world's folder", world.string())};
    const fs::path parent = target.parent_path();
    if (!fs::is_directory(parent, failed))
        return Error{ErrorKind::not_found, fmt::format("{}: no such folder to make the world in", parent.string())};
    if (fs::exists(target, failed) && !(fs::is_directory(target, failed) && fs::is_empty(target, failed)))
        return Error{ErrorKind::usage,
                     fmt::format("{} exists and is not empty: import into a new world", target.string())};

    DemImportOptions named = options;
    if (named.name.empty()) named.name = target.filename().string();
    const WorkFolder work(parent / fmt::format("{}.importing-{}", target.filename().string(), ::getpid()));
    if (!fs::create_directory(work.path, failed))
        return Error{ErrorKind::io, fmt::format("{}: cannot be made: {}", work.path.string(),
                                                failed ? failed.message() : "it is there already")};
    WorldSink sink(work.path / "world");
    SAHEL_ASSIGN(auto report, import_dem_tiles(sink, work.path, files, named, progress));
    sink.close();
    fs::rename(work.path / "world", target, failed); // over an empty folder, too
    if (failed)
        return Error{ErrorKind::io,
                     fmt::format("{}: the finished world cannot be put there: {}", target.string(), failed.message())};
    SAHEL_TRY(sync_folder(parent));
    return report;
}

} // namespace sahel
