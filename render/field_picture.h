#pragma once

#include "render/png_io.h"

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>

/// Pictures of fields from above, drawn by the processor: ground lit by a low sun, and any field in colours with a
/// scale bar. Row 0 of a field is the top of the picture; small fields are enlarged by whole factors.
///
/// Colours of the ground follow the published programs (Desertscape method 3.16): sand where it lies 1 m thick, bedrock
/// where there is none, linear between; resistant rock is darker; then plants and objects; overlays (wind shadow, echo
/// classes) by half, each only if the alpha of its colour is above one half. The light is not theirs: a warm sun from
/// the north-west, cast shadows with a soft edge, and a blue sky that sees less of hollows.
namespace sahel {

using FieldColour = std::array<float, 4>; ///< RGBA, sRGB, 0 to 1

struct GroundColours {
    FieldColour sand{0.9f, 0.8f, 0.6f, 1.0f};
    FieldColour bedrock{0.5f, 0.5f, 0.5f, 1.0f};
    FieldColour soil{0.55f, 0.35f, 0.2f, 1.0f};
    FieldColour water{0.1f, 0.4f, 1.0f, 1.0f};
    FieldColour vegetation{0.25f, 0.75f, 0.25f, 1.0f};
    FieldColour object{0.75f, 0.25f, 0.75f, 1.0f};
    FieldColour shadow{1.0f, 0.25f, 0.25f, 0.0f};
    FieldColour erosion{0.0f, 0.0f, 1.0f, 0.0f};
    FieldColour sticky{1.0f, 1.0f, 0.0f, 0.0f};
};

/// Columns of width x height cells, row after row. Empty ones count as 0 (bedrock must be there).
struct GroundFields {
    int width = 0;
    int height = 0;
    double cell_m = 1.0;
    bool periodic = true; ///< else the ground goes on as it ends
    std::span<const float> bedrock_m, soil_m, sand_m, water_m;
    std::span<const float> vegetation, resistance, wind_shadow, echo;
    std::span<const uint8_t> object;
};

struct SunLight {
    float azimuth_deg = 315.0f; ///< where it stands: 0 north (top), 90 east
    float elevation_deg = 28.0f;
    float exaggeration = 0.0f; ///< of heights; 0: by the slopes, from 1 to 5, so that low dunes can be read too
};

/// Lit ground, RGBA, one pixel or a square of pixels a cell.
Image make_ground_picture(const GroundFields& fields, const GroundColours& colours = {}, const SunLight& sun = {},
                          int least_side_px = 512);

enum class FieldPalette {
    viridis, ///< dark blue to yellow: lightness grows evenly
    sand,    ///< dark brown to pale yellow
    water,   ///< pale to deep blue
    balance  ///< blue, white, red around 0
};
std::array<uint8_t, 3> palette_colour(FieldPalette palette, float t);

struct FieldPictureOptions {
    std::string title{};
    std::string unit{};
    FieldPalette palette = FieldPalette::viridis;
    std::optional<float> low{},
        high{};      ///< else the 0.5 and the 99.5 per cent quantile; balance: alike on both sides of 0
    bool bar = true; ///< a strip below with title, colours and three values
    int least_side_px = 512;
};

/// One field in colours. Not-a-number is grey.
Image make_field_picture(std::span<const float> values, int width, int height, const FieldPictureOptions& options = {});

/// Wind: its speed in colours, arrows along it, longest where it is fastest.
Image make_wind_picture(std::span<const float> wind_x, std::span<const float> wind_y, int width, int height,
                        const FieldPictureOptions& options = {});

} // namespace sahel
