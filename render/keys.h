#pragma once

#include "render/camera.h"

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// What keys and mouse do: one table, from which the window, the help overlay and the reference page are made. No
/// window is needed: GLFW's key numbers go in, an InputState for each frame comes out.
namespace sahel {

enum class Action : uint8_t {
    none,
    // held
    move_forward,
    move_back,
    move_left,
    move_right,
    move_up,
    move_down,
    fast,
    slow,
    bookmark_shift,
    // pressed
    toggle_help,
    toggle_hud,
    toggle_map,
    toggle_panels,
    next_view,
    next_layer,
    toggle_wireframe,
    plain_view,
    toggle_full_screen,
    screenshot,
    bookmark, ///< with the digit: go there, or set it while bookmark_shift is held
    pause_time,
    freeze_lod,
    earlier,
    later,
    toggle_walk,
    go_home,
    release_or_quit,
    count_
};

enum class KeyGroup : uint8_t { move, look, show, places, time, program };
std::string_view name_of(KeyGroup group);

struct KeyBinding {
    Action action;
    KeyGroup group;
    std::array<int, 2> keys; ///< GLFW key numbers; 0: none (the mouse)
    std::string_view shown;  ///< as people call it
    std::string_view help;
};
/// Every key once, in the order in which help shows them.
std::span<const KeyBinding> key_table();
/// What a GLFW key does; Action::none for a key without a meaning.
Action action_of_key(int glfw_key);
/// The table as Markdown, for the README.
std::string keys_markdown();

struct ActionEvent {
    Action action = Action::none;
    int digit = 0;    ///< 1 .. 9 for Action::bookmark
    bool set = false; ///< for Action::bookmark: store it there
};

/// One frame's input.
struct InputState {
    std::array<bool, static_cast<size_t>(Action::count_)> held{};
    double look_right_px = 0.0;
    double look_down_px = 0.0;
    double wheel = 0.0;
    std::vector<ActionEvent> pressed; ///< in the order of the key strokes

    [[nodiscard]] bool is_held(Action a) const { return held[static_cast<size_t>(a)]; }
};

/// Degrees of turn for each pixel of the mouse.
inline constexpr double k_look_deg_per_px = 0.12;
FlyInput fly_input(const InputState& input);

/// Gathers what happens between two frames.
class KeyMapper {
  public:
    void key(int glfw_key, bool down);
    void mouse_moved(double right_px, double down_px);
    void wheel(double notches);
    /// The window lost the keyboard: nothing is held any more.
    void release_all();
    InputState take_frame();

  private:
    InputState now_;
    std::vector<int> down_; ///< two keys may hold one action
};

} // namespace sahel
