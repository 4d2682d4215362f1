#include "render/bookmarks.h"

#include "world/file_io.h"
#include "world/params_json.h"

#include <fmt/format.h>

#include <algorithm>

namespace sahel {

namespace {

/// The numbers of a bookmark, for the strict reading and the ranges of params_json.h.
struct PoseNumbers {
    double yaw_deg = 0.0;
    double pitch_deg = 0.0;
    double vertical_fov_deg = 50.0;
};

} // namespace

// clang-format off
template <> inline constexpr auto fields_of<PoseNumbers> = std::tuple{
    Field{&PoseNumbers::yaw_deg,          "yaw_deg",          "deg", -360.0, 360.0, "Azimuth of the view, 0 east, 90 south"},
    Field{&PoseNumbers::pitch_deg,        "pitch_deg",        "deg", -89.0,  89.0,  "Angle above the horizon"},
    Field{&PoseNumbers::vertical_fov_deg, "vertical_fov_deg", "deg", 5.0,    120.0, "Vertical field of view"},
};
// clang-format on

namespace {

Error bad(std::string_view where, const std::string& key, const std::string& what) {
    return {ErrorKind::usage, fmt::format("{}: '{}' {}", where, key, what)};
}

Result<Bookmark> read_bookmark(const Json& json, std::string_view where, const std::string& at) {
    if (!json.is_object()) return bad(where, at, "must be an object, not " + json_description(json));
    Bookmark bookmark;
    Json numbers = json;
    if (!json.contains("name") || !json["name"].is_string()) return bad(where, at + ".name", "must be text");
    bookmark.name = json["name"].get<std::string>();
    if (bookmark.name.size() > 200) return bad(where, at + ".name", "is longer than 200 characters");
    const std::string key = at + ".position_m";
    if (!json.contains("position_m") || !json["position_m"].is_array() || json["position_m"].size() != 3)
        return bad(where, key, "must be three numbers [x, y, z] in metres");
    for (size_t i = 0; i < 3; ++i) {
        const Json& value = json["position_m"][i];
        if (!value.is_number() || std::abs(value.get<double>()) > (i < 2 ? 1e13 : 1e6))
            return bad(where, fmt::format("{}[{}]", key, i),
                       "must be a number of metres, not " + json_description(value));
        bookmark.pose.eye_m[i] = value.get<double>();
    }
    numbers.erase("name");
    numbers.erase("position_m");
    SAHEL_ASSIGN(const PoseNumbers pose, params_from_json<PoseNumbers>(numbers, where, at));
    bookmark.pose.yaw_deg = pose.yaw_deg;
    bookmark.pose.pitch_deg = pose.pitch_deg;
    bookmark.pose.vertical_fov_deg = pose.vertical_fov_deg;
    return bookmark;
}

} // namespace

Result<std::vector<Bookmark>> load_bookmarks(const std::filesystem::path& file) {
    SAHEL_ASSIGN(const std::string text, read_text_file(file));
    const std::string where = file.string();
    SAHEL_ASSIGN(const Json json, parse_json(text, where));
    if (!json.is_object())
        return Error{ErrorKind::usage, fmt::format("{}: must be an object, not {}", where, json_description(json))};
    for (const auto& item : json.items()) {
        static constexpr std::string_view k_known[] = {"format", "bookmarks"};
        if (std::find(std::begin(k_known), std::end(k_known), item.key()) == std::end(k_known))
            return unknown_key_error(where, item.key(), k_known);
    }
    if (!json.contains("format") || !json["format"].is_number_integer()) return bad(where, "format", "must be 1");
    if (json["format"].get<int64_t>() != 1)
        return Error{ErrorKind::unsupported,
                     fmt::format("{}: bookmark format {}; this program reads format 1", where, json["format"].dump())};
    if (!json.contains("bookmarks") || !json["bookmarks"].is_array())
        return bad(where, "bookmarks", "must be an array");
    if (json["bookmarks"].size() > k_max_bookmarks)
        return bad(where, "bookmarks", fmt::format("has more than {} places", k_max_bookmarks));
    std::vector<Bookmark> bookmarks;
    for (const Json& entry : json["bookmarks"]) {
        SAHEL_ASSIGN(Bookmark bookmark, read_bookmark(entry, where, fmt::format("bookmarks[{}]", bookmarks.size())));
        bookmarks.push_back(std::move(bookmark));
    }
    return bookmarks;
}

Status save_bookmarks(const std::filesystem::path& file, const std::vector<Bookmark>& bookmarks) {
    Json json = Json::object();
    json["format"] = 1;
    json["bookmarks"] = Json::array();
    for (const Bookmark& b : bookmarks) {
        Json entry = Json::object();
        entry["name"] = b.name;
        entry["position_m"] = b.pose.eye_m;
        entry["yaw_deg"] = b.pose.yaw_deg;
        entry["pitch_deg"] = b.pose.pitch_deg;
        entry["vertical_fov_deg"] = b.pose.vertical_fov_deg;
        json["bookmarks"].push_back(std::move(entry));
    }
    return write_file(file, json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

size_t set_bookmark(std::vector<Bookmark>& bookmarks, int digit, const CameraPose& pose) {
    const size_t index = std::min(static_cast<size_t>(std::clamp(digit, 1, 9) - 1), bookmarks.size());
    if (index == bookmarks.size()) bookmarks.push_back({fmt::format("Place {}", index + 1), pose});
    bookmarks[index].pose = pose;
    return index;
}

} // namespace sahel
