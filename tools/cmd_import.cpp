#include "tools/command.h"
#include "world/dem_import.h"
#include "world/params_cli.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <memory>
#include <optional>

namespace sahel::tools {

namespace {

struct Options {
    std::string world;
    std::vector<std::string> files;
    DemImportOptions import;
    ParamOverrides<DemCoverParams> cover;
    std::vector<double> range;
    std::optional<double> sea_m, outside_m;
    std::string raw, endian = "little", memory = "512MiB";
    bool json = false;
};

/// "1024x768x16": width, height and bits of a file without a header.
Status parse_raw(const std::string& text, RawLayout& raw) {
    long long width = 0, height = 0;
    int bits = 16;
    char end = 0;
    const int n = std::sscanf(text.c_str(), "%lldx%lldx%d%c", &width, &height, &bits, &end);
    if ((n != 2 && n != 3) || width < 1 || height < 1 || (bits != 8 && bits != 16 && bits != 32))
        return Error{ErrorKind::usage,
                     fmt::format("--raw {}: write WIDTHxHEIGHT or WIDTHxHEIGHTxBITS (8, 16, 32)", text)};
    raw.width = width;
    raw.height = height;
    raw.bits = bits;
    return {};
}

int run(Options& o) {
    DemImportOptions& import = o.import;
    if (o.range.size() == 2) import.source.range = DemRange{o.range[0], o.range[1]};
    import.sea_m = o.sea_m;
    import.outside_m = o.outside_m;
    if (!o.raw.empty())
        if (const Status s = parse_raw(o.raw, import.source.raw); !s.ok()) return fail(s.error());
    import.source.raw.big_endian = o.endian == "big";
    auto memory = parse_bytes(o.memory);
    if (!memory.ok()) return fail(memory.error());
    import.memory_bytes = *memory;
    o.cover.apply(import.cover);
    const std::vector<std::filesystem::path> files(o.files.begin(), o.files.end());
    ProgressBar bar("import");
    auto done = import_dem(o.world, files, import, [&](std::string_view stage, double fraction) {
        bar.update(static_cast<int64_t>(fraction * 1000.0), 1000, std::string(stage));
        return true;
    });
    if (!done.ok()) return fail(done.error());
    nlohmann::ordered_json report;
    for (const DemFileReport& f : done->files)
        report[f.path.filename().string()] =
            fmt::format("{} {}, {} x {}, {:.2f} to {:.2f} m", f.format, f.type, f.width, f.height, f.min_m, f.max_m);
    report["projection"] = done->projection_name.empty() ? "none" : done->projection_name;
    report["cells"] = fmt::format("{} x {} of {} m", done->width, done->height, done->cell_m);
    report["heights_m"] = fmt::format("{:.2f} to {:.2f}", done->min_m, done->max_m);
    report["filled_cells"] = done->filled_cells;
    report["uncovered_cells"] = done->uncovered_cells;
    report["sea_cells"] = done->sea_cells;
    report["tiles"] = done->tiles;
    report["seconds"] = done->seconds;
    for (const std::string& note : done->notes) report["note"] = note;
    print_report(report, o.json);
    return 0;
}

} // namespace

void add_import_command(CommandLine& line) {
    auto o = std::make_shared<Options>();
    CLI::App& app =
        line.add("import", "Make a world of elevation models: GeoTIFF, HGT, EXR, PNG, RAW and what GDAL reads",
                 [=] { return run(*o); });
    app.add_option("WORLD", o->world, "Folder to make")->required();
    app.add_option("FILE", o->files, "Elevation models; several are joined, the first goes on top")->required();
    app.add_option("--cell", o->import.cell_m, "Side of a cell, m; 0: as in the finest file")->capture_default_str();
    app.add_option("--datum", o->import.datum_m, "Height of the files that becomes 0, m")->capture_default_str();
    app.add_option("--sea", o->sea_m, "Sea level as a height of the files, m");
    app.add_option("--outside", o->outside_m, "Height of the plain around the data, m");
    app.add_option("--tile", o->import.tile_cells, "Cells along a tile's side")->capture_default_str();
    app.add_option("--name", o->import.name, "Name of the world");
    app.add_option("--range", o->range, "Heights of the least and greatest stored value, m: for 8-bit and 0..1 files")
        ->expected(2);
    app.add_option("--raw", o->raw, "Layout of a file without a header: WIDTHxHEIGHT[xBITS]");
    app.add_option("--endian", o->endian, "Byte order of such a file")
        ->check(CLI::IsMember({"little", "big"}))
        ->capture_default_str();
    app.add_flag("--signed", o->import.source.raw.is_signed, "Its samples are signed");
    app.add_option("--crs", o->import.source.crs, "Coordinate system of files that name none, for example EPSG:32611");
    app.add_option("--source-cell", o->import.source.source_cell_m, "Cell side of files that do not say, m");
    app.add_option("--nodata", o->import.source.nodata, "Stored value that means nothing is known");
    app.add_option("--memory", o->memory, "Memory to use")->capture_default_str();
    app.add_flag("--json", o->json, "Report as JSON");
    add_params_options(app, "cover", o->cover);
}

} // namespace sahel::tools
