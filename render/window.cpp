#include "render/window.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>

#include <algorithm>

namespace sahel {

/// GLFW calls these; panels that have the keyboard or the pointer come first.
struct Window::Callbacks {
    static Window& of(GLFWwindow* window) { return *static_cast<Window*>(glfwGetWindowUserPointer(window)); }
    static bool panels_have_keys() { return ImGui::GetCurrentContext() && ImGui::GetIO().WantTextInput; }
    static bool panels_have_mouse() { return ImGui::GetCurrentContext() && ImGui::GetIO().WantCaptureMouse; }

    static void key(GLFWwindow* window, int key, int, int action, int) {
        if (action == GLFW_REPEAT) return;
        if (action == GLFW_PRESS && panels_have_keys()) return;
        of(window).keys_.key(key, action == GLFW_PRESS);
    }
    static void pointer(GLFWwindow* window, double x, double y) {
        Window& w = of(window);
        if (w.captured_ && w.have_pointer_) w.keys_.mouse_moved(x - w.pointer_x_, y - w.pointer_y_);
        w.have_pointer_ = true;
        w.pointer_x_ = x;
        w.pointer_y_ = y;
    }
    static void button(GLFWwindow* window, int button, int action, int) {
        if (button == GLFW_MOUSE_BUTTON_LEFT && action == GLFW_PRESS && !panels_have_mouse())
            of(window).capture_mouse(true);
    }
    static void scroll(GLFWwindow* window, double, double y) {
        if (of(window).captured_ || !panels_have_mouse()) of(window).keys_.wheel(y);
    }
    static void focus(GLFWwindow* window, int focused) {
        if (focused) return;
        of(window).keys_.release_all();
        of(window).capture_mouse(false);
    }
};

Window::Window(std::unique_ptr<GlContext> context) : context_(std::move(context)) {
    GLFWwindow* window = glfw();
    glfwSetWindowUserPointer(window, this);
    // Panels add their own callbacks behind these.
    glfwSetKeyCallback(window, Callbacks::key);
    glfwSetCursorPosCallback(window, Callbacks::pointer);
    glfwSetMouseButtonCallback(window, Callbacks::button);
    glfwSetScrollCallback(window, Callbacks::scroll);
    glfwSetWindowFocusCallback(window, Callbacks::focus);
}

Window::~Window() = default;

Result<std::unique_ptr<Window>> Window::create(int width, int height, const std::string& title) {
    SAHEL_ASSIGN(auto context, GlContext::window(width, height, title));
    return std::unique_ptr<Window>(new Window(std::move(context)));
}

InputState Window::poll() {
    glfwPollEvents();
    InputState input = keys_.take_frame();
    std::erase_if(input.pressed, [&](const ActionEvent& event) {
        if (event.action == Action::toggle_full_screen) {
            set_full_screen(!full_screen_);
            return true;
        }
        if (event.action == Action::release_or_quit) {
            if (captured_)
                capture_mouse(false);
            else
                request_close();
            return true;
        }
        return false;
    });
    return input;
}

void Window::swap() {
    glfwSwapBuffers(glfw());
}
bool Window::should_close() const {
    return glfwWindowShouldClose(glfw()) != 0;
}
void Window::request_close() {
    glfwSetWindowShouldClose(glfw(), GLFW_TRUE);
}

void Window::capture_mouse(bool on) {
    if (captured_ == on) return;
    captured_ = on;
    have_pointer_ = false; // the pointer jumps when its mode changes
    glfwSetInputMode(glfw(), GLFW_CURSOR, on ? GLFW_CURSOR_DISABLED : GLFW_CURSOR_NORMAL);
    if (glfwRawMouseMotionSupported()) glfwSetInputMode(glfw(), GLFW_RAW_MOUSE_MOTION, on ? GLFW_TRUE : GLFW_FALSE);
}

void Window::set_full_screen(bool on) {
    if (full_screen_ == on) return;
    GLFWmonitor* monitor = glfwGetPrimaryMonitor();
    const GLFWvidmode* mode = monitor ? glfwGetVideoMode(monitor) : nullptr;
    if (!mode) return;
    full_screen_ = on;
    have_pointer_ = false;
    if (on) {
        glfwGetWindowPos(glfw(), &windowed_x_, &windowed_y_);
        glfwGetWindowSize(glfw(), &windowed_width_, &windowed_height_);
        glfwSetWindowMonitor(glfw(), monitor, 0, 0, mode->width, mode->height, mode->refreshRate);
    } else {
        glfwSetWindowMonitor(glfw(), nullptr, windowed_x_, windowed_y_, windowed_width_, windowed_height_,
                             GLFW_DONT_CARE);
    }
    glfwSwapInterval(1); // some drivers forget it
}

void Window::set_title(const std::string& title) {
    glfwSetWindowTitle(glfw(), title.c_str());
}

int Window::width_px() const {
    int width = 0, height = 0;
    glfwGetFramebufferSize(glfw(), &width, &height);
    return width;
}
int Window::height_px() const {
    int width = 0, height = 0;
    glfwGetFramebufferSize(glfw(), &width, &height);
    return height;
}
double Window::now_s() const {
    return glfwGetTime();
}

} // namespace sahel
