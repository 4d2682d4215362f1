#include "sim/avalanche.h"

#include "sim/avalanche_donors.h"
#include "sim/avalanche_ground.h"
#include "sim/avalanche_runner.h"

#include <algorithm>
#include <utility>

namespace sahel {

namespace {

constexpr int32_t k_reach = 2; ///< halo cells that a sweep uses up

// Everything about one call.
struct Slide {
    TileDomain& domain;
    const SandParams& params;
    AvalancheKind kind;
    int sweeps;
    SlideBorders borders;
    SlideGround ground;
    SlideRunner& runner;
    AvalancheStats stats;
};

Status exchange_stale(TileDomain& d, SimLayerSet layers) {
    SimLayerSet stale;
    layers.for_each([&](SimLayer l) {
        if (d.valid_halo(l) < d.halo()) stale.insert(l);
    });
    return stale.empty() ? Status{} : d.exchange(stale);
}

SlideRule rule_of(const Slide& s, int n) {
    SlideRule rule;
    const bool soft = n % s.params.avalanche_soft_every == 0 || n >= s.sweeps - s.params.avalanche_soft_last;
    if (s.kind != AvalancheKind::sand || soft) rule.strength = s.params.avalanche_strength;
    return rule;
}

// A fixed number of sweeps of the donor rule, between two planes.
Status fixed_sweeps(Slide& s) {
    using Part = SlideRunner::Part;
    TileDomain& d = s.domain;
    const TileDomain& read = d;
    const SimLayer moving = moving_layer(s.kind);
    const SimLayer received = received_layer(s.kind, s.params);
    s.stats.sweeps = s.sweeps;
    SAHEL_ASSIGN(const bool may_slide, s.runner.may_slide({s.ground, 0}));
    if (!may_slide) {
        s.stats.quiet = true;
        return {};
    }
    SimLayer now = moving;
    SimLayer next = SimLayer::surface_next;
    if (s.sweeps > 1 || d.on_device()) { // from here on both planes agree in every block that is left out
        SAHEL_TRY(s.runner.copy(read.ints(now), d.ints(next), Part::all));
        d.set_valid_halo(next, d.halo());
    }
    for (int n = 0; n < s.sweeps; ++n) {
        if (d.valid_halo(now) < k_reach) {
            SAHEL_TRY(d.exchange({now}));
            SAHEL_TRY(s.runner.copy(read.ints(now), d.ints(next), Part::halo));
            SAHEL_TRY(s.runner.halo_changed());
        }
        const int32_t margin = d.valid_halo(now) - k_reach;
        s.ground.set_sliding(read.ints(now));
        SlideSweep sweep{s.ground, rule_of(s, n), d.ints(next), {}};
        if (received != moving) sweep.taken = d.ints(received);
        SAHEL_TRY(s.runner.sweep(n, margin, sweep));
        if (d.keeps_flows())
            SAHEL_TRY(s.runner.border_flows(d.border_flows(received), SlideDonor{sweep.ground, sweep.rule}));
        d.set_valid_halo(next, margin);
        if (s.borders.any_open) SAHEL_TRY(d.fill_edges({next}));
        std::swap(now, next);
    }
    if (received != moving) d.touch({received});
    if (now != moving) {
        SAHEL_TRY(s.runner.copy(read.ints(now), d.ints(moving), Part::last_sweep));
        d.set_valid_halo(moving, d.valid_halo(now));
        if (s.borders.any_open) SAHEL_TRY(d.fill_edges({moving}));
    }
    SAHEL_ASSIGN(const bool slid, s.runner.slid(s.sweeps - 1));
    s.stats.quiet = !slid;
    return {};
}

Status clear_flows(Slide& s) {
    Status status;
    k_slide_flow_layers.for_each([&](SimLayer l) {
        if (status.ok()) status = s.runner.zero(s.domain.ints(l));
        s.domain.set_valid_halo(l, s.domain.halo());
    });
    return status;
}

// Sweeps with inertia until nothing slides. Between calls the flows of all owned cells are 0.
Status sweeps_until_quiet(Slide& s, const SlideInertia& rule) {
    TileDomain& d = s.domain;
    s.stats.sweeps = 1;
    SAHEL_ASSIGN(const bool may_slide, s.runner.may_slide({s.ground, rule.start_ticks}));
    if (!may_slide) {
        s.stats.quiet = true;
        return {};
    }
    if (d.valid_halo(SimLayer::slide_e) == k_nothing_valid) SAHEL_TRY(clear_flows(s));
    SimLayerSet walked = k_slide_flow_layers;
    walked.insert(SimLayer::sand);
    SAHEL_TRY(exchange_stale(d, walked));
    const SlideFlows flows = slide_flows(d, s.ground, rule);
    const SlideApply apply = slide_apply(d, s.ground);
    for (int n = 0; n < s.sweeps && !s.stats.quiet; ++n) {
        if (d.valid_halo(SimLayer::sand) < k_reach) {
            SAHEL_TRY(d.exchange(walked));
            SAHEL_TRY(s.runner.halo_changed());
        }
        const int32_t margin = d.valid_halo(SimLayer::sand) - k_reach;
        SAHEL_TRY(s.runner.flows(n, margin + 1, flows)); // what reaches a cell at the margin starts one cell beyond
        s.stats.sweeps = n + 1;
        if (s.runner.known(n)) {
            SAHEL_ASSIGN(const bool slid, s.runner.slid(n));
            s.stats.quiet = !slid;
        }
        if (s.stats.quiet) break;
        if (d.keeps_flows())
            SAHEL_TRY(s.runner.border_flows(d.border_flows(SimLayer::sand),
                                            SlideFlowDonor{flows.e, flows.se, flows.s, flows.sw}));
        SAHEL_TRY(s.runner.apply(margin, apply));
        walked.for_each([&](SimLayer l) { d.set_valid_halo(l, margin); });
        if (s.borders.any_open) SAHEL_TRY(d.fill_edges({SimLayer::sand}));
    }
    while (s.stats.quiet && s.stats.sweeps > 1) { // the first sweep in which nothing slid
        SAHEL_ASSIGN(const bool slid, s.runner.slid(s.stats.sweeps - 2));
        if (slid || s.runner.known(s.stats.sweeps - 2)) break;
        s.stats.sweeps -= 1;
    }
    if (!s.stats.quiet) SAHEL_TRY(clear_flows(s));
    if (s.borders.any_wall) d.touch({SimLayer::sand}); // what lies behind walls was not worked out
    d.touch(k_slide_flow_layers);
    return {};
}

} // namespace

SimLayerSet avalanche_layers() {
    SimLayerSet layers = k_slide_flow_layers;
    layers.insert(SimLayer::surface_next);
    return layers;
}

uint64_t avalanche_bytes(uint64_t slots) {
    return Buffer::taken_bytes(2 * slots);
}

Status avalanche(TileDomain& domain, const SandParams& params, double cell_m, AvalancheKind kind,
                 const AvalancheOptions& options, AvalancheStats* stats) {
    const bool until_quiet = kind == AvalancheKind::sand && params.avalanche_sweeps == 0;
    const int sweeps = kind == AvalancheKind::soil      ? params.soil_sweeps
                       : kind == AvalancheKind::bedrock ? params.bedrock_sweeps
                       : until_quiet                    ? params.avalanche_max_sweeps
                                                        : params.avalanche_sweeps;
    if (stats) *stats = {};
    if (sweeps <= 0) return {};
    if (domain.halo() < k_reach) return Error{ErrorKind::usage, "avalanches need halos of at least 2 cells"};
    SAHEL_ASSIGN(const SlideBorders borders, SlideBorders::of(domain));
    SAHEL_TRY(exchange_stale(domain, slide_inputs(domain, kind)));
    SAHEL_ASSIGN(const std::unique_ptr<SlideRunner> runner, SlideRunner::make(domain, options.adaptive, sweeps));
    Slide s{domain, params, kind, sweeps, borders, slide_ground(domain, borders, params, cell_m, kind), *runner, {}};
    SAHEL_TRY(until_quiet ? sweeps_until_quiet(s, slide_inertia(params, cell_m)) : fixed_sweeps(s));
    if (!stats) return {};
    *stats = s.stats;
    stats->cells_all = stats->sweeps * domain.owned_cells();
    SAHEL_ASSIGN(stats->cells_swept, runner->cells());
    return {};
}

} // namespace sahel
