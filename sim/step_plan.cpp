#include "sim/step_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace sahel {

namespace {

int32_t& of(HaloState& state, SimLayer layer) {
    return state[static_cast<size_t>(layer)];
}

// Layers whose present content some pass of the list reads before it is made anew.
SimLayerSet still_needed(std::span<const PassDecl> passes, size_t from) {
    SimLayerSet needed;
    SimLayerSet made;
    for (size_t j = from; j < passes.size(); ++j) {
        for (const LayerRead& read : passes[j].reads)
            if (!made.contains(read.layer)) needed.insert(read.layer);
        made.insert(passes[j].writes);
    }
    return needed;
}

} // namespace

Result<StepPlan> StepPlan::make(std::span<const PassDecl> passes, int32_t halo, const HaloState& initial) {
    StepPlan plan;
    HaloState valid = initial;
    for (size_t j = 0; j < passes.size(); ++j) {
        const PassDecl& pass = passes[j];
        SAHEL_CHECK(pass.sound());
        bool short_of = false;
        for (const LayerRead& read : pass.reads) {
            if (read.radius > halo)
                return Error{
                    ErrorKind::usage,
                    fmt::format("pass '{}' reads {} within {} cells, but halos are {} cells wide: choose a halo of "
                                "at least {}",
                                pass.name, info_of(read.layer).name, read.radius, halo, read.radius)};
            if (of(valid, read.layer) == k_nothing_valid)
                return Error{ErrorKind::usage,
                             fmt::format("pass '{}' reads {}, which nothing has written: load it first", pass.name,
                                         info_of(read.layer).name)};
            short_of = short_of || of(valid, read.layer) < read.radius;
        }
        if (short_of) {
            SimLayerSet stale;
            still_needed(passes, j).for_each([&](SimLayer l) {
                if (of(valid, l) >= 0 && of(valid, l) < halo) {
                    stale.insert(l);
                    of(valid, l) = halo;
                }
            });
            plan.ops_.push_back({PlanOp::Kind::exchange, stale, 0, 0});
        }
        int32_t margin = halo;
        for (const LayerRead& read : pass.reads) margin = std::min(margin, of(valid, read.layer) - read.radius);
        pass.writes.for_each([&](SimLayer l) { of(valid, l) = margin; });
        plan.ops_.push_back({PlanOp::Kind::pass, {}, static_cast<int32_t>(j), margin});
    }
    HaloState owed{}; // halo cells of each layer that what follows will read
    for (auto op = plan.ops_.rbegin(); op != plan.ops_.rend(); ++op) {
        if (op->kind == PlanOp::Kind::exchange) {
            op->layers.for_each([&](SimLayer l) { of(owed, l) = 0; });
            continue;
        }
        const PassDecl& pass = passes[static_cast<size_t>(op->pass)];
        int32_t margin = 0;
        pass.writes.for_each([&](SimLayer l) {
            margin = std::max(margin, of(owed, l));
            of(owed, l) = 0;
        });
        SAHEL_CHECK_LE(margin, op->margin);
        op->margin = margin;
        for (const LayerRead& read : pass.reads)
            of(owed, read.layer) = std::max(of(owed, read.layer), margin + read.radius);
    }
    return plan;
}

int32_t StepPlan::exchanges() const {
    return static_cast<int32_t>(
        std::count_if(ops_.begin(), ops_.end(), [](const PlanOp& op) { return op.kind == PlanOp::Kind::exchange; }));
}

double StepPlan::redundancy(int32_t n) const {
    double owned = 0.0;
    double all = 0.0;
    for (const PlanOp& op : ops_) {
        if (op.kind == PlanOp::Kind::exchange) continue;
        const double side = n + 2.0 * op.margin;
        owned += double{static_cast<double>(n)} * n;
        all += side * side;
    }
    return owned > 0.0 ? all / owned - 1.0 : 0.0;
}

std::string StepPlan::text(std::span<const PassDecl> passes) const {
    std::string out;
    for (const PlanOp& op : ops_) {
        if (op.kind == PlanOp::Kind::pass) {
            out += fmt::format("{} +{}\n", passes[static_cast<size_t>(op.pass)].name, op.margin);
            continue;
        }
        out += "exchange";
        op.layers.for_each([&](SimLayer l) { out += fmt::format(" {}", info_of(l).name); });
        out += '\n';
    }
    return out;
}

Status run_passes(TileDomain& domain, std::span<const Pass> passes) {
    std::vector<PassDecl> decls;
    decls.reserve(passes.size());
    for (const Pass& pass : passes) decls.push_back(pass.decl);
    SAHEL_ASSIGN(const StepPlan plan, StepPlan::make(decls, domain.halo(), domain.valid_halo()));
    for (const PlanOp& op : plan.ops()) {
        if (op.kind == PlanOp::Kind::exchange) {
            SAHEL_TRY(domain.exchange(op.layers));
            continue;
        }
        const Pass& pass = passes[static_cast<size_t>(op.pass)];
        const Launch& launch = domain.launch(op.margin, pass.decl.name.data());
        SAHEL_TRY(pass.run({domain, launch, op.margin}));
        // No exchange ever brings what is derived in frozen cells: the whole of them at once.
        if (pass.decl.derives() && domain.plan().has_frozen())
            SAHEL_TRY(pass.run({domain, domain.frozen_launch(pass.decl.name.data()), domain.halo()}));
        SAHEL_TRY(domain.fill_edges(pass.decl.writes));
        pass.decl.writes.for_each([&](SimLayer l) { domain.set_valid_halo(l, op.margin); });
    }
    return {};
}

} // namespace sahel
