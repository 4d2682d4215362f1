#include "render/hud_panels.h"

#include "render/keys.h"
#include "world/params.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace sahel::hud {

void FrameCurve::add(float frame_ms) {
    ms[static_cast<size_t>(next)] = frame_ms;
    next = (next + 1) % k_frames;
    count = std::min(count + 1, k_frames);
}
float FrameCurve::percentile(float share) const {
    if (count == 0) return 0.0f;
    std::vector<float> sorted(ms.begin(), ms.begin() + count);
    std::sort(sorted.begin(), sorted.end());
    return sorted[static_cast<size_t>(std::lround(share * static_cast<float>(count - 1)))];
}
float FrameCurve::mean() const {
    float sum = 0.0f;
    for (int i = 0; i < count; ++i) sum += ms[static_cast<size_t>(i)];
    return count > 0 ? sum / static_cast<float>(count) : 0.0f;
}

std::string short_count(double value) {
    const double a = std::abs(value);
    if (a >= 1e9) return fmt::format("{:.2f} G", value / 1e9);
    if (a >= 1e6) return fmt::format("{:.2f} M", value / 1e6);
    if (a >= 1e4) return fmt::format("{:.1f} k", value / 1e3);
    return fmt::format("{:.0f}", value);
}
std::string short_bytes(uint64_t bytes) {
    const auto b = static_cast<double>(bytes);
    if (bytes >= uint64_t{1} << 30) return fmt::format("{:.2f} GiB", b / 1073741824.0);
    if (bytes >= uint64_t{1} << 20) return fmt::format("{:.1f} MiB", b / 1048576.0);
    return fmt::format("{:.0f} KiB", b / 1024.0);
}
std::string short_length(double metres) {
    if (std::abs(metres) >= 10000.0) return fmt::format("{:.1f} km", metres / 1000.0);
    return fmt::format("{:.1f} m", metres);
}

void row(const char* name, const std::string& value) {
    ImGui::TextDisabled("%s", name);
    const float width = ImGui::CalcTextSize(value.c_str()).x;
    ImGui::SameLine(std::max(ImGui::GetWindowContentRegionMax().x - width, ImGui::CalcTextSize(name).x + 16.0f));
    ImGui::TextUnformatted(value.c_str());
}

namespace {

void heading(const char* text) {
    ImGui::Spacing();
    ImGui::TextColored(k_accent, "%s", text);
    ImGui::Separator();
}

void draw_curve(const FrameCurve& curve, float scale) {
    const float width = ImGui::GetContentRegionAvail().x;
    const float height = 44.0f * scale;
    const ImVec2 at = ImGui::GetCursorScreenPos();
    ImGui::Dummy({width, height});
    ImDrawList* list = ImGui::GetWindowDrawList();
    list->AddRectFilled(at, {at.x + width, at.y + height}, IM_COL32(255, 255, 255, 18), 3.0f * scale);
    const float top = std::max(20.0f, curve.percentile(1.0f) * 1.15f);
    for (const float line_ms : {1000.0f / 60.0f, 1000.0f / 24.0f}) {
        if (line_ms > top) continue;
        const float y = at.y + height * (1.0f - line_ms / top);
        list->AddLine({at.x, y}, {at.x + width, y}, IM_COL32(255, 255, 255, 40));
    }
    const float bar = width / FrameCurve::k_frames;
    for (int i = 0; i < curve.count; ++i) {
        // The newest frame stands at the right.
        const int index = (curve.next - curve.count + i + FrameCurve::k_frames) % FrameCurve::k_frames;
        const float ms = curve.ms[static_cast<size_t>(index)];
        const float x = at.x + width - static_cast<float>(curve.count - i) * bar;
        const float h = std::max(1.0f, height * std::min(1.0f, ms / top));
        const ImU32 colour = ms <= 1000.0f / 58.0f   ? IM_COL32(140, 190, 120, 255)
                             : ms <= 1000.0f / 24.0f ? IM_COL32(236, 180, 90, 255)
                                                     : IM_COL32(222, 98, 70, 255);
        list->AddRectFilled({x, at.y + height - h}, {x + std::max(bar - 0.4f, 1.0f), at.y + height}, colour);
    }
}

void draw_budget(const HudBudget& budget) {
    const float share = budget.limit > 0
                            ? static_cast<float>(static_cast<double>(budget.used) / static_cast<double>(budget.limit))
                            : 0.0f;
    row(budget.name.c_str(), budget.bytes ? short_bytes(budget.used) + " of " + short_bytes(budget.limit)
                                          : fmt::format("{} of {}", budget.used, budget.limit));
    ImGui::PushStyleColor(ImGuiCol_PlotHistogram, share > 0.95f ? ImVec4{0.87f, 0.38f, 0.27f, 1.0f} : k_accent);
    ImGui::ProgressBar(std::min(share, 1.0f), {-1.0f, ImGui::GetFontSize() * 0.28f}, "");
    ImGui::PopStyleColor();
}

} // namespace

