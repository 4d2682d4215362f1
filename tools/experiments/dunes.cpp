#include "tools/experiments/dune_kinds.h"

#include <array>

/// Seven kinds of dunes side by side, each under the wind and supply that makes it.
namespace sahel::experiments {

Result<Report> run_dunes(const Setup& setup) {
    Report report;
    report.columns = 3;
    report.picture_px = 512;
    struct Kind {
        const char* name;
        Status (*run)(const Setup&, Stretch, Report&);
        double work;
    };
    constexpr std::array<Kind, 7> k_kinds = {{{"barchans", barchans, 1.0},
                                              {"transverse", transverse_dunes, 1.0},
                                              {"linear", linear_dunes, 2.0},
                                              {"star", star_dunes, 2.0},
                                              {"nabkhas", nabkhas, 0.5},
                                              {"echo", echo_dune, 0.5},
                                              {"obstacle", dunes_round_obstacle, 1.0}}};
    double total = 0.0;
    for (const Kind& k : k_kinds) total += setup.wants(k.name) ? k.work : 0.0;
    double done = 0.0;
    for (const Kind& k : k_kinds) {
        if (!setup.wants(k.name)) continue;
        SAHEL_TRY(k.run(setup, {done / total, k.work / total}, report));
        done += k.work;
    }
    return report;
}

} // namespace sahel::experiments
