#pragma once

#include "sim/avalanche.h"
#include "sim/avalanche_rows.h"
#include "sim/pass.h"

#include <cstdint>
#include <vector>

/// The sweeps of avalanching as passes with declarations, and their launch on blocks of the host.
namespace sahel {

/// For sand the sweep of the donor rule, the flows with inertia, and what moves by them; for soil and rock the sweep.
/// `avalanche` itself does not run these one by one: it leaves out blocks and walks the halo on its own.
std::vector<Pass> avalanche_passes(AvalancheKind kind, const SandParams& params, double cell_m);

/// Runs a kernel on blocks of a domain on the host. Returns in which of them something slid.
std::vector<uint8_t> run_slides(const TileDomain& d, const std::vector<SlideWork>& work, const SlideProbe& f);
std::vector<uint8_t> run_slides(const TileDomain& d, const std::vector<SlideWork>& work, const SlideSweep& f);
std::vector<uint8_t> run_slides(const TileDomain& d, const std::vector<SlideWork>& work, const SlideFlows& f);
void run_slides(const TileDomain& d, const std::vector<SlideWork>& work, const SlideApply& f);

SlideFlows slide_flows(TileDomain& d, const SlideGround& ground, const SlideInertia& rule);
SlideApply slide_apply(TileDomain& d, const SlideGround& ground);

} // namespace sahel
