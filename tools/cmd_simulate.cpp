#include "streaming/region_run.h"
#include "tools/command.h"
#include "tools/report_ledger.h"
#include "world/executor.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <atomic>
#include <cmath>
#include <csignal>
#include <memory>
#include <optional>

namespace sahel::tools {

namespace {

struct Options {
    std::string world;
    std::string region;
    std::optional<int64_t> steps, until_step;
    std::string device = "auto", memory;
    int threads = 0;
    int32_t halo = 0;
    int64_t checkpoint = 0;
    std::vector<std::string> set;
    bool json = false;
};

std::atomic<int> g_signal{0};
static_assert(std::atomic<int>::is_always_lock_free); // it is set by a signal handler

/// While it lives, SIGINT and SIGTERM ask for an end; a second one ends the program as ever.
class StopOnSignal {
  public:
    StopOnSignal() {
        g_signal = 0;
        struct sigaction action = {};
        action.sa_handler = [](int signal) { g_signal = signal; };
        action.sa_flags = static_cast<int>(SA_RESETHAND) | SA_RESTART;
        sigaction(SIGINT, &action, &old_int_);
        sigaction(SIGTERM, &action, &old_term_);
    }
    StopOnSignal(const StopOnSignal&) = delete;
    StopOnSignal& operator=(const StopOnSignal&) = delete;
    ~StopOnSignal() {
        sigaction(SIGINT, &old_int_, nullptr);
        sigaction(SIGTERM, &old_term_, nullptr);
    }