void draw_stats(const HudModel& model, const FrameCurve& curve, float scale) {
    ImGui::TextColored(k_accent, "%s", model.title.c_str());
    if (!model.device.empty()) {
        ImGui::PushTextWrapPos();
        ImGui::TextDisabled("%s", model.device.c_str());
        ImGui::PopTextWrapPos();
    }
    draw_curve(curve, scale);
    const float mean = curve.mean();
    row("Frame", fmt::format("{:.1f} ms, {:.0f} a second", mean, mean > 0.0f ? 1000.0f / mean : 0.0f));
    row("99 % of frames below", fmt::format("{:.1f} ms", curve.percentile(0.99f)));
    row("Tiles, nodes", fmt::format("{}, {}", model.render.tiles, model.render.nodes));
    row("Triangles", short_count(model.render.triangles));
    if (model.render.terrain_ms + model.render.sky_ms + model.render.water_ms + model.render.post_ms > 0.0) {
        row("Passes", fmt::format("{:.1f}  {:.1f}  {:.1f}  {:.1f} ms", model.render.terrain_ms, model.render.sky_ms,
                                  model.render.water_ms, model.render.post_ms));
        if (ImGui::IsItemHovered()) ImGui::SetTooltip("Ground, sky, water, tone curve");
    }

    heading("Eye");
    const Vec3d& eye = model.pose.eye_m;
    row("East, south", fmt::format("{:.0f}, {:.0f} m", eye[0], eye[1]));
    row("Height, over ground", short_length(eye[2]) + ", " + short_length(eye[2] - model.ground_m));
    // Compass: 0 north, 90 east.
    const double compass = std::fmod(model.pose.yaw_deg + 450.0, 360.0);
    row("Heading, pitch", fmt::format("{:.0f} deg, {:+.0f} deg", compass, model.pose.pitch_deg));
    row(model.mode == MoveMode::walk ? "Walking at" : "Flying at", fmt::format("{:.3g} m/s", model.speed_m_per_s));

    heading("Streaming");
    const StreamStats& s = model.stream;
    const auto in_state = [&](NodeState state) { return s.nodes_in_state[static_cast<size_t>(state)]; };
    row("Wanted, drawn", fmt::format("{}, {}", s.wanted, s.visible));
    row("Parents standing in", fmt::format("{}", s.fallbacks));
    row("Queued, loading, loaded", fmt::format("{}, {}, {}", in_state(NodeState::queued), in_state(NodeState::loading),
                                               in_state(NodeState::loaded)));
    row("Published, evicted",
        short_count(static_cast<double>(s.published_total)) + ", " + short_count(static_cast<double>(s.evicted_total)));
    row("Oldest request", fmt::format("{} frames", s.oldest_request_frames));
    if (s.failed_total > 0) row("Failed loads", fmt::format("{}", s.failed_total));
    if (s.wanted_over_budget > 0) row("Wanted beyond the slots", fmt::format("{}", s.wanted_over_budget));
    for (const auto& [name, value] : model.rows) row(name.c_str(), value);

    if (!model.budgets.empty()) heading("Budgets");
    for (const HudBudget& budget : model.budgets) draw_budget(budget);
    if (model.lod_frozen) ImGui::TextColored(k_accent, "Level of detail is frozen (L)");
    if (model.time_paused) ImGui::TextColored(k_accent, "Time stands still (P)");
}

