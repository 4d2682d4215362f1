#include "tools/experiments/dune_kinds.h"

#include <array>

/// Seven kinds of dunes side by side, each under the wind and supply that makes it.
namespace sahel::experiments {

Result<Report> run_dunes(const Setup& setup) {
    Report report;
    report.columns = 3;
    report.picture_px = 512;
    struct Kind {
        Status (*run)(const Setup&, Stretch, Report&);
        double work;
    };
    constexpr std::array<Kind, 7> k_kinds = {{{barchans, 1.0},
                                              {transverse_dunes, 1.0},
                                              {linear_dunes, 2.0},
                                              {star_dunes, 2.0},
                                              {nabkhas, 0.5},
                                              {echo_dune, 0.5},
                                              {dunes_round_obstacle, 1.0}}};
    double total = 0.0;
    for (const Kind& k : k_kinds) total += k.work;
    double done = 0.0;
    for (const Kind& k : k_kinds) {
        SAHEL_TRY(k.run(setup, {done / total, k.work / total}, report));
        done += k.work;
    }
    return report;
}

} // namespace sahel::experiments
