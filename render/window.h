#pragma once

#include "render/gl_context.h"
#include "render/keys.h"

#include <memory>
#include <string>

/// A window with an OpenGL 4.5 core context, its keys and mouse. One at a time, in the main thread.
namespace sahel {

class Window {
  public:
    /// Errors: unsupported (no display, no 4.5 core context).
    static Result<std::unique_ptr<Window>> create(int width, int height, const std::string& title);
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    /// Handles what happened since the last call. Esc first gives the mouse back, then asks to close; F11 is done here;
    /// everything else is the caller's. Input that the panels take (a focused slider) does not arrive.
    InputState poll();
    void swap();
    [[nodiscard]] bool should_close() const;
    void request_close();

    /// While captured the pointer is hidden and moves turn the view.
    void capture_mouse(bool on);
    [[nodiscard]] bool mouse_captured() const { return captured_; }
    void set_full_screen(bool on);
    [[nodiscard]] bool full_screen() const { return full_screen_; }
    void set_title(const std::string& title);

    /// Pixels of the picture; 0 x 0 while the window is minimised.
    [[nodiscard]] int width_px() const;
    [[nodiscard]] int height_px() const;
    /// Seconds on a steady clock.
    [[nodiscard]] double now_s() const;
    [[nodiscard]] GlContext& context() { return *context_; }
    [[nodiscard]] GLFWwindow* glfw() const { return context_->glfw(); }

  private:
    explicit Window(std::unique_ptr<GlContext> context);
    struct Callbacks;
    std::unique_ptr<GlContext> context_;
    KeyMapper keys_;
    bool captured_ = false;
    bool full_screen_ = false;
    bool have_pointer_ = false;
    double pointer_x_ = 0.0, pointer_y_ = 0.0;
    int windowed_x_ = 0, windowed_y_ = 0, windowed_width_ = 0, windowed_height_ = 0;
};

} // namespace sahel
