#pragma once

#include "sim/ledger.h"
#include "world/json_fwd.h"

#include <string>

/// The ledger for people and for programs. Ticks are 2^-17 m on one cell.
namespace sahel::tools {

/// One line a layer that was touched: what it was and is, sources, conversions, what went over borders, residual.
/// `waiting`: what lies in inboxes, or null.
std::string ledger_text(const LedgerBook& book, const std::array<int64_t, k_conserved_count>* waiting);
/// Layers, substances and residuals; with `tiles` also every tile and border.
Json ledger_json(const LedgerBook& book, const LedgerCheck& check, bool tiles);

} // namespace sahel::tools
