#include "render/keys.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>

namespace sahel {

namespace {

// clang-format off
constexpr KeyBinding k_table[] = {
    {Action::move_forward,       KeyGroup::move,    {GLFW_KEY_W, GLFW_KEY_UP},       "W, Up",       "Forward, where you look"},
    {Action::move_back,          KeyGroup::move,    {GLFW_KEY_S, GLFW_KEY_DOWN},     "S, Down",     "Back"},
    {Action::move_left,          KeyGroup::move,    {GLFW_KEY_A, GLFW_KEY_LEFT},     "A, Left",     "To the left"},
    {Action::move_right,         KeyGroup::move,    {GLFW_KEY_D, GLFW_KEY_RIGHT},    "D, Right",    "To the right"},
    {Action::move_up,            KeyGroup::move,    {GLFW_KEY_E, GLFW_KEY_PAGE_UP},  "E, Page up",  "Up"},
    {Action::move_down,          KeyGroup::move,    {GLFW_KEY_Q, GLFW_KEY_PAGE_DOWN},"Q, Page down","Down"},
    {Action::fast,               KeyGroup::move,    {GLFW_KEY_LEFT_SHIFT, GLFW_KEY_RIGHT_SHIFT},     "Shift", "8 times as fast"},
    {Action::slow,               KeyGroup::move,    {GLFW_KEY_LEFT_CONTROL, GLFW_KEY_RIGHT_CONTROL}, "Ctrl",  "8 times as slow"},
    {Action::toggle_walk,        KeyGroup::move,    {GLFW_KEY_G, 0},                 "G",           "Walk on the ground, fly again"},
    {Action::none,               KeyGroup::look,    {0, 0},                          "Left click",  "Take the mouse to look around"},
    {Action::none,               KeyGroup::look,    {0, 0},                          "Mouse",       "Look around"},
    {Action::none,               KeyGroup::look,    {0, 0},                          "Wheel",       "Speed: a quarter more or less"},
    {Action::earlier,            KeyGroup::time,    {GLFW_KEY_COMMA, 0},             ",",           "Earlier in the day"},
    {Action::later,              KeyGroup::time,    {GLFW_KEY_PERIOD, 0},            ".",           "Later in the day"},
    {Action::pause_time,         KeyGroup::time,    {GLFW_KEY_P, 0},                 "P",           "Stop and start time"},
    {Action::toggle_help,        KeyGroup::show,    {GLFW_KEY_F1, 0},                "F1",          "This help"},
    {Action::toggle_hud,         KeyGroup::show,    {GLFW_KEY_F2, 0},                "F2",          "All panels"},
    {Action::toggle_map,         KeyGroup::show,    {GLFW_KEY_F3, 0},                "F3",          "Tile map"},
    {Action::toggle_panels,      KeyGroup::show,    {GLFW_KEY_F4, 0},                "F4",          "Sun, air and views"},
    {Action::next_view,          KeyGroup::show,    {GLFW_KEY_F5, 0},                "F5",          "Next debug view"},
    {Action::next_layer,         KeyGroup::show,    {GLFW_KEY_F6, 0},                "F6",          "Next layer on the tile map"},
    {Action::toggle_wireframe,   KeyGroup::show,    {GLFW_KEY_F7, 0},                "F7",          "Wireframe"},
    {Action::plain_view,         KeyGroup::show,    {GLFW_KEY_F8, 0},                "F8",          "Back to the plain picture"},
    {Action::bookmark,           KeyGroup::places,  {0, 0},                          "1 .. 9",      "Go to a bookmark"},
    {Action::bookmark_shift,     KeyGroup::places,  {GLFW_KEY_B, 0},                 "B + 1 .. 9",  "Set a bookmark here"},
    {Action::go_home,            KeyGroup::places,  {GLFW_KEY_HOME, 0},              "Home",        "Back to the start"},
    {Action::freeze_lod,         KeyGroup::program, {GLFW_KEY_L, 0},                 "L",           "Freeze the level of detail"},
    {Action::toggle_full_screen, KeyGroup::program, {GLFW_KEY_F11, 0},               "F11",         "Full screen"},
    {Action::screenshot,         KeyGroup::program, {GLFW_KEY_F12, 0},               "F12",         "Screenshot"},
    {Action::release_or_quit,    KeyGroup::program, {GLFW_KEY_ESCAPE, 0},            "Esc",         "Release the mouse; then quit"},
};
// clang-format on

bool is_held_kind(Action a) {
    return a >= Action::move_forward && a <= Action::bookmark_shift;
}

} // namespace

std::string_view name_of(KeyGroup group) {
    switch (group) {
    case KeyGroup::move:
        return "Move";
    case KeyGroup::look:
        return "Look";
    case KeyGroup::show:
        return "Show";
    case KeyGroup::places:
        return "Places";
    case KeyGroup::time:
        return "Time";
    case KeyGroup::program:
        return "Program";
    }
    return "";
}

std::span<const KeyBinding> key_table() {
    return k_table;
}

Action action_of_key(int glfw_key) {
    if (glfw_key >= GLFW_KEY_1 && glfw_key <= GLFW_KEY_9) return Action::bookmark;
    if (glfw_key >= GLFW_KEY_KP_1 && glfw_key <= GLFW_KEY_KP_9) return Action::bookmark;
    if (glfw_key > 0)
        for (const KeyBinding& row : k_table)
            if (row.keys[0] == glfw_key || row.keys[1] == glfw_key) return row.action;
    return Action::none;
}

std::string keys_markdown() {
    std::string text = "| Key | What it does |\n|---|---|\n";
    for (const KeyBinding& row : k_table)
        text += "| " + std::string(row.shown) + " | " +
                std::string(row.action == Action::toggle_help ? "Help" : row.help) + " |\n";
    return text;
}

FlyInput fly_input(const InputState& input) {
    const auto axis = [&](Action plus, Action minus) {
        return static_cast<double>(input.is_held(plus)) - static_cast<double>(input.is_held(minus));
    };
    FlyInput fly;
    fly.forward = axis(Action::move_forward, Action::move_back);
    fly.right = axis(Action::move_right, Action::move_left);
    fly.up = axis(Action::move_up, Action::move_down);
    fly.fast = input.is_held(Action::fast);
    fly.slow = input.is_held(Action::slow);
    fly.turn_right_deg = input.look_right_px * k_look_deg_per_px;
    fly.turn_up_deg = -input.look_down_px * k_look_deg_per_px;
    fly.speed_steps = input.wheel;
    return fly;
}

void KeyMapper::key(int glfw_key, bool down) {
    const Action action = action_of_key(glfw_key);
    if (action == Action::none) return;
    const auto at = std::find(down_.begin(), down_.end(), glfw_key);
    if (down == (at != down_.end())) return; // a repeat, or a key that went down elsewhere
    if (down)
        down_.push_back(glfw_key);
    else
        down_.erase(at);
    if (is_held_kind(action)) {
        now_.held[static_cast<size_t>(action)] =
            std::any_of(down_.begin(), down_.end(), [&](int k) { return action_of_key(k) == action; });
    } else if (down) {
        ActionEvent event{.action = action, .digit = 0, .set = false};
        if (action == Action::bookmark) {
            event.digit = glfw_key >= GLFW_KEY_KP_1 ? glfw_key - GLFW_KEY_KP_0 : glfw_key - GLFW_KEY_0;
            event.set = now_.is_held(Action::bookmark_shift);
        }
        now_.pressed.push_back(event);
    }
}

void KeyMapper::mouse_moved(double right_px, double down_px) {
    now_.look_right_px += right_px;
    now_.look_down_px += down_px;
}
void KeyMapper::wheel(double notches) {
    now_.wheel += notches;
}
void KeyMapper::release_all() {
    down_.clear();
    now_.held.fill(false);
}

InputState KeyMapper::take_frame() {
    InputState frame = now_;
    now_.pressed.clear();
    now_.look_right_px = now_.look_down_px = now_.wheel = 0.0;
    return frame;
}

} // namespace sahel
