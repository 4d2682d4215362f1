#include "tools/command.h"
#include "tools/experiments/experiment.h"
#include "world/file_io.h"
#include "world/params_cli.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <memory>

namespace sahel::tools {

namespace {

namespace fs = std::filesystem;
using namespace sahel::experiments;

struct Options {
    std::vector<std::string> names;
    std::string out = "experiments";
    int size = 0;
    int64_t steps = 0;
    std::string part;
    ParamOverrides<WindParams> wind;
    ParamOverrides<SandParams> sand;
    bool quick = false, json = false, list = false;
};

int list_them(bool json) {
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    for (const Experiment& e : experiments::experiments()) {
        if (json)
            all.push_back({{"name", e.name},
                           {"shows", e.shows},
                           {"source", e.source},
                           {"quick", {{"size_cells", e.quick.size_cells}, {"steps", e.quick.steps}}},
                           {"full", {{"size_cells", e.full.size_cells}, {"steps", e.full.steps}}}});
        else
            fmt::print("{:<14} {}\n{:<14} {}\n", e.name, e.shows, "", e.source);
    }
    if (json) fmt::print("{}\n", all.dump(2));
    return 0;
}

Status write_files(const fs::path& folder, const Experiment& e, const Setup& setup, const Report& report) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) return Error{ErrorKind::io, fmt::format("experiment --out {}: {}", folder.string(), error.message())};
    const std::string text = report_json(e, setup, report).dump(2) + "\n";
    SAHEL_TRY(write_file(folder / (std::string(e.name) + ".json"), text));
    SAHEL_ASSIGN(const Image sheet, report_sheet(e, report));
    return write_png(folder / (std::string(e.name) + ".png"), sheet,
                     {{"Title", std::string(e.name)}, {"Description", report_text(e, setup, report)}},
                     k_png_level_small);
}

int run(const Options& o) {
    if (o.list) return list_them(o.json);
    std::vector<const Experiment*> chosen;
    for (const std::string& name : o.names) {
        if (name == "all") {
            for (const Experiment& e : experiments::experiments()) chosen.push_back(&e);
            continue;
        }
        const Experiment* e = experiment_named(name);
        if (!e)
            return fail(Error{ErrorKind::usage,
                              fmt::format("experiment {}: no such experiment; see sahel experiment --list", name)});
        chosen.push_back(e);
    }
    if (chosen.empty()) return fail(Error{ErrorKind::usage, "experiment: give a name, or --list to see them"});
    nlohmann::ordered_json reports = nlohmann::ordered_json::array();
    bool all_hold = true;
    for (const Experiment* e : chosen) {
        Setup setup;
        setup.quick = o.quick;
        setup.part = o.part;
        setup.wind = o.wind;
        setup.sand = o.sand;
        setup.extent = extent_of(*e, o.quick, o.size, o.steps);
        const double start = now_s();
        Result<Report> report = [&] {
            ProgressBar bar{std::string(e->name)};
            setup.progress = [&](double share, const std::string& what) {
                bar.update(static_cast<int64_t>(share * 1000.0), 1000, what);
            };
            return run_experiment(*e, setup);
        }();
        if (!report.ok()) return fail(report.error());
        if (const Status s = write_files(o.out, *e, setup, *report); !s.ok()) return fail(s.error());
        all_hold = all_hold && report->holds();
        if (o.json) {
            nlohmann::ordered_json j = report_json(*e, setup, *report);
            j["seconds"] = now_s() - start;
            j["picture"] = (fs::path(o.out) / (std::string(e->name) + ".png")).string();
            reports.push_back(std::move(j));
        } else {
            fmt::print("{}  {:.1f} s; picture {}\n", report_text(*e, setup, *report), now_s() - start,
                       (fs::path(o.out) / (std::string(e->name) + ".png")).string());
            std::fflush(stdout);
        }
    }
    if (o.json) fmt::print("{}\n", (reports.size() == 1 ? reports[0] : reports).dump(2));
    return all_hold ? 0 : 1;
}

} // namespace

void add_experiment_command(CommandLine& line) {
    auto o = std::make_shared<Options>();
    CLI::App& app =
        line.add("experiment", "Figures and tables of the papers: picture, numbers, verdict", [=] { return run(*o); });
    app.add_option("name", o->names, "One or more experiments, or all");
    app.add_option("--out", o->out, "Folder for NAME.png and NAME.json")->capture_default_str();
    app.add_option("--size", o->size,
                   "Cells along the side of the domain, a multiple of 64 (default: the experiment's)")
        ->check(CLI::Range(64, 8192));
    app.add_option("--steps", o->steps, "Steps of each run (default: the experiment's)")
        ->check(CLI::Range(int64_t{40}, int64_t{10000000}));
    app.add_option("--part", o->part, "Only the parts whose names contain this (dunes: barchans, star, ...)");
    app.add_flag("--quick", o->quick, "Scaled down: seconds instead of minutes");
    app.add_flag("--list", o->list, "List the experiments");
    app.add_flag("--json", o->json, "Report as JSON");
    add_params_options(app, "wind", o->wind); // what an experiment sets itself is changed too
    add_params_options(app, "sand", o->sand);
}

} // namespace sahel::tools
