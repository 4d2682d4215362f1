#include "render/bookmarks.h"
#include "tests/fuzz/fuzz_target.h"

#include <cmath>
#include <fstream>

/// Bookmarks as JSON.
namespace sahel::fuzz {

static std::vector<Bytes> bookmarks_seeds() {
    const std::filesystem::path file = scratch_folder() / "seed.json";
    expect(save_bookmarks(file, {{"north \"shore\"", {{1e9 + 0.125, -3, 322.1}, -170, 12, 48}}, {"two", {}}}).ok(),
           "the seed can be made");
    std::ifstream in(file, std::ios::binary);
    return {Bytes(std::istreambuf_iterator<char>(in), {})};
}

} // namespace sahel::fuzz

SAHEL_FUZZ_TARGET(bookmarks, bookmarks_seeds) {
    using namespace sahel;
    const std::filesystem::path file = scratch_folder() / "bookmarks.json";
    std::ofstream(file, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    const auto places = load_bookmarks(file);
    if (!places.ok()) return expect_one_line(places.error());
    for (const Bookmark& place : *places)
        for (const double v : place.pose.eye_m) expect(std::isfinite(v), "positions are finite");
}
