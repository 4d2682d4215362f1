#include "streaming/region_run.h"
#include "tools/command.h"
#include "tools/report_ledger.h"
#include "world/world.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <memory>

namespace sahel::tools {

namespace {

struct Options {
    std::string world;
    bool json = false;
    bool accept_edits = false;
};

int run_info(const Options& o) {
    auto world = World::open(o.world, OpenMode::read);
    if (!world.ok()) return fail(world.error());
    auto info = world->info();
    if (!info.ok()) return fail(info.error());
    const WorldDesc& desc = world->desc();
    nlohmann::ordered_json report;
    report["name"] = desc.name;
    report["folder"] = world->folder().string();
    report["preset"] = desc.preset;
    report["seed"] = desc.seed;
    report["tile_cells"] = desc.tile_cells;
    report["cell_m"] = desc.cell_m;
    report["step"] = info->step;
    report["tiles"] = info->tile_count;
    report["parent_tiles"] = info->parent_count;
    const CellRect& b = info->bounds;
    report["bounds_cells"] = info->tile_count ? fmt::format("{},{} to {},{}", b.x0, b.y0, b.x1, b.y1) : "none stored";
    if (info->tile_count) {
        report["min_surface_m"] = info->min_surface_m;
        report["max_surface_m"] = info->max_surface_m;
    }
    if (o.json)
        report["disk_bytes"] = info->disk_bytes;
    else
        report["disk"] = human_bytes(info->disk_bytes);
    if (desc.sea_m) report["sea_m"] = *desc.sea_m;
    if (desc.georeference) {
        report["origin"] = fmt::format("{:.3f}, {:.3f}", desc.georeference->origin_x, desc.georeference->origin_y);
        report["datum_m"] = desc.georeference->datum_m;
    }
    auto ledger = read_world_ledger(*world);
    if (!ledger.ok()) return fail(ledger.error());
    if (!ledger->book.tiles().empty()) {
        if (o.json) {
            nlohmann::ordered_json json = ledger_json(ledger->book, ledger->check, true);
            for (const SimLayer layer : k_ledger_layers)
                json["waiting"][std::string(info_of(layer).name)] = ledger->waiting[ledger_index(layer)];
            report["ledger"] = std::move(json);
        } else {
            report["simulated_tiles"] = ledger->book.tiles().size();
        }
    }
    print_report(report, o.json);
    if (!o.json) fmt::print("{}", ledger_text(ledger->book, &ledger->waiting));
    if (!ledger->check.closed()) return fail({ErrorKind::corrupt, o.world + ": " + ledger->check.text});
    return 0;
}

int run_hash(const Options& o) {
    auto world = World::open(o.world, OpenMode::read);
    if (!world.ok()) return fail(world.error());
    auto hash = world->hash();
    if (!hash.ok()) return fail(hash.error());
    fmt::print("{}\n", *hash);
    return 0;
}

int run_verify(const Options& o) {
    auto world = World::open(o.world, o.accept_edits ? OpenMode::write : OpenMode::read);
    if (!world.ok()) return fail(world.error());
    if (o.accept_edits)
        if (const Status s = world->accept_description(); !s.ok()) return fail(s.error());
    ProgressBar bar("verify");
    auto report = world->verify([&](int64_t done, int64_t total) { bar.update(done, total); });
    if (!report.ok()) return fail(report.error());
    if (report->issues.empty()) { // what is as it was written must also add up
        auto wrong = verify_world_ledger(*world);
        if (!wrong.ok()) return fail(wrong.error());
        for (const std::string& what : *wrong) report->issues.push_back({"index.sqlite", what, false});
    }
    nlohmann::ordered_json out;
    out["files_checked"] = report->files_checked;
    out["bytes_checked"] = report->bytes_checked;
    out["issues"] = nlohmann::ordered_json::array();
    for (const VerifyIssue& issue : report->issues)
        out["issues"].push_back({{"path", issue.path}, {"what", issue.what}, {"can_regenerate", issue.can_regenerate}});
    if (o.json) {
        print_report(out, true);
    } else {
        for (const VerifyIssue& issue : report->issues)
            fmt::print("{}: {}{}\n", issue.path, issue.what, issue.can_regenerate ? " (can be regenerated)" : "");
        fmt::print("{} files, {}: {}\n", report->files_checked, human_bytes(report->bytes_checked),
                   report->issues.empty() ? "all as written" : fmt::format("{} problems", report->issues.size()));
    }
    return report->issues.empty() ? 0 : 1;
}

} // namespace

void add_inspect_commands(CommandLine& line) {
    const auto add = [&](const char* name, const char* help, int (*body)(const Options&), bool json) {
        auto options = std::make_shared<Options>();
        CLI::App& app = line.add(name, help, [=] { return body(*options); });
        app.add_option("WORLD", options->world, "World folder")->required();
        if (json) app.add_flag("--json", options->json, "Report as JSON");
        if (std::string_view(name) == "verify")
            app.add_flag("--accept-edits", options->accept_edits,
                         "world.json was edited on purpose: take it as it is now");
    };
    add("info", "What a world holds: seed, tiles, bounds, step, size on disk", run_info, true);
    add("hash", "One line: the hash of all stored state, independent of the tile size", run_hash, false);
    add("verify", "Re-read every file and row of a world and say what is damaged", run_verify, true);
}

} // namespace sahel::tools
