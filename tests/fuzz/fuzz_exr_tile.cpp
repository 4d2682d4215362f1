#include "tests/fuzz/fuzz_target.h"
#include "world/exr_tile.h"
#include "world/state_hash.h"

/// The bytes of a stored tile.
namespace sahel::fuzz {

static std::vector<Bytes> exr_tile_seeds() {
    std::vector<Bytes> seeds;
    for (const TileCompression c :
         {TileCompression::zip, TileCompression::zips, TileCompression::piz, TileCompression::none}) {
        auto block = LayerBlock::allocate(0, tile_rect({0, -3, 5}, 128), 0, k_stored_layers).value();
        block.clear();
        for (int y = 0; y < 128; ++y)
            for (int x = 0; x < 128; ++x) {
                block.ints(Layer::bedrock)(x, y) = 1000 * x - 700 * y;
                block.ints(Layer::sand)(x, y) = (x * y) & 1023;
                block.ints(Layer::mask)(x, y) = x > 100 ? 1 : 0;
                block.reals(Layer::wind_x)(x, y) = 0.125f * static_cast<float>(y); // of a shown layer
            }
        seeds.push_back(encode_tile(make_stored_tile({0, -3, 5}, 128, block).value(), c).value());
    }
    return seeds;
}

} // namespace sahel::fuzz

SAHEL_FUZZ_TARGET(exr_tile, exr_tile_seeds) {
    using namespace sahel;
    const auto tile = decode_tile(bytes, "tile");
    if (!tile.ok()) return expect_one_line(tile.error());
    expect(is_storable(tile->key), "a decoded tile has a possible key");
    if (tile->tile_cells % k_hash_block_cells != 0 || tile->tile_cells > 256) return;
    const auto again = decode_tile(encode_tile(*tile).value(), "again");
    expect(again.ok() && hash_blocks(*again) == hash_blocks(*tile), "a decoded tile is written and read again");
}
