#include "streaming/scene_file.h"
#include "tests/fuzz/fuzz_target.h"

#include <cmath>
#include <fstream>
#include <iterator>

/// Scene files of Desertscape and Oasis.
namespace sahel::fuzz {

static std::vector<Bytes> scene_seeds() {
    std::vector<Bytes> seeds;
    for (const char* name : {"scene_dunes.json", "scene_dunes_2023.json", "scene_oasis.json"}) {
        std::ifstream in(std::filesystem::path(SAHEL_SOURCE_DIR) / "tests" / "data" / name, std::ios::binary);
        seeds.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
    }
    return seeds;
}

} // namespace sahel::fuzz

SAHEL_FUZZ_TARGET(scene, scene_seeds) {
    using namespace sahel;
    const auto scene = parse_scene({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, "scene.json");
    if (!scene.ok()) return expect_one_line(scene.error());
    expect(check_ranges(scene->wind, "x").ok() && check_ranges(scene->sand, "x").ok(), "parameters are in range");
    expect(std::isfinite(scene->step_s) && scene->step_s > 0.0, "a step has a length");
    expect(scene->species.size() <= k_max_species, "few species");
}
