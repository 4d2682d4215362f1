#include "render/bookmarks.h"

#include "world/file_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

namespace sahel {
namespace {

using ::testing::HasSubstr;

class BookmarksTest : public ::testing::Test {
  protected:
    ~BookmarksTest() override { std::filesystem::remove(file_); }
    std::filesystem::path file_ =
        std::filesystem::path(::testing::TempDir()) / ("bookmarks_" + std::to_string(::getpid()) + ".json");
    [[nodiscard]] std::string error_of(const std::string& json) const {
        EXPECT_TRUE(write_file(file_, json).ok());
        const auto loaded = load_bookmarks(file_);
        return loaded.ok() ? "no error" : loaded.error().message;
    }
};

TEST_F(BookmarksTest, ComeBackAsTheyWere) {
    const std::vector<Bookmark> places{{"north \"shore\"", {{1e9 + 0.125, -3, 322.1}, -170, 12, 48}}, {"two", {}}};
    ASSERT_TRUE(save_bookmarks(file_, places).ok());
    const auto back = load_bookmarks(file_);
    ASSERT_TRUE(back.ok()) << back.error().message;
    ASSERT_EQ(back->size(), 2u);
    EXPECT_EQ((*back)[0].name, places[0].name);
    EXPECT_EQ((*back)[0].pose.eye_m, places[0].pose.eye_m);
    EXPECT_EQ((*back)[0].pose.yaw_deg, -170);
    EXPECT_EQ((*back)[0].pose.pitch_deg, 12);
    EXPECT_EQ((*back)[0].pose.vertical_fov_deg, 48);
}

TEST_F(BookmarksTest, ErrorsNameFileAndKey) {
    const std::string name = file_.filename().string();
    EXPECT_EQ(load_bookmarks(file_).error().kind, ErrorKind::not_found);
    for (const auto& [json, key] : std::vector<std::pair<std::string, std::string>>{
             {"[]", "object"},
             {R"({"bookmarks": []})", "'format'"},
             {R"({"format": 7, "bookmarks": []})", "format 7"},
             {R"({"format": 1, "bookmark": []})", "did you mean 'bookmarks'"},
             {R"({"format": 1, "bookmarks": [3]})", "bookmarks[0]"},
             {R"({"format": 1, "bookmarks": [{"position_m": [0,0,0]}]})", "bookmarks[0].name"},
             {R"({"format": 1, "bookmarks": [{"name": "a", "position_m": [0,0]}]})", "bookmarks[0].position_m"},
             {R"({"format": 1, "bookmarks": [{"name": "a", "position_m": [0,0,null]}]})", "bookmarks[0].position_m[2]"},
             {R"({"format": 1, "bookmarks": [{"name": "a", "position_m": [0,0,0], "yaw": 1}]})", "bookmarks[0].yaw"},
             {R"({"format": 1, "bookmarks": [{"name": "a", "position_m": [0,0,0], "pitch_deg": 95}]})", "-89 to 89"},
         }) {
        const std::string error = error_of(json);
        EXPECT_THAT(error, HasSubstr(name)) << json;
        EXPECT_THAT(error, HasSubstr(key)) << json;
    }
}

TEST_F(BookmarksTest, DigitsFillTheListInOrder) {
    std::vector<Bookmark> places;
    EXPECT_EQ(set_bookmark(places, 5, {.eye_m = {1, 0, 0}}), 0u); // the first free place
    EXPECT_EQ(set_bookmark(places, 2, {.eye_m = {2, 0, 0}}), 1u);
    places[0].name = "camp";
    EXPECT_EQ(set_bookmark(places, 1, {.eye_m = {3, 0, 0}}), 0u);
    ASSERT_EQ(places.size(), 2u);
    EXPECT_EQ(places[0].name, "camp");
    EXPECT_EQ(places[0].pose.eye_m[0], 3);
}

} // namespace
} // namespace sahel
