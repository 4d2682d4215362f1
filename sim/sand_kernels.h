#pragma once

#include "sim/border_flows.h"
#include "sim/echo.h"
#include "sim/ground_pass.h"
#include "sim/pass.h"
#include "sim/reptation.h"
#include "sim/saltation.h"
#include "sim/supply.h"
#include "sim/wind_shadow.h"
#include "world/cpu_features.h"

#include <cstdint>

/// The launchers behind sand_passes.h: on the host for both instruction sets (sand_rows.cpp, sand_hop_rows.cpp), and
/// for CUDA (sand_cuda.cu).
namespace sahel {

// -------------------------------
SAHEL_ISA_DECLARE(void run_ground(const Launch& l, const GroundPass& f))
SAHEL_ISA_DECLARE(void run_wind_shadow(const Launch& l, const WindShadowPass& f))
SAHEL_ISA_DECLARE(void run_cliff(const Launch& l, const CliffPass& f))
SAHEL_ISA_DECLARE(void run_echo(const Launch& l, const EchoPass& f))
SAHEL_ISA_DECLARE(void run_no_echo(const Launch& l, const NoEchoPass& f))
SAHEL_ISA_DECLARE(void run_lift(const Launch& l, const LiftPass& f))
SAHEL_ISA_DECLARE(void run_hop_leg(const Launch& l, const HopLegPass& f))
SAHEL_ISA_DECLARE(void run_deposit(const Launch& l, const DepositPass& f))
SAHEL_ISA_DECLARE(void run_smooth(const Launch& l, const SmoothPass& f))
SAHEL_ISA_DECLARE(void run_apply_smooth(const Launch& l, const ApplySmoothPass& f))
SAHEL_ISA_DECLARE(void run_repose(const Launch& l, const ReposePass& f))
SAHEL_ISA_DECLARE(void run_covered(const Launch& l, const CoveredPass& f))
SAHEL_ISA_DECLARE(void run_supply(const Launch& l, const SupplyPass& f))

namespace cuda {
Status run_ground(const Launch& l, const GroundPass& f);
Status run_wind_shadow(const Launch& l, const WindShadowPass& f);
Status run_cliff(const Launch& l, const CliffPass& f);
Status run_echo(const Launch& l, const EchoPass& f);
Status run_no_echo(const Launch& l, const NoEchoPass& f);
Status run_lift(const Launch& l, const LiftPass& f);
Status run_hop_leg(const Launch& l, const HopLegPass& f);
Status run_deposit(const Launch& l, const DepositPass& f);
Status run_smooth(const Launch& l, const SmoothPass& f);
Status run_apply_smooth(const Launch& l, const ApplySmoothPass& f);
Status run_repose(const Launch& l, const ReposePass& f);
Status run_covered(const Launch& l, const CoveredPass& f);
Status run_supply(const Launch& l, const SupplyPass& f);
/// Donors of border_flows.h.
Status add_flows(int32_t slots, const BorderFlowsView& view, int32_t reach, const HopLegPass& f);
Status add_flows(int32_t slots, const BorderFlowsView& view, int32_t reach, const SmoothPass& f);
} // namespace cuda

} // namespace sahel
