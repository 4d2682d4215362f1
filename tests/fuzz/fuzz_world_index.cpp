#include "tests/fuzz/fuzz_target.h"
#include "world/file_io.h"
#include "world/world.h"

#include <fcntl.h>
#include <unistd.h>

/// The bytes of index.sqlite, in a world that is otherwise whole.
namespace sahel::fuzz {

namespace {

std::filesystem::path world_folder() {
    return scratch_folder() / "world";
}

std::vector<Bytes> world_index_seeds() {
    WorldDesc desc;
    desc.name = "fuzz";
    desc.preset = "none";
    desc.tile_cells = 128;
    std::filesystem::remove_all(world_folder());
    {
        auto world = World::create(world_folder(), desc).value();
        for (int64_t step = 1; step < 4; ++step) {
            auto block = LayerBlock::allocate(0, tile_rect({0, step, -step}, 128), 0, k_surface_layers).value();
            block.clear();
            block.ints(Layer::sand)(3, 4) = static_cast<int32_t>(step);
            const TileUpdate update{{0, step, -step}, &block};
            expect(world.commit(step, std::span(&update, 1)).ok(), "the seed can be made");
        }
    }
    return {read_file(world_folder() / "index.sqlite").value()};
}

} // namespace

} // namespace sahel::fuzz

SAHEL_FUZZ_TARGET(world_index, world_index_seeds) {
    using namespace sahel;
    if (!std::filesystem::exists(world_folder())) (void)world_index_seeds();
    const std::filesystem::path path = world_folder() / "index.sqlite";
    for (const char* tail : {"-wal", "-shm", "-journal"}) std::filesystem::remove(path.string() + tail);
    // Not synced: thousands of files a minute.
    const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    expect(file >= 0 && ::write(file, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size()),
           "the input can be written");
    ::close(file);
    for (const OpenMode mode : {OpenMode::read, OpenMode::write}) {
        const auto world = World::open(world_folder(), mode);
        if (!world.ok()) {
            expect_one_line(world.error());
            continue;
        }
        (void)world->info();
        (void)world->hash();
        if (const auto report = world->verify(); !report.ok()) expect_one_line(report.error());
        const auto keys = world->tiles(0);
        if (keys.ok() && !keys->empty()) (void)world->read_tile(keys->front());
    }
}
