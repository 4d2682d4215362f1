#include "render/gl_context.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <array>
#include <cstdlib>
#include <string_view>
#include <vector>

namespace sahel {

namespace {

void APIENTRY on_message(GLenum, GLenum type, GLuint, GLenum, GLsizei length, const GLchar* message, const void* user) {
    if (type != GL_DEBUG_TYPE_ERROR) return;
    auto& errors = *static_cast<std::string*>(const_cast<void*>(user));
    errors.append(message, length < 0 ? std::string_view(message).size() : static_cast<size_t>(length));
    errors += '\n';
}

class EglContext final : public GlContext {
  public:
    static Result<std::unique_ptr<GlContext>> create(EGLDisplay display, const char* platform) {
        const Error none{ErrorKind::unsupported, std::string(platform) + ": no OpenGL 4.5 core context"};
        EGLint major = 0, minor = 0;
        if (display == EGL_NO_DISPLAY || !eglInitialize(display, &major, &minor)) return none;
        eglBindAPI(EGL_OPENGL_API);
        constexpr std::array<EGLint, 5> k_config = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE,
                                                    EGL_OPENGL_BIT, EGL_NONE};
        EGLConfig config = nullptr;
        EGLint count = 0;
        constexpr std::array<EGLint, 7> k_context = {
            EGL_CONTEXT_MAJOR_VERSION,           4,       EGL_CONTEXT_MINOR_VERSION, 5, EGL_CONTEXT_OPENGL_PROFILE_MASK,
            EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
        EGLContext context = EGL_NO_CONTEXT;
        if (eglChooseConfig(display, k_config.data(), &config, 1, &count) && count > 0)
            context = eglCreateContext(display, config, EGL_NO_CONTEXT, k_context.data());
        if (context == EGL_NO_CONTEXT || !eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) {
            if (context != EGL_NO_CONTEXT) eglDestroyContext(display, context);
            eglTerminate(display);
            return none;
        }
        auto made = std::unique_ptr<EglContext>(new EglContext(display, context));
        made->describe(platform);
        return std::unique_ptr<GlContext>(std::move(made));
    }
    ~EglContext() override {
        eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        eglDestroyContext(display_, context_);
        eglTerminate(display_);
    }

  private:
    EglContext(EGLDisplay display, EGLContext context) : display_(display), context_(context) {}
    EGLDisplay display_;
    EGLContext context_;
};

class WindowContext final : public GlContext {
  public:
    explicit WindowContext(GLFWwindow* window) : window_(window) { describe("GLFW"); }
    ~WindowContext() override {
        glfwDestroyWindow(window_);
        glfwTerminate();
    }
    [[nodiscard]] GLFWwindow* glfw() const override { return window_; }

  private:
    GLFWwindow* window_;
};

std::string text(GLenum name) {
    const auto* s = reinterpret_cast<const char*>(glGetString(name));
    return s ? s : "";
}

EGLDisplay device_display() {
    if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_device") ||
        !epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_enumeration"))
        return EGL_NO_DISPLAY;
    std::array<EGLDeviceEXT, 8> devices{};
    EGLint count = 0;
    if (!eglQueryDevicesEXT(static_cast<EGLint>(devices.size()), devices.data(), &count) || count == 0)
        return EGL_NO_DISPLAY;
    return eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[0], nullptr);
}

} // namespace

bool GlInfo::software() const {
    return renderer.find("llvmpipe") != std::string::npos || renderer.find("softpipe") != std::string::npos;
}

void GlContext::describe(const std::string& platform) {
    info_ = {platform, text(GL_VENDOR), text(GL_RENDERER), text(GL_VERSION)};
    glEnable(GL_DEBUG_OUTPUT);
    glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    glDebugMessageCallback(on_message, &errors_);
}

std::string GlContext::take_errors() {
    return std::exchange(errors_, {});
}

Result<std::unique_ptr<GlContext>> GlContext::headless() {
    const char* asked = std::getenv("SAHEL_EGL");
    const std::string_view way = asked ? asked : "";
    if (way != "surfaceless")
        if (auto made = EglContext::create(device_display(), "EGL device"); made.ok()) return made;
    if (way != "device" && epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless"))
        if (auto made = EglContext::create(
                eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr),
                "EGL surfaceless");
            made.ok())
            return made;
    return Error{ErrorKind::unsupported, "OpenGL: neither an EGL device nor surfaceless Mesa gives a 4.5 core context; "
                                         "install a driver or the packages libegl-mesa0 and libgl1-mesa-dri"};
}

Result<std::unique_ptr<GlContext>> GlContext::window(int width, int height, const std::string& title) {
    glfwSetErrorCallback([](int, const char*) {});
    if (!glfwInit())
        return Error{ErrorKind::unsupported, "no window: there is no display (set DISPLAY, or fly with --headless)"};
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_DEPTH_BITS, 0); // everything is drawn into framebuffers of our own
    GLFWwindow* window = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
    if (!window) {
        glfwTerminate();
        return Error{ErrorKind::unsupported,
                     "no window: the display gives no OpenGL 4.5 core context; fly with --headless"};
    }
    glfwMakeContextCurrent(window);
    glfwSwapInterval(1);
    return std::unique_ptr<GlContext>(std::make_unique<WindowContext>(window));
}

} // namespace sahel
