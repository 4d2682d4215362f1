#pragma once

#include "world/result.h"

#include <memory>
#include <string>

struct GLFWwindow;

/// OpenGL 4.5 core contexts: without a display through EGL (a device's own driver first, then Mesa without a surface),
/// or in a window through GLFW.
namespace sahel {

struct GlInfo {
    std::string platform; ///< "EGL device", "EGL surfaceless", "GLFW"
    std::string vendor, renderer, version;
    [[nodiscard]] bool software() const; ///< drawn by the processor
};

class GlContext {
  public:
    virtual ~GlContext() = default;
    GlContext(const GlContext&) = delete;
    GlContext& operator=(const GlContext&) = delete;

    /// Current in this thread after the call. SAHEL_EGL=device or surfaceless picks one way.
    /// Errors: unsupported (no driver gives 4.5 core; what was tried and what to install).
    static Result<std::unique_ptr<GlContext>> headless();
    /// Errors: unsupported (no display, no 4.5 core).
    static Result<std::unique_ptr<GlContext>> window(int width, int height, const std::string& title);

    [[nodiscard]] const GlInfo& info() const { return info_; }
    [[nodiscard]] virtual GLFWwindow* glfw() const { return nullptr; }
    /// Messages of the driver that it calls errors, since the last call.
    std::string take_errors();

  protected:
    GlContext() = default;
    void describe(const std::string& platform);
    GlInfo info_;
    std::string errors_;
};

} // namespace sahel
