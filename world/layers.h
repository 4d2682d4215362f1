#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <string_view>

/// The layer table: every column of cells a world has is declared here once; allocation, the store, export and the
/// debug views are all made from it.
namespace sahel {

/// 1 tick = 2^-17 m = 7.63 um; an int32 of ticks spans +-16384 m. Conserved amounts are whole ticks, so that sums
/// commute and mass is exact.
inline constexpr int k_tick_bits = 17;
inline constexpr float k_ticks_per_m = 131072.0f;
inline constexpr float k_m_per_tick = 1.0f / 131072.0f;

enum class LayerType : uint8_t {
    ticks, ///< int32, 2^-17 m
    real,  ///< float32
    flags  ///< int32, bits; mip filter takes the most fine cell's bits by "or"
};

/// How a cell of the next coarser level is made from its four cells.
enum class LodFilter : uint8_t { mean, any_bit };

enum class Layer : uint8_t {
    // conserved, in ticks
    bedrock,
    soil,
    sand,
    water,
    sediment,
    airborne_sand,
    moisture,
    // flags
    mask,
    // region weights of the base terrain, 0..1 (wetness: about -1..1)
    mountain,
    dune,
    canyon,
    wetness,
    // what the wind did in the last step that was simulated; zero where there was none
    wind_x,
    wind_y,
    wind_shadow,
    echo,
    count_
};
inline constexpr int k_layer_count = static_cast<int>(Layer::count_);

enum class LayerRole : uint8_t {
    state,  ///< of the world: stored, hashed, in the ledger
    shown,  ///< stored with the state of a tile, to look at; no part of the world's hash
    derived ///< made anew when asked for
};

struct LayerInfo {
    Layer layer;
    std::string_view name;
    std::string_view unit;
    LayerType type;
    LayerRole role;
    LodFilter lod_filter;
    std::string_view help;
};

// clang-format off
inline constexpr std::array<LayerInfo, k_layer_count> k_layers = {{
    {Layer::bedrock,       "bedrock",       "m", LayerType::ticks, LayerRole::state,    LodFilter::mean,    "Height of the rock surface above the datum"},
    {Layer::soil,          "soil",          "m", LayerType::ticks, LayerRole::state,    LodFilter::mean,    "Thickness of soil on the rock"},
    {Layer::sand,          "sand",          "m", LayerType::ticks, LayerRole::state,    LodFilter::mean,    "Thickness of loose sand on the soil"},
    {Layer::water,         "water",         "m", LayerType::ticks, LayerRole::state,    LodFilter::mean,    "Depth of standing or flowing water"},
    {Layer::sediment,      "sediment",      "m", LayerType::ticks, LayerRole::state,    LodFilter::mean,    "Sediment suspended in the water"},
    {Layer::airborne_sand, "airborne_sand", "m", LayerType::ticks, LayerRole::state,    LodFilter::mean,    "Sand carried by the wind"},
    {Layer::moisture,      "moisture",      "m", LayerType::ticks, LayerRole::state,    LodFilter::mean,    "Water held by the ground"},
    {Layer::mask,          "mask",          "",  LayerType::flags, LayerRole::state,    LodFilter::any_bit, "Bit 0: filled because the source had no data; bit 1: sea; bit 2: outside the source"},
    {Layer::mountain,      "mountain",      "",  LayerType::real,  LayerRole::derived, LodFilter::mean,    "Weight of the mountain region"},
    {Layer::dune,          "dune",          "",  LayerType::real,  LayerRole::derived, LodFilter::mean,    "Weight of the dune region"},
    {Layer::canyon,        "canyon",        "",  LayerType::real,  LayerRole::derived, LodFilter::mean,    "Weight of the canyon region"},
    {Layer::wetness,       "wetness",       "",  LayerType::real,  LayerRole::derived, LodFilter::mean,    "Wetness of climate and ground, about -1 to 1"},
    {Layer::wind_x,        "wind_x",        "m/s", LayerType::real, LayerRole::shown,   LodFilter::mean, "Wind of the last step towards the east"},
    {Layer::wind_y,        "wind_y",        "m/s", LayerType::real, LayerRole::shown,   LodFilter::mean, "Wind of the last step towards the south"},
    {Layer::wind_shadow,   "wind_shadow",   "",  LayerType::real,  LayerRole::shown,   LodFilter::mean,  "Shelter from that wind, 0 to 1"},
    {Layer::echo,          "echo",          "",  LayerType::real,  LayerRole::shown,   LodFilter::mean,  "Before cliffs: above 0 sand stays, below 0 the wind digs"},
}};
// clang-format on

namespace detail {
constexpr bool layer_table_in_order() {
    for (int i = 0; i < k_layer_count; ++i)
        if (static_cast<int>(k_layers[i].layer) != i) return false;
    return true;
}
} // namespace detail
static_assert(detail::layer_table_in_order(), "k_layers must list every Layer in order");

constexpr const LayerInfo& info_of(Layer layer) {
    return k_layers[static_cast<size_t>(layer)];
}

/// A set of layers, in table order.
class LayerSet {
  public:
    constexpr LayerSet() = default;
    constexpr LayerSet(std::initializer_list<Layer> layers) {
        for (const Layer l : layers) insert(l);
    }
    constexpr void insert(Layer l) { bits_ |= 1u << static_cast<unsigned>(l); }
    [[nodiscard]] constexpr bool contains(Layer l) const { return (bits_ >> static_cast<unsigned>(l)) & 1u; }
    [[nodiscard]] constexpr bool contains(LayerSet s) const { return (bits_ & s.bits_) == s.bits_; }
    [[nodiscard]] constexpr LayerSet united(LayerSet s) const { return LayerSet(bits_ | s.bits_); }
    [[nodiscard]] constexpr LayerSet intersected(LayerSet s) const { return LayerSet(bits_ & s.bits_); }
    [[nodiscard]] constexpr bool empty() const { return bits_ == 0; }
    [[nodiscard]] constexpr int size() const { return __builtin_popcount(bits_); }
    [[nodiscard]] constexpr uint32_t bits() const { return bits_; }
    template <class F> constexpr void for_each(F&& f) const {
        for (int i = 0; i < k_layer_count; ++i)
            if (contains(static_cast<Layer>(i))) f(static_cast<Layer>(i));
    }
    friend constexpr bool operator==(LayerSet, LayerSet) = default;

  private:
    constexpr explicit LayerSet(uint32_t bits) : bits_(bits) {}
    uint32_t bits_ = 0;
};
static_assert(k_layer_count <= 32);

constexpr LayerSet layers_of(LayerRole role) {
    LayerSet set;
    for (const auto& info : k_layers)
        if (info.role == role) set.insert(info.layer);
    return set;
}
/// What a world is: what is hashed.
inline constexpr LayerSet k_state_layers = layers_of(LayerRole::state);
/// What a tile's file holds.
inline constexpr LayerSet k_stored_layers = k_state_layers.united(layers_of(LayerRole::shown));

/// The four materials the surface is made of, bottom to top.
inline constexpr LayerSet k_surface_layers{Layer::bedrock, Layer::soil, Layer::sand, Layer::water};

/// Region weights of the base terrain.
inline constexpr LayerSet k_weight_layers{Layer::mountain, Layer::dune, Layer::canyon, Layer::wetness};

/// Bits of Layer::mask.
inline constexpr int32_t k_mask_filled = 1;
inline constexpr int32_t k_mask_sea = 2;
inline constexpr int32_t k_mask_outside = 4;

} // namespace sahel
