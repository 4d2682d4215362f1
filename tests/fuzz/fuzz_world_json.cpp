#include "tests/fuzz/fuzz_target.h"
#include "world/world_json.h"

/// The text of world.json.
namespace sahel::fuzz {

static std::vector<Bytes> world_json_seeds() {
    WorldDesc endless;
    endless.name = "endless";
    WorldDesc imported;
    imported.name = "imported \"model\"";
    imported.preset = "none";
    imported.sea_m = -3.5;
    imported.georeference = GeoReference{"PROJCS[\"WGS 84 / UTM zone 31N\"]", 371000.5, 4.7e6, 10.0, -10.0, 12.0};
    return {bytes_of(world_json(endless)), bytes_of(world_json(imported)),
            bytes_of(std::string(20000, '[') + std::string(20000, ']'))};
}

} // namespace sahel::fuzz

SAHEL_FUZZ_TARGET(world_json, world_json_seeds) {
    using namespace sahel;
    const auto desc = parse_world_json(text_of(bytes), "world.json");
    if (!desc.ok()) return expect_one_line(desc.error());
    const std::string text = world_json(*desc);
    const auto again = parse_world_json(text, "world.json");
    expect(again.ok() && world_json(*again) == text, "what was read is written and read again");
}
