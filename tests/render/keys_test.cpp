#include "render/keys.h"

#include "world/file_io.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

namespace sahel {
namespace {

TEST(KeyTable, NoKeyHasTwoMeanings) {
    std::map<int, std::string> seen;
    std::set<std::string> shown;
    for (const KeyBinding& row : key_table()) {
        EXPECT_TRUE(shown.insert(std::string(row.shown)).second) << row.shown;
        EXPECT_FALSE(row.help.empty()) << row.shown;
        for (const int key : row.keys) {
            if (key == 0) continue;
            EXPECT_TRUE(seen.emplace(key, std::string(row.shown)).second) << row.shown << " and " << seen[key];
            EXPECT_EQ(action_of_key(key), row.action) << row.shown;
            EXPECT_FALSE(key >= GLFW_KEY_1 && key <= GLFW_KEY_9) << "digits are bookmarks";
        }
    }
    EXPECT_EQ(action_of_key(GLFW_KEY_F24), Action::none);
    EXPECT_EQ(action_of_key(0), Action::none);
}

TEST(KeyTable, EveryActionIsInTheTable) {
    std::set<Action> listed;
    for (const KeyBinding& row : key_table()) listed.insert(row.action);
    for (int a = 1; a < static_cast<int>(Action::count_); ++a)
        EXPECT_TRUE(listed.contains(static_cast<Action>(a))) << a;
}

TEST(KeyTable, TheReadmeShowsIt) {
    const auto readme = read_text_file(std::string(SAHEL_SOURCE_DIR) + "/render/README.md");
    ASSERT_TRUE(readme.ok());
    EXPECT_THAT(readme.value(), ::testing::HasSubstr(keys_markdown()));
}

TEST(KeyMapper, HeldKeysAddUp) {
    KeyMapper keys;
    keys.key(GLFW_KEY_W, true);
    keys.key(GLFW_KEY_UP, true);
    keys.key(GLFW_KEY_D, true);
    keys.key(GLFW_KEY_LEFT_SHIFT, true);
    FlyInput fly = fly_input(keys.take_frame());
    EXPECT_EQ(fly.forward, 1.0);
    EXPECT_EQ(fly.right, 1.0);
    EXPECT_TRUE(fly.fast);
    // One of two keys for the same thing goes up: it is still held, in this frame and the next ones.
    keys.key(GLFW_KEY_W, false);
    EXPECT_EQ(fly_input(keys.take_frame()).forward, 1.0);
    keys.key(GLFW_KEY_UP, false);
    keys.key(GLFW_KEY_S, true);
    EXPECT_EQ(fly_input(keys.take_frame()).forward, -1.0);
    keys.release_all();
    fly = fly_input(keys.take_frame());
    EXPECT_EQ(fly.forward, 0.0);
    EXPECT_EQ(fly.right, 0.0);
    EXPECT_FALSE(fly.fast);
    keys.key(GLFW_KEY_D, false); // the release of a key that was forgotten
    EXPECT_EQ(fly_input(keys.take_frame()).right, 0.0);
}

TEST(KeyMapper, PressesAreReportedOnceInOrder) {
    KeyMapper keys;
    keys.key(GLFW_KEY_F12, true);
    keys.key(GLFW_KEY_F12, true); // repeat
    keys.key(GLFW_KEY_P, true);
    keys.key(GLFW_KEY_F12, false);
    keys.key(GLFW_KEY_F12, true);
    const InputState frame = keys.take_frame();
    ASSERT_EQ(frame.pressed.size(), 3u);
    EXPECT_EQ(frame.pressed[0].action, Action::screenshot);
    EXPECT_EQ(frame.pressed[1].action, Action::pause_time);
    EXPECT_EQ(frame.pressed[2].action, Action::screenshot);
    EXPECT_TRUE(keys.take_frame().pressed.empty());
}

TEST(KeyMapper, DigitsGoToBookmarksAndSetThemWithB) {
    KeyMapper keys;
    keys.key(GLFW_KEY_3, true);
    keys.key(GLFW_KEY_B, true);
    keys.key(GLFW_KEY_9, true);
    keys.key(GLFW_KEY_KP_1, true);
    keys.key(GLFW_KEY_B, false);
    keys.key(GLFW_KEY_KP_9, true);
    const auto pressed = keys.take_frame().pressed;
    ASSERT_EQ(pressed.size(), 4u);
    const std::vector<std::pair<int, bool>> want{{3, false}, {9, true}, {1, true}, {9, false}};
    for (size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(pressed[i].action, Action::bookmark);
        EXPECT_EQ(pressed[i].digit, want[i].first);
        EXPECT_EQ(pressed[i].set, want[i].second);
    }
}

TEST(KeyMapper, MouseTurnsAndWheelSetsTheSpeed) {
    KeyMapper keys;
    keys.mouse_moved(100.0, -50.0);
    keys.mouse_moved(20.0, 0.0);
    keys.wheel(1.0);
    keys.wheel(1.0);
    const FlyInput fly = fly_input(keys.take_frame());
    EXPECT_DOUBLE_EQ(fly.turn_right_deg, 120.0 * k_look_deg_per_px);
    EXPECT_DOUBLE_EQ(fly.turn_up_deg, 50.0 * k_look_deg_per_px);
    EXPECT_EQ(fly.speed_steps, 2.0);
    EXPECT_EQ(fly_input(keys.take_frame()).turn_right_deg, 0.0);
}

} // namespace
} // namespace sahel