namespace {

/// Sliders for every number of a parameter struct, made from its table. Sets `let_go` when a slider was released.
template <class Struct> bool param_sliders(Struct& values, bool& let_go) {
    bool changed = false;
    for_each_field<Struct>([&](const auto& field) {
        using T = typename std::remove_cvref_t<decltype(field)>::value_type;
        const std::string name(field.name);
        std::string label = name;
        std::replace(label.begin(), label.end(), '_', ' ');
        for (const char* unit : {" deg", " per m", " m per s", " m"}) // the unit stands at the value
            if (const std::string_view u = unit; !field.unit.empty() && label.size() > u.size() && label.ends_with(u)) {
                label.resize(label.size() - u.size());
                break;
            }
        T& value = values.*field.member;
        ImGui::PushID(name.c_str());
        ImGui::TextDisabled("%s", label.c_str());
        if (ImGui::IsItemHovered())
            ImGui::SetTooltip("%s", fmt::format("{}\n{} ({})", field.help, field_text(field).range(), name).c_str());
        ImGui::SameLine(ImGui::GetWindowContentRegionMax().x * 0.46f);
        ImGui::SetNextItemWidth(-1.0f);
        if constexpr (std::is_same_v<T, bool>) {
            changed |= ImGui::Checkbox("##value", &value);
        } else if constexpr (std::is_same_v<T, float>) {
            // A wide range that starts at zero or above: small values need room.
            const bool wide = field.min >= 0.0f && field.max > 100.0f * std::max(field.min, field.max * 1e-4f) &&
                              (field.max >= 1000.0f || field.max < 0.1f || field.min > 0.0f);
            const int digits = field.max < 0.1f ? 6 : field.max <= 2.0f ? 2 : field.max <= 50.0f ? 1 : 0;
            const std::string format = fmt::format("%.{}f{}{}", digits, field.unit.empty() ? "" : " ", field.unit);
            changed |= ImGui::SliderFloat("##value", &value, field.min, field.max, format.c_str(),
                                          ImGuiSliderFlags_AlwaysClamp |
                                              (wide ? ImGuiSliderFlags_Logarithmic : ImGuiSliderFlags_None));
        } else if constexpr (std::is_integral_v<T>) {
            int whole = static_cast<int>(value);
            changed |= ImGui::SliderInt("##value", &whole, static_cast<int>(field.min), static_cast<int>(field.max));
            value = static_cast<T>(whole);
        }
        if (ImGui::IsItemHovered() && !ImGui::IsItemActive())
            ImGui::SetTooltip("%s", fmt::format("{}\n{}", field.help, field_text(field).range()).c_str());
        let_go |= ImGui::IsItemDeactivatedAfterEdit();
        ImGui::PopID();
    });
    return changed;
}

} // namespace

void draw_controls(const HudModel& model, HudControls& controls, HudEvents& events, float scale) {
    (void)model;
    ImGui::TextDisabled("Picture");
    ImGui::SameLine(ImGui::GetWindowContentRegionMax().x * 0.46f);
    ImGui::SetNextItemWidth(-1.0f);
    if (ImGui::BeginCombo("##view", controls.view == DebugView::none ? "as it is" : name_of(controls.view))) {
        for (int i = 0; i < static_cast<int>(DebugView::count_); ++i) {
            const auto view = static_cast<DebugView>(i);
            if (ImGui::Selectable(view == DebugView::none ? "as it is" : name_of(view), view == controls.view))
                controls.view = view;
        }
        ImGui::EndCombo();
    }
    ImGui::TextDisabled("Wireframe");
    ImGui::SameLine(ImGui::GetWindowContentRegionMax().x * 0.46f);
    ImGui::Checkbox("##wireframe", &controls.wireframe);

    heading("Sun and air");
    const auto presets = atmosphere_presets();
    const float third = (ImGui::GetContentRegionAvail().x - 2.0f * ImGui::GetStyle().ItemSpacing.x) / 3.0f;
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, {0.0f, ImGui::GetStyle().FramePadding.y});
    for (size_t i = 0; i < presets.size(); ++i) {
        std::string name(presets[i].name);
        std::replace(name.begin(), name.end(), '_', ' ');
        if (i % 3 != 0) ImGui::SameLine();
        if (ImGui::Button(name.c_str(), {third, 0.0f})) {
            controls.atmosphere = presets[i].atmosphere;
            events.atmosphere_changed = events.sun_settled = true;
        }
    }
    ImGui::PopStyleVar();
    ImGui::Dummy({0.0f, 2.0f * scale});
    events.atmosphere_changed |= param_sliders(controls.atmosphere, events.sun_settled);
    heading("Ground");
    bool let_go = false;
    events.look_changed |= param_sliders(controls.look, let_go);
}

