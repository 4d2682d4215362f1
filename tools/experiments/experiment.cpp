#include "tools/experiments/experiment.h"

#include <fmt/format.h>

#include <array>

namespace sahel::experiments {

namespace {

// clang-format off
constexpr std::array k_experiments = {
    Experiment{"columns",       "Sand columns fall to heaps at repose",                        "Paper, Figure 6; method 5.3",              {256, 0},    {1024, 0},    run_columns},
    Experiment{"dunes",         "Seven kinds of dunes under their winds",                      "Paper, Figures 1, 2, 5; method 5.5 E1, E2, E7", {256, 200}, {512, 1000}, run_dunes},
    Experiment{"bidirectional", "Two winds: crest angles by angle and cover",                  "Paper, Figure 3; method 5.4",              {128, 500},  {512, 2000},  run_bidirectional},
    Experiment{"migration",     "Small barchans overtake large ones",                          "Bagnold 1941; method 5.5",                 {256, 150},  {512, 300},   run_migration},
    Experiment{"reptation",     "Impacts smooth dunes, too many level them",                   "Paper, Figure 4; method 5.5 E6",           {128, 300},  {128, 300},   run_reptation},
    Experiment{"bilinear",      "Sampling between cells: cliffs, bent wind, short hops",       "Paper, Figure 7; method 5.5 E3, E4, E5",   {128, 100},  {512, 1000},  run_bilinear},
    Experiment{"shadow",        "Shelter along a line or along the bent wind",                 "Paper, Section 4.2; method 5.5 E8",        {128, 200},  {512, 1000},  run_shadow},
    Experiment{"venturi",       "Wind that grows with height gathers no sand when projected",  "Method 5.5 E9",                            {128, 100},  {512, 200},   run_venturi},
    Experiment{"abrasion",      "Blown sand wears rock and nothing is lost",                   "Paper, Section 4.4; method 5.5 E10",       {128, 200},  {512, 2000},  run_abrasion},
    Experiment{"vegetation",    "Plants hold sand and steepen dunes",                          "Paper, Figure 8; method 5.5 E7",           {128, 200},  {512, 1000},  run_vegetation},
    Experiment{"timestep",      "Half the step, the same landscape",                           "Method 6, W 3",                            {128, 100},  {256, 100},   run_timestep},
    Experiment{"guides",        "Whole runs against those of an independent implementation",   "Method 5.7",                               {128, 0},    {512, 1000},  run_guides},
};
// clang-format on

} // namespace

std::span<const Experiment> experiments() {
    return k_experiments;
}

const Experiment* experiment_named(std::string_view name) {
    for (const Experiment& e : k_experiments)
        if (e.name == name) return &e;
    return nullptr;
}

Extent extent_of(const Experiment& experiment, bool quick, int32_t size_cells, int64_t steps) {
    Extent extent = quick ? experiment.quick : experiment.full;
    if (size_cells > 0) extent.size_cells = size_cells;
    if (steps > 0) extent.steps = steps;
    return extent;
}

Result<Report> run_experiment(const Experiment& experiment, const Setup& setup) {
    const int32_t n = setup.extent.size_cells;
    if (n < 64 || n % 64 != 0)
        return Error{ErrorKind::usage,
                     fmt::format("experiment {}: a size of {} cells; write a multiple of 64", experiment.name, n)};
    return experiment.run(setup);
}

} // namespace sahel::experiments
