#pragma once

#include "render/hud.h"

#include <imgui.h>

#include <cstdint>
#include <string>

/// The single panels; each draws the inside of an open ImGui window. Used by hud.cpp.
namespace sahel::hud {

/// The last frame times, for the curve.
struct FrameCurve {
    static constexpr int k_frames = 160;
    std::array<float, k_frames> ms{};
    int next = 0;
    int count = 0;
    void add(float frame_ms);
    [[nodiscard]] float percentile(float share) const;
    [[nodiscard]] float mean() const;
};

struct MapView {
    double width_m = 0.0; ///< 0: follows the height of the eye
    ImTextureID picture = nullptr;
};

struct BookmarkEdit {
    std::optional<size_t> renaming;
    std::array<char, 201> name{};
    bool focus = false;
};

void draw_stats(const HudModel& model, const FrameCurve& curve, float scale);
void draw_map(const HudModel& model, HudControls& controls, MapView& view, float scale);
void draw_controls(const HudModel& model, HudControls& controls, HudEvents& events, float scale);
void draw_bookmarks(const HudModel& model, BookmarkEdit& edit, HudEvents& events, float scale);
void draw_help(float scale);

/// "name" at the left, the value at the right edge.
void row(const char* name, const std::string& value);
/// 1234567 -> "1.23 M".
std::string short_count(double value);
std::string short_bytes(uint64_t bytes);
std::string short_length(double metres);

inline const ImVec4 k_accent{0.93f, 0.66f, 0.32f, 1.0f}; // sand in evening light
inline const ImVec4 k_dim{0.72f, 0.70f, 0.66f, 1.0f};

} // namespace sahel::hud