void draw_bookmarks(const HudModel& model, BookmarkEdit& edit, HudEvents& events, float scale) {
    if (ImGui::Button("Add this place", {-1.0f, 0.0f})) events.add_bookmark = true;
    if (model.bookmarks.empty()) {
        ImGui::PushTextWrapPos();
        ImGui::TextDisabled("None yet. B with 1 to 9 sets one here, 1 to 9 goes there.");
        ImGui::PopTextWrapPos();
    }
    const float cross = 22.0f * scale;
    for (size_t i = 0; i < model.bookmarks.size(); ++i) {
        ImGui::PushID(static_cast<int>(i));
        if (i < 9)
            ImGui::TextDisabled("%d", static_cast<int>(i) + 1);
        else
            ImGui::TextDisabled(" ");
        ImGui::SameLine(26.0f * scale);
        const float width = ImGui::GetContentRegionAvail().x - cross - ImGui::GetStyle().ItemSpacing.x;
        if (edit.renaming == i) {
            ImGui::SetNextItemWidth(width);
            if (edit.focus) ImGui::SetKeyboardFocusHere();
            edit.focus = false;
            const bool done =
                ImGui::InputText("##name", edit.name.data(), edit.name.size(),
                                 ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_AutoSelectAll);
            if (done && edit.name[0] != '\0') events.rename_bookmark = {i, std::string(edit.name.data())};
            if (done || ImGui::IsItemDeactivated()) edit.renaming.reset();
        } else {
            if (ImGui::Selectable(model.bookmarks[i].name.c_str(), false, ImGuiSelectableFlags_AllowDoubleClick,
                                  {width, 0.0f})) {
                if (ImGui::IsMouseDoubleClicked(0)) {
                    edit.renaming = i;
                    edit.focus = true;
                    edit.name.fill('\0');
                    std::strncpy(edit.name.data(), model.bookmarks[i].name.c_str(), edit.name.size() - 1);
                } else {
                    events.go_to_bookmark = i;
                }
            }
            if (ImGui::IsItemHovered()) ImGui::SetTooltip("Click: go there. Double click: rename.");
        }
        ImGui::SameLine();
        if (ImGui::Button("x", {cross, 0.0f})) events.remove_bookmark = i;
        ImGui::PopID();
    }
}

void draw_help(float scale) {
    ImGui::TextColored(k_accent, "Keys");
    ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - ImGui::CalcTextSize("F1 closes this").x);
    ImGui::TextDisabled("F1 closes this");
    ImGui::Separator();
    // Two columns of about the same length.
    ImGui::Columns(2, "keys", false);
    const auto table = key_table();
    const float key_width = 122.0f * scale; // from the column's left edge
    bool second = false;
    for (size_t i = 0; i < table.size(); ++i) {
        const KeyBinding& binding = table[i];
        if (i == 0 || binding.group != table[i - 1].group) {
            if (!second && i >= table.size() / 2) {
                second = true;
                ImGui::NextColumn();
            }
            ImGui::Spacing();
            ImGui::TextColored(k_accent, "%s", std::string(name_of(binding.group)).c_str());
        }
        ImGui::TextUnformatted(binding.shown.data(), binding.shown.data() + binding.shown.size());
        ImGui::SameLine(key_width);
        ImGui::TextDisabled("%s", std::string(binding.help).c_str());
    }
    ImGui::Columns(1);
}

} // namespace sahel::hud
