#include "render/hud.h"

#include "render/hud_panels.h"
#include "render/ui_font.h"

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <epoxy/gl.h>

#include <algorithm>
#include <cmath>

namespace sahel {

float Hud::scale_for(int height_px) {
    return std::clamp(static_cast<float>(height_px) / 900.0f, 1.0f, 3.0f);
}

HudLayout hud_layout(int width_px, int height_px, float scale, bool map, bool controls) {
    const auto w = static_cast<float>(width_px);
    const auto h = static_cast<float>(height_px);
    const float gap = std::floor(8.0f * scale);
    const float side = std::floor(std::min(272.0f * scale, (w - 4.0f * gap) / 3.0f));
    const float left_split = std::floor((h - 3.0f * gap) * (h < 900.0f ? 0.79f : 0.72f));
    const float map_height = std::min(std::floor(side + 62.0f * scale), std::floor((h - 3.0f * gap) * 0.6f));
    HudLayout l;
    l.stats = {gap, gap, side, left_split};
    l.bookmarks = {gap, 2.0f * gap + left_split, side, h - 3.0f * gap - left_split};
    l.map = {w - gap - side, gap, side, map_height};
    const float controls_y = map ? 2.0f * gap + map_height : gap;
    l.controls = {w - gap - side, controls_y, side, h - gap - controls_y};
    const float line = std::floor(30.0f * scale);
    const float right = controls ? side + gap : 0.0f; // without panels the line may run on
    l.message = {2.0f * gap + side, h - gap - line, w - 3.0f * gap - side - right - gap, line};
    const float help_w = std::min(720.0f * scale, w - 2.0f * gap);
    const float help_h = std::min(392.0f * scale, h - 2.0f * gap);
    l.help = {std::floor((w - help_w) / 2.0f), std::floor((h - help_h) / 2.0f), help_w, help_h};
    return l;
}

namespace {

void set_style(float scale) {
    ImGuiStyle style;
    ImGui::StyleColorsDark(&style);
    style.WindowRounding = 6.0f;
    style.FrameRounding = 3.0f;
    style.GrabRounding = 3.0f;
    style.ScrollbarRounding = 4.0f;
    style.ScrollbarSize = 10.0f;
    style.WindowBorderSize = 0.0f;
    style.WindowPadding = {10.0f, 8.0f};
    style.ItemSpacing = {6.0f, 3.0f};
    style.FramePadding = {5.0f, 2.0f};
    style.WindowTitleAlign = {0.0f, 0.5f};
    ImVec4* c = style.Colors;
    c[ImGuiCol_WindowBg] = {0.055f, 0.06f, 0.07f, 0.78f};
    c[ImGuiCol_TitleBg] = c[ImGuiCol_TitleBgActive] = {0.05f, 0.055f, 0.065f, 0.92f};
    c[ImGuiCol_Text] = {0.95f, 0.94f, 0.91f, 1.0f};
    c[ImGuiCol_TextDisabled] = hud::k_dim;
    c[ImGuiCol_FrameBg] = {1.0f, 1.0f, 1.0f, 0.09f};
    c[ImGuiCol_FrameBgHovered] = {1.0f, 1.0f, 1.0f, 0.16f};
    c[ImGuiCol_FrameBgActive] = {1.0f, 1.0f, 1.0f, 0.22f};
    c[ImGuiCol_CheckMark] = c[ImGuiCol_PlotHistogram] = hud::k_accent;
    c[ImGuiCol_SliderGrab] = {0.93f, 0.66f, 0.32f, 0.50f}; // the number behind it stays readable
    c[ImGuiCol_SliderGrabActive] = {1.0f, 0.78f, 0.45f, 0.80f};
    c[ImGuiCol_PlotLines] = hud::k_accent;
    c[ImGuiCol_Header] = {0.93f, 0.66f, 0.32f, 0.28f};
    c[ImGuiCol_HeaderHovered] = {0.93f, 0.66f, 0.32f, 0.40f};
    c[ImGuiCol_HeaderActive] = {0.93f, 0.66f, 0.32f, 0.55f};
    c[ImGuiCol_Button] = {1.0f, 1.0f, 1.0f, 0.10f};
    c[ImGuiCol_ButtonHovered] = {0.93f, 0.66f, 0.32f, 0.45f};
    c[ImGuiCol_ButtonActive] = {0.93f, 0.66f, 0.32f, 0.70f};
    c[ImGuiCol_Separator] = {1.0f, 1.0f, 1.0f, 0.14f};
    style.ScaleAllSizes(scale);
    ImGui::GetStyle() = style;
}

void set_font(float scale) {
    ImGuiIO& io = ImGui::GetIO();
    io.Fonts->Clear();
    const float size = std::round(15.0f * scale);
    const std::string file = ui_font_file();
    if (file.empty() || !io.Fonts->AddFontFromFileTTF(file.c_str(), size)) {
        ImFontConfig config;
        config.SizePixels = std::round(13.0f * scale);
        io.Fonts->AddFontDefault(&config);
    }
}

} // namespace

struct Hud::Impl {
    bool with_window = false;
    float scale = 0.0f; ///< that font and style were made for
    hud::FrameCurve curve;
    hud::MapView map_view;
    hud::BookmarkEdit bookmark_edit;
    uint32_t map_texture = 0;
    uint64_t map_version = 0;
    std::vector<Panel> panels;

