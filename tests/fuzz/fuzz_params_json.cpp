#include "tests/fuzz/fuzz_target.h"
#include "world/base_terrain.h"
#include "world/params_json.h"

/// Parameters as JSON.
namespace sahel::fuzz {

static std::vector<Bytes> params_json_seeds() {
    std::vector<Bytes> seeds;
    for (const std::string_view name : {"oasis", "islands"})
        seeds.push_back(bytes_of(params_to_json(base_terrain_preset(name).value()).dump(2)));
    seeds.push_back(bytes_of(R"({"base_m": 12.5, "sea": 1, "unknown": {"a": [1, 2, "\u00e4"]}})"));
    return seeds;
}

} // namespace sahel::fuzz

SAHEL_FUZZ_TARGET(params_json, params_json_seeds) {
    using namespace sahel;
    const auto json = parse_json(text_of(bytes), "params.json");
    if (!json.ok()) return expect_one_line(json.error());
    const auto params = params_from_json<BaseTerrainParams>(*json, "params.json");
    if (!params.ok()) return expect_one_line(params.error());
    expect(check_ranges(*params, "params.json").ok(), "what was read is in range");
    const Json text = params_to_json(*params);
    const auto again = params_from_json<BaseTerrainParams>(text, "params.json");
    expect(again.ok() && params_to_json(*again) == text, "what was read is written and read again");
}
