#include "tests/world/store_support.h"
#include "world/state_hash.h"
#include "world/world_json.h"

#include <fmt/format.h>

#include <cstdlib>

/// Worlds written long ago stay readable: tests/data/world-1 was written by format 1 and never changes. A new format
/// gets a folder of its own beside it (SAHEL_WRITE_GOLDEN=1 writes the folder of the current one, if it is missing).
namespace sahel::store_test {
namespace {

const fs::path k_golden = fs::path(SAHEL_SOURCE_DIR) / "tests" / "data" / "world-1";
constexpr std::array<TileKey, 2> k_keys = {TileKey{0, -1, 0}, TileKey{0, 0, 0}};

int32_t golden_value(Layer layer, int64_t x, int64_t y) {
    switch (layer) {
    case Layer::bedrock:
        return static_cast<int32_t>(131072 * 300 + 4096 * (x / 8) - 2048 * (y / 8));
    case Layer::sand:
        return static_cast<int32_t>(512 * ((x >> 4) & 3));
    case Layer::water:
        return y < 0 ? 0 : 77777;
    case Layer::moisture:
        return static_cast<int32_t>(-(y / 32)); // negative numbers keep their bits
    case Layer::mask:
        return x < -100 ? 3 : 0;
    default:
        return 0;
    }
}

WorldDesc golden_desc() {
    WorldDesc d;
    d.name = "golden \"one\"";
    d.preset = "none";
    d.seed = 18446744073709551615ull;
    d.tile_cells = 128;
    d.cell_m = 0.5;
    d.outside_m = -2.25;
    d.sea_m = 1.5;
    d.georeference = GeoReference{"LOCAL_CS[\"m\"]", 371000.25, 4700000.5, 0.5, -0.5, 12.0};
    return d;
}

TEST_F(Store, AWorldOfFormatOneIsReadAsItWasWritten) {
    if (!fs::exists(k_golden) && std::getenv("SAHEL_WRITE_GOLDEN")) {
        auto world = World::create(k_golden, golden_desc());
        ASSERT_TRUE(world.ok()) << world.error().message;
        std::vector<LayerBlock> blocks;
        std::vector<TileUpdate> updates;
        blocks.reserve(k_keys.size());
        for (const TileKey key : k_keys) {
            const CellRect rect = tile_rect(key, 128);
            blocks.push_back(LayerBlock::allocate(0, rect, 0, k_state_layers).value());
            k_state_layers.for_each([&](Layer layer) {
                for (int y = 0; y < 128; ++y)
                    for (int x = 0; x < 128; ++x)
                        blocks.back().ints(layer)(x, y) = golden_value(layer, rect.x0 + x, rect.y0 + y);
            });
            updates.push_back({key, &blocks.back()});
        }
        ASSERT_TRUE(world->commit(41, updates).ok());
        fs::remove(k_golden / ".lock");
    }
    fs::copy(k_golden, folder(), fs::copy_options::recursive);
    auto world = World::open(folder(), OpenMode::read);
    ASSERT_TRUE(world.ok()) << world.error().message;
    const auto report = world->verify();
    ASSERT_TRUE(report.ok());
    for (const VerifyIssue& issue : report->issues) ADD_FAILURE() << issue.path << ": " << issue.what;
    EXPECT_EQ(report->files_checked, 4);
    EXPECT_EQ(world->hash().value(), "5c208f32f01347c1c41082088373ebe9");
    EXPECT_EQ(world->info()->step, 41);
    EXPECT_TRUE(world->inboxes()->empty() && world->ledger()->empty() && world->resume()->empty());
    for (const TileKey key : k_keys) {
        const CellRect rect = tile_rect(key, 128);
        const auto block = world->read_tile(key);
        ASSERT_TRUE(block.ok()) << block.error().message;
        k_state_layers.for_each([&](Layer layer) {
            int64_t wrong = 0;
            for (int y = 0; y < 128; ++y)
                for (int x = 0; x < 128; ++x)
                    wrong += block->ints(layer)(x, y) != golden_value(layer, rect.x0 + x, rect.y0 + y) ? 1 : 0;
            EXPECT_EQ(wrong, 0) << info_of(layer).name;
        });
    }
    // What people edit is written as it always was, but for the number of the format.
    std::string text = world_json(golden_desc());
    const std::string now = fmt::format("\"format_version\": {}", k_world_format_version);
    ASSERT_NE(text.find(now), std::string::npos);
    text.replace(text.find(now), now.size(), "\"format_version\": 1");
    EXPECT_EQ(read_text_file(folder() / "world.json").value(), text);
    // And it can be written to.
    world = World::open(folder(), OpenMode::write);
    ASSERT_TRUE(world.ok()) << world.error().message;
    ASSERT_TRUE(commit_whole_step(*world, 42, {{0, 5, 5}}).ok()); // with rows that format 1 knew nothing of
    EXPECT_EQ(world->inboxes()->size(), 1u);
    EXPECT_TRUE(world->verify()->issues.empty());
}

} // namespace
} // namespace sahel::store_test
