#include "render/hud_panels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sahel {

std::array<uint8_t, 4> colour_of(NodeState state) {
    switch (state) {
    case NodeState::absent:
        return {90, 90, 90, 255};
    case NodeState::queued:
        return {120, 130, 150, 255};
    case NodeState::loading:
        return {236, 180, 70, 255};
    case NodeState::loaded:
        return {150, 200, 255, 255};
    case NodeState::resident:
        return {120, 200, 110, 255};
    case NodeState::retry_later:
        return {230, 130, 60, 255};
    case NodeState::failed:
        return {230, 60, 60, 255};
    }
    return {255, 0, 255, 255};
}

namespace hud {

namespace {

ImU32 colour(NodeState state, float alpha) {
    const auto c = colour_of(state);
    return IM_COL32(c[0], c[1], c[2], static_cast<int>(255.0f * alpha));
}

/// World metres to the canvas: the eye in the middle, north up.
struct Canvas {
    ImVec2 corner;
    float side;
    double centre_x, centre_y, metres;
    [[nodiscard]] ImVec2 at(double x_m, double y_m) const {
        const double k = side / metres;
        return {corner.x + 0.5f * side + static_cast<float>((x_m - centre_x) * k),
                corner.y + 0.5f * side + static_cast<float>((y_m - centre_y) * k)};
    }
};

void draw_nodes(const HudModel& model, const Canvas& canvas, ImDrawList* list, bool with_picture) {
    // Coarse ones first, so that the finer ones lie on them.
    std::vector<NodeInfo> nodes = model.nodes;
    std::sort(nodes.begin(), nodes.end(), [](const NodeInfo& a, const NodeInfo& b) { return b.key < a.key; });
    for (const NodeInfo& node : nodes) {
        const double side = std::ldexp(model.cell_m * model.view_cells, node.key.level);
        const ImVec2 a = canvas.at(static_cast<double>(node.key.x) * side, static_cast<double>(node.key.y) * side);
        const ImVec2 b =
            canvas.at(static_cast<double>(node.key.x + 1) * side, static_cast<double>(node.key.y + 1) * side);
        const float pixels = b.x - a.x;
        if (b.x < canvas.corner.x || b.y < canvas.corner.y || a.x > canvas.corner.x + canvas.side ||
            a.y > canvas.corner.y + canvas.side || pixels < 2.0f)
            continue;
        if (node.drawn) list->AddRectFilled(a, b, colour(node.state, with_picture ? 0.16f : 0.34f));
        list->AddRect({a.x + 0.5f, a.y + 0.5f}, {b.x - 0.5f, b.y - 0.5f},
                      colour(node.state, node.state == NodeState::resident ? (node.drawn ? 0.9f : 0.30f) : 0.95f), 0.0f,
                      0, node.drawn || node.state != NodeState::resident ? 1.5f : 1.0f);
        if (node.drawn && pixels > 24.0f) {
            const std::string level = fmt::format("{}", node.key.level);
            list->AddText({a.x + 3.0f, a.y + 1.0f}, IM_COL32(255, 255, 255, 150), level.c_str());
        }
    }
}

void draw_eye(const HudModel& model, const Canvas& canvas, ImDrawList* list, float scale) {
    const ImVec2 eye = canvas.at(model.pose.eye_m[0], model.pose.eye_m[1]);
    const auto yaw = static_cast<float>(model.pose.yaw_deg * std::numbers::pi / 180.0);
    const auto half =
        static_cast<float>(std::atan(std::tan(model.pose.vertical_fov_deg * std::numbers::pi / 360.0) * 16.0 / 9.0));
    const float reach = 0.34f * canvas.side;
    const auto along = [&](float angle, float length) {
        return ImVec2{eye.x + std::cos(angle) * length, eye.y + std::sin(angle) * length};
    };
    list->AddTriangleFilled(eye, along(yaw - half, reach), along(yaw + half, reach), IM_COL32(255, 236, 200, 36));
    list->AddLine(eye, along(yaw - half, reach), IM_COL32(255, 236, 200, 120));
    list->AddLine(eye, along(yaw + half, reach), IM_COL32(255, 236, 200, 120));
    const float size = 8.0f * scale;
    const ImVec2 tip = along(yaw, size), left = along(yaw + 2.5f, size), right = along(yaw - 2.5f, size);
    list->AddTriangleFilled(tip, left, right, IM_COL32(255, 250, 240, 255));
    list->AddTriangle(tip, left, right, IM_COL32(20, 20, 20, 255), 1.0f);
}

void draw_legend(const HudModel& model, float scale) {
    struct Item {
        NodeState state;
        const char* name;
    };
    static constexpr Item k_items[] = {{NodeState::queued, "queued"},
                                       {NodeState::loading, "loading"},
                                       {NodeState::loaded, "loaded"},
                                       {NodeState::resident, "resident"},
                                       {NodeState::failed, "failed"}};
    ImDrawList* list = ImGui::GetWindowDrawList();
    bool first = true;
    for (const Item& item : k_items) {
        int count = model.stream.nodes_in_state[static_cast<size_t>(item.state)];
        if (item.state == NodeState::failed) {
            count += model.stream.nodes_in_state[static_cast<size_t>(NodeState::retry_later)];
            if (count == 0) continue;
        }
        const std::string text = fmt::format("{} {}", item.name, count);
        const float width = 12.0f * scale + ImGui::CalcTextSize(text.c_str()).x;
        if (!first) {
            ImGui::SameLine();
            if (ImGui::GetContentRegionAvail().x < width) ImGui::NewLine();
        }
        first = false;
        const ImVec2 at = ImGui::GetCursorScreenPos();
        const float box = 8.0f * scale;
        const float y = at.y + (ImGui::GetTextLineHeight() - box) / 2.0f;
        list->AddRectFilled({at.x, y}, {at.x + box, y + box}, colour(item.state, 1.0f));
        ImGui::SetCursorScreenPos({at.x + 12.0f * scale, at.y});
        ImGui::TextDisabled("%s", text.c_str());
    }
}

} // namespace

void draw_map(const HudModel& model, HudControls& controls, MapView& view, float scale) {
    const float bottom = 2.2f * ImGui::GetTextLineHeightWithSpacing() + ImGui::GetFrameHeightWithSpacing();
    const ImVec2 room = ImGui::GetContentRegionAvail();
    const float side = std::max(40.0f, std::min(room.x, room.y - bottom));
    const double over_ground = std::max(10.0, model.pose.eye_m[2] - model.ground_m);
    // The nearest tiles fill a good part of the map at any height.
    const double fitting = std::max(model.view_cells * model.cell_m * 6.0, 24.0 * over_ground);
    const double metres = view.width_m > 0.0 ? view.width_m : fitting;

    ImVec2 corner = ImGui::GetCursorScreenPos();
    corner.x += (room.x - side) / 2.0f;
    ImGui::SetCursorScreenPos(corner);
    ImGui::InvisibleButton("map", {side, side});
    const bool hovered = ImGui::IsItemHovered();
    if (hovered && ImGui::GetIO().MouseWheel != 0.0f)
        view.width_m = std::clamp(metres * std::pow(0.8, ImGui::GetIO().MouseWheel), 100.0, 1e8);
    if (hovered && ImGui::IsMouseDoubleClicked(0)) view.width_m = 0.0;
    if (hovered) ImGui::SetTooltip("Wheel: zoom. Double click: follow the height.");

    ImDrawList* list = ImGui::GetWindowDrawList();
    const ImVec2 end{corner.x + side, corner.y + side};
    const Canvas canvas{corner, side, model.pose.eye_m[0], model.pose.eye_m[1], metres};
    list->PushClipRect(corner, end, true);
    list->AddRectFilled(corner, end, IM_COL32(24, 26, 30, 255));
    if (view.picture && model.map.image)
        list->AddImage(view.picture, canvas.at(model.map.x0_m, model.map.y0_m),
                       canvas.at(model.map.x0_m + model.map.side_m, model.map.y0_m + model.map.side_m));
    draw_nodes(model, canvas, list, view.picture != nullptr);
    draw_eye(model, canvas, list, scale);
    const float north = corner.x + side / 2.0f;
    list->AddCircleFilled({north, corner.y + 10.0f * scale}, 9.0f * scale, IM_COL32(14, 15, 18, 190));
    list->AddText(
        {north - ImGui::CalcTextSize("N").x / 2.0f, corner.y + 10.0f * scale - ImGui::GetTextLineHeight() / 2.0f},
        IM_COL32(255, 255, 255, 230), "N");
    const std::string width =
        metres < 1000.0 ? fmt::format("{:.0f} m wide", metres) : fmt::format("{:.3g} km wide", metres / 1000.0);
    list->AddRectFilled({corner.x, end.y - ImGui::GetTextLineHeight() - 4.0f},
                        {corner.x + ImGui::CalcTextSize(width.c_str()).x + 8.0f, end.y}, IM_COL32(14, 15, 18, 150));
    list->AddText({corner.x + 4.0f, end.y - ImGui::GetTextLineHeight() - 2.0f}, IM_COL32(255, 255, 255, 190),
                  width.c_str());
    list->PopClipRect();
    draw_legend(model, scale);

    ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x * 0.5f);
    const std::string shown =
        controls.map_layer ? std::string(info_of(*controls.map_layer).name) : std::string("no layer");
    if (ImGui::BeginCombo("##layer", shown.c_str())) {
        if (ImGui::Selectable("no layer", !controls.map_layer)) controls.map_layer.reset();
        for (const LayerInfo& info : k_layers) {
            if (ImGui::Selectable(std::string(info.name).c_str(), controls.map_layer == info.layer))
                controls.map_layer = info.layer;
            if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", std::string(info.help).c_str());
        }
        ImGui::EndCombo();
    }
    if (controls.map_layer && !model.map.legend.empty()) {
        ImGui::SameLine();
        ImGui::TextDisabled("%s", model.map.legend.c_str());
    }
}

} // namespace hud
} // namespace sahel