  private:
    struct sigaction old_int_ = {}, old_term_ = {};
};

Error usage(std::string message) {
    return {ErrorKind::usage, std::move(message)};
}

/// The step to go to.
Result<int64_t> last_step(const Options& o, int64_t now) {
    if (o.steps.has_value() == o.until_step.has_value()) return usage("give --steps or --until-step, one of them");
    if (o.steps) {
        if (*o.steps < 1) return usage(fmt::format("--steps {}: at least 1", *o.steps));
        if (*o.steps > INT64_MAX - now) return usage(fmt::format("--steps {}: beyond the last number", *o.steps));
        return now + *o.steps;
    }
    if (*o.until_step <= now)
        return usage(fmt::format("--until-step {}: the world is at step {} already", *o.until_step, now));
    return *o.until_step;
}

int simulate(const Options& o) {
    RegionOptions run_options;
    auto region = parse_tile_rect(o.region);
    if (!region.ok()) return fail(region.error());
    run_options.region = *region;
    if (!o.memory.empty()) {
        auto bytes = parse_bytes(o.memory);
        if (!bytes.ok()) return fail(bytes.error());
        if (*bytes == 0) return fail(usage("--memory 0: nothing runs in no memory"));
        run_options.memory_bytes = *bytes;
    }
    if (o.halo < 0) return fail(usage(fmt::format("--halo {}: at least 0, which means choose", o.halo)));
    if (o.threads < 0 || o.threads > 4096)
        return fail(usage(fmt::format("--threads {}: from 0, which means one a core, to 4096", o.threads)));
    if (o.checkpoint < 0)
        return fail(usage(fmt::format("--checkpoint {}: at least 0, which means at the end", o.checkpoint)));
    run_options.device = o.device;
    run_options.halo = o.halo;
    run_options.checkpoint_steps = o.checkpoint;

    auto world = World::open(o.world, OpenMode::write);
    if (!world.ok()) return fail(world.error());
    auto info = world->info();
    if (!info.ok()) return fail(info.error());
    auto until = last_step(o, info->step);
    if (!until.ok()) return fail(until.error());
    auto simulation = simulation_of(world->desc(), (world->folder() / "world.json").string());
    if (!simulation.ok()) return fail(simulation.error());
    run_options.simulation = *simulation;
    for (const std::string& assignment : o.set)
        if (const Status s = set_simulation(run_options.simulation, assignment, "--set"); !s.ok())
            return fail(s.error());

    const StopOnSignal stop;
    set_thread_count(o.threads);
    auto run = RegionRun::open(*world, run_options);
    if (!run.ok()) return fail(run.error());
    const double cells = static_cast<double>(run->domain().owned_cells());
    const int64_t first = info->step;
    const double start_s = now_s();
    Result<bool> finished = false;
    {
        ProgressBar bar("simulate");
        finished = run->run(*until, [&](const RegionStep& s) {
            const double per_s = static_cast<double>(s.step - first) * cells / (now_s() - start_s);
            bar.update(s.step - first, *until - first,
                       fmt::format("step {} of {}, {:.1f} Mcells/s", s.step, *until, per_s * 1e-6));
            return g_signal == 0;
        });
    }
    if (!finished.ok()) return fail(finished.error());
    const double seconds = now_s() - start_s;
    auto hash = world->hash();
    if (!hash.ok()) return fail(hash.error());
    auto ledger = read_world_ledger(*world);
    if (!ledger.ok()) return fail(ledger.error());

    const auto steps = static_cast<double>(run->step() - first);
    nlohmann::ordered_json report;
    report["world"] = world->folder().string();
    report["region"] = o.region;
    report["device"] = run->domain().on_device() ? "cuda:0" : "cpu";
    report["halo"] = run->domain().halo();
    report["from_step"] = first;
    report["step"] = run->step();
    report["seconds"] = std::round(seconds * 1000.0) / 1000.0;
    report["ms_per_step"] = std::round(seconds * 1e6 / steps) / 1000.0;
    report["mcells_per_s"] = std::round(cells * steps / seconds * 1e-4) / 100.0;
    report["max_wind_m_per_s"] = run->stats().max_wind_m_per_s;
    report["avalanche_sweeps"] = run->stats().sand.sweeps;
    if (o.json)
        report["tiles_bytes"] = run->tiles_bytes();
    else
        report["memory"] = human_bytes(run->tiles_bytes());
    report["hash"] = *hash;
    if (o.json) {
        report["finished"] = *finished;
        report["ledger"] = ledger_json(run->ledger(), ledger->check, false);
        print_report(report, true);
    } else {
        print_report(report, false);
        fmt::print("{}", ledger_text(run->ledger(), nullptr));
    }
    if (!ledger->check.closed()) return fail({ErrorKind::corrupt, o.world + ": " + ledger->check.text});
    if (!*finished)
        return fail(
            {ErrorKind::io, fmt::format("{}: stopped at step {} of {}; the same command with --until-step {} goes "
                                        "on to the same result",
                                        o.world, run->step(), *until, *until)});
    return 0;
}

} // namespace

void add_simulate_command(CommandLine& line) {
    auto o = std::make_shared<Options>();
    CLI::App& app =
        line.add("simulate", "Let wind move the sand of a rectangle of tiles", [=] { return simulate(*o); });
    app.add_option("WORLD", o->world, "World folder")->required();
    app.add_option("--region", o->region, "Tiles X0,Y0,X1,Y1 of level 0; the last ones are not part of it")->required();
    app.add_option("--steps", o->steps, "Steps to make");
    app.add_option("--until-step", o->until_step, "Step of the world to go to");
    app.add_option("--device", o->device, "auto, cpu or cuda:0")->capture_default_str();
    app.add_option("--threads", o->threads, "Threads; 0: one a core")->capture_default_str();
    app.add_option("--halo", o->halo, "Cells around each tile that it computes again; 0: choose")
        ->capture_default_str();
    app.add_option("--memory", o->memory, "Memory that may be used, for example 4GiB; else what the machine has");
    app.add_option("--checkpoint", o->checkpoint, "Commit every so many steps; 0: at the end")->capture_default_str();
    app.add_option("--set", o->set, "A parameter other than in world.json, for this run: sand.lift_rate=0.5")
        ->expected(1)
        ->take_all();
    app.add_flag("--json", o->json, "Report as JSON");
    app.footer("SIGINT and SIGTERM stop after the running step: what was made is committed and the exit code is 1. The "
               "same command with --until-step goes on from there, to the same bits as if it had never stopped.");
}

} // namespace sahel::tools
