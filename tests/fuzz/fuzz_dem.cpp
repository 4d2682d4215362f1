#include "tests/fuzz/fuzz_target.h"
#include "tests/world/dem_support.h"
#include "world/dem_source.h"

#include <gdal_priv.h>

#include <algorithm>
#include <cmath>
#include <fstream>

/// Elevation files: the first byte of an input says what kind of file the others are.
namespace sahel::fuzz {

namespace {

using namespace dem_test;

constexpr std::array<const char*, 6> k_names = {"a.tif", "a.exr", "a.png", "a.asc", "N10E010.hgt", "a.raw"};

Bytes seed_of(uint8_t kind, const std::filesystem::path& file) {
    Bytes bytes = read_bytes(file);
    bytes.insert(bytes.begin(), kind);
    return bytes;
}

std::vector<Bytes> dem_seeds() {
    const Grid grid{33, 21, [](int x, int y) { return 300.0 + 2 * x - y; }};
    const TempFolder t;
    write_gdal(t / "a.tif", "GTiff", "Float32", grid);
    write_exr(t / "a.exr", grid, "Y", 2.0f);
    write_gdal(t / "a.png", "PNG", "UInt16", grid);
    write_gdal(t / "a.asc", "AAIGrid", "Float32", grid);
    std::vector<Bytes> seeds;
    for (uint8_t kind = 0; kind < 4; ++kind) seeds.push_back(seed_of(kind, t / k_names[kind]));
    // An HGT is known by its size: a few of its bytes change, or it is refused.
    seeds.emplace_back(size_t{1201} * 1201 * 2 + 1, uint8_t{4});
    // Raw: width, height, bits, flags, then samples.
    Bytes raw = {5, 33, 21, 16, 0};
    for (int i = 0; i < 33 * 21; ++i) raw.insert(raw.end(), {static_cast<uint8_t>(i), static_cast<uint8_t>(i >> 8)});
    seeds.push_back(raw);
    return seeds;
}

} // namespace

} // namespace sahel::fuzz

SAHEL_FUZZ_TARGET(dem, dem_seeds) {
    using namespace sahel;
    if (bytes.empty()) return;
    const size_t kind = bytes[0] % k_names.size();
    std::span<const uint8_t> body = bytes.subspan(1);
    DemSourceOptions options;
    if (kind == 5 && body.size() >= 4) {
        options.raw = {.width = static_cast<int8_t>(body[0]),
                       .height = body[1],
                       .bits = body[2],
                       .is_signed = (body[3] & 1) != 0,
                       .is_float = (body[3] & 2) != 0,
                       .big_endian = (body[3] & 4) != 0,
                       .header_bytes = body[3] & 8};
        if (body[3] & 16) options.range = DemRange{0.0, 900.0};
        body = body.subspan(4);
    }
    const std::filesystem::path path = scratch_folder() / k_names[kind];
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(body.data()), static_cast<std::streamsize>(body.size()));
    const auto source = open_dem(path, options);
    if (!source.ok()) return expect_one_line(source.error());
    const DemSourceInfo& info = (*source)->info();
    expect(info.width > 0 && info.height > 0, "an open model has cells");
    std::vector<double> heights(64 * 64);
    const int64_t w = std::min<int64_t>(64, info.width), h = std::min<int64_t>(64, info.height);
    for (const auto& [x, y] : {std::pair<int64_t, int64_t>{0, 0},
                               {info.width - w, info.height - h},
                               {(info.width - w) / 2, (info.height - h) / 2}}) {
        const Status read = (*source)->read({x, y, x + w, y + h}, heights.data());
        if (!read.ok()) return expect_one_line(read.error());
        for (int64_t i = 0; i < w * h; ++i)
            expect(std::isnan(heights[static_cast<size_t>(i)]) || std::abs(heights[static_cast<size_t>(i)]) < 16384.0,
                   "heights are heights or nothing");
    }
}