    ~Impl() {
        if (map_texture) glDeleteTextures(1, &map_texture);
        ImGui_ImplOpenGL3_Shutdown();
        if (with_window) ImGui_ImplGlfw_Shutdown();
        ImGui::DestroyContext();
    }

    void set_scale(float wanted) {
        if (std::abs(wanted - scale) < 0.01f) return;
        scale = wanted;
        set_style(scale);
        set_font(scale);
        ImGui_ImplOpenGL3_DestroyFontsTexture();
        ImGui_ImplOpenGL3_CreateFontsTexture();
    }

    void update_map_texture(const HudMapImage& map) {
        map_view.picture = nullptr;
        if (!map.image || map.image->channels != 4) return;
        if (!map_texture || map.version != map_version) {
            if (map_texture) glDeleteTextures(1, &map_texture);
            glCreateTextures(GL_TEXTURE_2D, 1, &map_texture);
            glTextureStorage2D(map_texture, 1, GL_RGBA8, map.image->width_px, map.image->height_px);
            glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
            glTextureSubImage2D(map_texture, 0, 0, 0, map.image->width_px, map.image->height_px, GL_RGBA,
                                GL_UNSIGNED_BYTE, map.image->pixels.data());
            glTextureParameteri(map_texture, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
            glTextureParameteri(map_texture, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
            glTextureParameteri(map_texture, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
            glTextureParameteri(map_texture, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
            map_version = map.version;
        }
        map_view.picture = reinterpret_cast<ImTextureID>(static_cast<uintptr_t>(map_texture));
    }

    /// One panel at its place; `body` draws the inside.
    template <class Body> void panel(const char* name, const HudRect& rect, ImGuiWindowFlags flags, Body&& body) {
        ImGui::SetNextWindowPos({rect.x, rect.y}, ImGuiCond_Always);
        ImGui::SetNextWindowSize({rect.width, rect.height}, ImGuiCond_Always);
        flags |= ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoCollapse |
                 ImGuiWindowFlags_NoSavedSettings;
        ImGui::Begin(name, nullptr, flags);
        body();
        const ImVec2 at = ImGui::GetWindowPos();
        const ImVec2 size = ImGui::GetWindowSize();
        panels.push_back({name, {at.x, at.y, size.x, size.y}});
        ImGui::End();
    }
};

Hud::Hud(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Hud::~Hud() = default;

std::unique_ptr<Hud> Hud::create(GLFWwindow* window) {
    IMGUI_CHECKVERSION();
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr; // panels stand where the layout puts them
    ImGui::GetIO().LogFilename = nullptr;
    auto impl = std::make_unique<Impl>();
    impl->with_window = window != nullptr;
    if (window) ImGui_ImplGlfw_InitForOpenGL(window, true);
    ImGui_ImplOpenGL3_Init("#version 450");
    return std::unique_ptr<Hud>(new Hud(std::move(impl)));
}

const std::vector<Hud::Panel>& Hud::panels() const {
    return impl_->panels;
}

HudEvents Hud::draw(const HudModel& model, HudControls& controls, int width_px, int height_px, double dt_s,
                    bool mouse_free) {
    Impl& hud = *impl_;
    HudEvents events;
    hud.panels.clear();
    if (model.frame_ms > 0.0) hud.curve.add(static_cast<float>(model.frame_ms));
    if (width_px <= 0 || height_px <= 0) return events;

    ImGuiIO& io = ImGui::GetIO();
    // The framebuffer is the caller's: a window's own size (in points) does not count.
    ImGui_ImplOpenGL3_NewFrame();
    if (hud.with_window) ImGui_ImplGlfw_NewFrame();
    hud.set_scale(scale_for(height_px));
    const ImVec2 window_size = io.DisplaySize;
    io.DisplaySize = {static_cast<float>(width_px), static_cast<float>(height_px)};
    io.DisplayFramebufferScale = {1.0f, 1.0f};
    if (hud.with_window && window_size.x > 0.0f && io.MousePos.x > -1e6f) {
        io.MousePos.x *= io.DisplaySize.x / window_size.x;
        io.MousePos.y *= io.DisplaySize.y / window_size.y;
    }
    io.DeltaTime = static_cast<float>(std::clamp(dt_s, 1e-4, 1.0));
    if (mouse_free)
        io.ConfigFlags &= ~ImGuiConfigFlags_NoMouse;
    else
        io.ConfigFlags |= ImGuiConfigFlags_NoMouse;
    hud.update_map_texture(model.map);

    ImGui::NewFrame();
    const float s = hud.scale;
    const HudLayout at =
        hud_layout(width_px, height_px, s, controls.show_map, controls.show_panels || controls.show_map);
    const bool fits = width_px >= 480 && height_px >= 270; // a thumbnail has no room for panels
    if (controls.show_hud && fits) {
        hud.panel("Statistics", at.stats, ImGuiWindowFlags_NoTitleBar, [&] { hud::draw_stats(model, hud.curve, s); });
        hud.panel("Bookmarks", at.bookmarks, 0, [&] { hud::draw_bookmarks(model, hud.bookmark_edit, events, s); });
        if (controls.show_map)
            hud.panel("Tile map", at.map, ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse,
                      [&] { hud::draw_map(model, controls, hud.map_view, s); });
        if (controls.show_panels)
            hud.panel("Sun, air and views", at.controls, 0, [&] { hud::draw_controls(model, controls, events, s); });
    }
    const bool hint = controls.show_hud && !controls.show_help;
    if (fits && (!model.message.empty() || hint))
        hud.panel("Message", at.message,
                  ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoBackground | ImGuiWindowFlags_NoInputs |
                      ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoScrollbar,
                  [&] {
                      const std::string text = model.message.empty() ? "F1: keys" : model.message;
                      const ImVec2 size = ImGui::CalcTextSize(text.c_str());
                      const ImVec2 corner = ImGui::GetWindowPos();
                      const float x = std::max(corner.x + 6.0f, corner.x + (ImGui::GetWindowWidth() - size.x) / 2.0f);
                      const float y = corner.y + (ImGui::GetWindowHeight() - size.y) / 2.0f;
                      ImDrawList* list = ImGui::GetWindowDrawList();
                      list->AddRectFilled({x - 10.0f * s, y - 4.0f * s},
                                          {x + size.x + 10.0f * s, y + size.y + 4.0f * s}, IM_COL32(14, 15, 18, 190),
                                          5.0f * s);
                      list->AddText({x, y}, IM_COL32(242, 240, 232, 255), text.c_str());
                  });
    if (controls.show_help && fits) hud.panel("Keys", at.help, ImGuiWindowFlags_NoTitleBar, [&] { hud::draw_help(s); });
    ImGui::Render();

    // ImGui draws with z from -1 to 1; the picture behind it may use 0 to 1.
    GLint origin = GL_LOWER_LEFT, depth_mode = GL_NEGATIVE_ONE_TO_ONE;
    glGetIntegerv(GL_CLIP_ORIGIN, &origin);
    glGetIntegerv(GL_CLIP_DEPTH_MODE, &depth_mode);
    glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
    const GLboolean srgb = glIsEnabled(GL_FRAMEBUFFER_SRGB);
    glDisable(GL_FRAMEBUFFER_SRGB);
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
    if (srgb) glEnable(GL_FRAMEBUFFER_SRGB);
    glClipControl(static_cast<GLenum>(origin), static_cast<GLenum>(depth_mode));
    return events;
}

} // namespace sahel
