#pragma once

#include "world/layers.h"

#include <array>
#include <bit>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string_view>

/// Every column of cells that a simulation pass reads or writes, declared once. The conserved ones are layers of the
/// world; the others are given by a scene or the plants, or are recomputed by passes and never stored.
namespace sahel {

enum class SimLayer : uint8_t {
    // conserved, in ticks: the layers of the ledger
    bedrock,
    soil,
    sand,
    water,
    sediment,
    airborne_sand,
    moisture,
    // given
    mask,
    vegetation,
    resistance,
    object,
    // working, float32
    wind_x,
    wind_y,
    wind_shadow,
    cliff,
    echo,
    hopping,
    hopping_next,
    bounce,
    repose,
    // working planes of avalanching (avalanche.h)
    surface,
    surface_next,
    slide_e,
    slide_se,
    slide_s,
    slide_sw,
    count_
};
inline constexpr int k_sim_layer_count = static_cast<int>(SimLayer::count_);

/// What a cell beyond an open border holds: the value of the nearest cell inside (a ground that goes on as it ends), or
/// nothing (nothing comes in), or a number so far below nothing that a sum with it cannot be above (for pairs of cells
/// whose flow depends on both: nothing crosses). Beyond a frozen border "nothing" and "sealed" hold too, and all else
/// is what was loaded.
enum class Outside : uint8_t { as_edge, nothing, sealed };
inline constexpr uint32_t k_sealed_bits = 0xE0AD78ECu; ///< of the float -1e20

/// A wall mirrors the world: a component of a vector changes its sign there.
enum class Mirror : uint8_t { even, odd_x, odd_y };

enum class SimRole : uint8_t {
    conserved, ///< state, counted by the ledger
    given,     ///< input, constant while passes run
    working    ///< made by passes from the others
};

struct SimLayerInfo {
    SimLayer layer;
    std::string_view name;
    std::string_view unit;
    LayerType type;
    SimRole role;
    Outside outside;
    Mirror mirror;
    std::optional<Layer> world; ///< the stored layer it is loaded from and committed to
    std::string_view help;
};

// clang-format off
inline constexpr std::array<SimLayerInfo, k_sim_layer_count> k_sim_layers = {{
    {SimLayer::bedrock,       "bedrock",       "m",   LayerType::ticks, SimRole::conserved, Outside::as_edge, Mirror::even,  Layer::bedrock,       "Height of the rock surface above the datum"},
    {SimLayer::soil,          "soil",          "m",   LayerType::ticks, SimRole::conserved, Outside::as_edge, Mirror::even,  Layer::soil,          "Thickness of soil on the rock"},
    {SimLayer::sand,          "sand",          "m",   LayerType::ticks, SimRole::conserved, Outside::as_edge, Mirror::even,  Layer::sand,          "Thickness of loose sand on the soil"},
    {SimLayer::water,         "water",         "m",   LayerType::ticks, SimRole::conserved, Outside::as_edge, Mirror::even,  Layer::water,         "Depth of standing or flowing water"},
    {SimLayer::sediment,      "sediment",      "m",   LayerType::ticks, SimRole::conserved, Outside::as_edge, Mirror::even,  Layer::sediment,      "Sediment suspended in the water"},
    {SimLayer::airborne_sand, "airborne_sand", "m",   LayerType::ticks, SimRole::conserved, Outside::nothing, Mirror::even,  Layer::airborne_sand, "Sand carried by the wind"},
    {SimLayer::moisture,      "moisture",      "m",   LayerType::ticks, SimRole::conserved, Outside::as_edge, Mirror::even,  Layer::moisture,      "Water held by the ground"},
    {SimLayer::mask,          "mask",          "",    LayerType::flags, SimRole::given,     Outside::as_edge, Mirror::even,  Layer::mask,          "Bits of the world's mask layer"},
    {SimLayer::vegetation,    "vegetation",    "",    LayerType::real,  SimRole::given,     Outside::as_edge, Mirror::even,  std::nullopt,         "Density of plants, 0 to 1"},
    {SimLayer::resistance,    "resistance",    "",    LayerType::real,  SimRole::given,     Outside::as_edge, Mirror::even,  std::nullopt,         "Resistance of bedrock to abrasion, 0 to 1"},
    {SimLayer::object,        "object",        "",    LayerType::flags, SimRole::given,     Outside::as_edge, Mirror::even,  std::nullopt,         "1 on a solid object, else 0"},
    {SimLayer::wind_x,        "wind_x",        "m/s", LayerType::real,  SimRole::working,   Outside::as_edge, Mirror::odd_x, Layer::wind_x,        "Wind towards +x"},
    {SimLayer::wind_y,        "wind_y",        "m/s", LayerType::real,  SimRole::working,   Outside::as_edge, Mirror::odd_y, Layer::wind_y,        "Wind towards +y"},
    {SimLayer::wind_shadow,   "wind_shadow",   "",    LayerType::real,  SimRole::working,   Outside::as_edge, Mirror::even,  Layer::wind_shadow,   "Shelter from the wind, 0 to 1"},
    {SimLayer::cliff,         "cliff",         "m",   LayerType::real,  SimRole::working,   Outside::nothing, Mirror::even,  std::nullopt,         "Height of the cliff whose top edge this is, 0: none"},
    {SimLayer::echo,          "echo",          "",    LayerType::real,  SimRole::working,   Outside::as_edge, Mirror::even,  Layer::echo,          "Above 0: sticky fraction; below 0: erosion; 0: neither"},
    {SimLayer::hopping,       "hopping",       "m",   LayerType::ticks, SimRole::working,   Outside::nothing, Mirror::even,  std::nullopt,         "Airborne sand that is carried in this step"},
    {SimLayer::hopping_next,  "hopping_next",  "m",   LayerType::ticks, SimRole::working,   Outside::nothing, Mirror::even,  std::nullopt,         "The same after one leg of its way"},
    {SimLayer::bounce,        "bounce",        "m/s", LayerType::real,  SimRole::working,   Outside::sealed,  Mirror::even,  std::nullopt,         "Sand that bounced, as thickness per second"},
    {SimLayer::repose,        "repose",        "m/m", LayerType::real,  SimRole::working,   Outside::as_edge, Mirror::even,  std::nullopt,         "Tangent of the angle of repose of sand"},
    {SimLayer::surface,       "surface",       "m",   LayerType::ticks, SimRole::working,   Outside::as_edge, Mirror::even,  std::nullopt,         "Top of the ground"},
    {SimLayer::surface_next,  "surface_next",  "m",   LayerType::ticks, SimRole::working,   Outside::as_edge, Mirror::even,  std::nullopt,         "What avalanches, after the sweep"},
    {SimLayer::slide_e,       "slide_e",       "m",   LayerType::ticks, SimRole::working,   Outside::nothing, Mirror::even,  std::nullopt,         "Sand sliding from a cell to its eastern neighbour, negative: from there"},
    {SimLayer::slide_se,      "slide_se",      "m",   LayerType::ticks, SimRole::working,   Outside::nothing, Mirror::even,  std::nullopt,         "The same, south-eastern neighbour"},
    {SimLayer::slide_s,       "slide_s",       "m",   LayerType::ticks, SimRole::working,   Outside::nothing, Mirror::even,  std::nullopt,         "The same, southern neighbour"},
    {SimLayer::slide_sw,      "slide_sw",      "m",   LayerType::ticks, SimRole::working,   Outside::nothing, Mirror::even,  std::nullopt,         "The same, south-western neighbour"},
}};
// clang-format on

namespace detail {
constexpr bool sim_layer_table_in_order() {
    for (size_t i = 0; i < k_sim_layers.size(); ++i)
        if (static_cast<size_t>(k_sim_layers[i].layer) != i) return false;
    return true;
}
} // namespace detail
static_assert(detail::sim_layer_table_in_order(), "k_sim_layers must list every SimLayer in order");

constexpr const SimLayerInfo& info_of(SimLayer layer) {
    return k_sim_layers[static_cast<size_t>(layer)];
}

/// A set of simulation layers, in table order.
class SimLayerSet {
  public:
    constexpr SimLayerSet() = default;
    constexpr SimLayerSet(std::initializer_list<SimLayer> layers) {
        for (const SimLayer l : layers) insert(l);
    }
    constexpr void insert(SimLayer l) { bits_ |= 1u << static_cast<unsigned>(l); }
    constexpr void insert(SimLayerSet s) { bits_ |= s.bits_; }
    [[nodiscard]] constexpr bool contains(SimLayer l) const { return (bits_ >> static_cast<unsigned>(l)) & 1u; }
    [[nodiscard]] constexpr bool contains(SimLayerSet s) const { return (bits_ & s.bits_) == s.bits_; }
    [[nodiscard]] constexpr bool empty() const { return bits_ == 0; }
    [[nodiscard]] constexpr int size() const { return std::popcount(bits_); }
    template <class F> constexpr void for_each(F&& f) const {
        for (int i = 0; i < k_sim_layer_count; ++i)
            if (contains(static_cast<SimLayer>(i))) f(static_cast<SimLayer>(i));
    }
    friend constexpr bool operator==(SimLayerSet, SimLayerSet) = default;

  private:
    uint32_t bits_ = 0;
};
static_assert(k_sim_layer_count <= 32);

/// The amounts that the ledger accounts for, tick by tick.
inline constexpr SimLayerSet k_conserved_layers = [] {
    SimLayerSet set;
    for (const auto& info : k_sim_layers)
        if (info.role == SimRole::conserved) set.insert(info.layer);
    return set;
}();
inline constexpr int k_conserved_count = k_conserved_layers.size();

/// The layer of that name, for field names in scene files, debug views and export.
std::optional<SimLayer> sim_layer_named(std::string_view name);

} // namespace sahel
