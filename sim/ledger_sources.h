#pragma once

#include <array>
#include <cstdint>
#include <string_view>

/// Everything that may add to the conserved amounts of a world or take from them, by name. What is not listed here is a
/// transfer (it crosses a border) or a conversion (rock becomes sand), and those add up to zero.
namespace sahel {

enum class LedgerSource : uint8_t {
    inbox,          ///< waited at the tile while it slept
    supply_added,   ///< sand that a scene supplies
    supply_removed, ///< sand that it takes away: negative
    count_
};
inline constexpr int k_ledger_source_count = static_cast<int>(LedgerSource::count_);
inline constexpr std::array<std::string_view, k_ledger_source_count> k_ledger_source_names = {"inbox", "supply_added",
                                                                                              "supply_removed"};

} // namespace sahel
