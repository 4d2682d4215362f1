#include "render/camera_path.h"
#include "world/file_io.h"
#include "world/params_json.h"

#include <fmt/format.h>

#include <cmath>

namespace sahel {

namespace {

constexpr double k_max_coordinate_m = 1e13;
constexpr double k_max_height_m = 1e6;
constexpr double k_max_time_s = 86400.0;
constexpr size_t k_max_keys = 100000;

Error bad(std::string_view where, std::string_view key, const std::string& what) {
    return {ErrorKind::usage, fmt::format("{}: '{}' {}", where, key, what)};
}

Status check_number(std::string_view where, const std::string& key, double value, double min, double max,
                    std::string_view unit) {
    if (value >= min && value <= max) return {};
    return bad(where, key, fmt::format("is {}, outside its range {} to {} {}", value, min, max, unit));
}

Status check_point(std::string_view where, const std::string& key, const Vec3d& p) {
    SAHEL_TRY(check_number(where, key + "[0]", p[0], -k_max_coordinate_m, k_max_coordinate_m, "m"));
    SAHEL_TRY(check_number(where, key + "[1]", p[1], -k_max_coordinate_m, k_max_coordinate_m, "m"));
    return check_number(where, key + "[2]", p[2], -k_max_height_m, k_max_height_m, "m");
}

Status read_number(const Json& value, std::string_view where, const std::string& key, double& out) {
    if (!value.is_number()) return bad(where, key, "must be a number, not " + json_description(value));
    out = value.get<double>();
    return {};
}

Status read_point(const Json& value, std::string_view where, const std::string& key, Vec3d& out) {
    if (!value.is_array() || value.size() != 3)
        return bad(where, key, "must be three numbers [x, y, z] in metres, not " + json_description(value));
    for (size_t i = 0; i < 3; ++i) SAHEL_TRY(read_number(value[i], where, fmt::format("{}[{}]", key, i), out[i]));
    return {};
}

Status read_key(const Json& json, std::string_view where, size_t index, CameraKey& key, bool& has_target) {
    const std::string at = fmt::format("keys[{}]", index);
    if (!json.is_object()) return bad(where, at, "must be an object, not " + json_description(json));
    bool time = false, position = false, yaw = false, pitch = false;
    has_target = false;
    for (const auto& item : json.items()) {
        const std::string name = at + "." + item.key();
        if (item.key() == "time_s") {
            SAHEL_TRY(read_number(item.value(), where, name, key.time_s));
            time = true;
        } else if (item.key() == "position_m") {
            SAHEL_TRY(read_point(item.value(), where, name, key.position_m));
            position = true;
        } else if (item.key() == "target_m") {
            SAHEL_TRY(read_point(item.value(), where, name, key.target_m));
            has_target = true;
        } else if (item.key() == "yaw_deg") {
            SAHEL_TRY(read_number(item.value(), where, name, key.yaw_deg));
            yaw = true;
        } else if (item.key() == "pitch_deg") {
            SAHEL_TRY(read_number(item.value(), where, name, key.pitch_deg));
            pitch = true;
        } else {
            static constexpr std::string_view k_known[] = {"time_s", "position_m", "target_m", "yaw_deg", "pitch_deg"};
            return unknown_key_error(where, name, k_known);
        }
    }
    if (!time) return bad(where, at, "has no 'time_s'");
    if (!position) return bad(where, at, "has no 'position_m'");
    if (has_target == (yaw || pitch) || yaw != pitch)
        return bad(where, at, "must have either 'target_m', or 'yaw_deg' and 'pitch_deg'");
    return {};
}

} // namespace

Status check_camera_path(const CameraPath::Description& d, std::string_view where) {
    SAHEL_TRY(check_number(where, "vertical_fov_deg", d.vertical_fov_deg, 5.0, 120.0, "deg"));
    if (d.keys.size() < 2 || d.keys.size() > k_max_keys)
        return bad(where, "keys", fmt::format("has {} key frames; 2 to {}", d.keys.size(), k_max_keys));
    for (size_t i = 0; i < d.keys.size(); ++i) {
        const CameraKey& key = d.keys[i];
        const std::string at = fmt::format("keys[{}].", i);
        SAHEL_TRY(check_number(where, at + "time_s", key.time_s, 0.0, k_max_time_s, "s"));
        if (i > 0 && key.time_s < d.keys[i - 1].time_s + 1e-3)
            return bad(
                where, at + "time_s",
                fmt::format("is {}, but times must rise: the key before is at {} s", key.time_s, d.keys[i - 1].time_s));
        SAHEL_TRY(check_point(where, at + "position_m", key.position_m));
        if (d.aims_at_targets) {
            SAHEL_TRY(check_point(where, at + "target_m", key.target_m));
            if (std::hypot(key.target_m[0] - key.position_m[0], key.target_m[1] - key.position_m[1],
                           key.target_m[2] - key.position_m[2]) < 0.01)
                return bad(where, at + "target_m", "is where the eye is; nothing to look at");
        } else {
            SAHEL_TRY(check_number(where, at + "yaw_deg", key.yaw_deg, -360.0, 360.0, "deg"));
            SAHEL_TRY(check_number(where, at + "pitch_deg", key.pitch_deg, -k_max_pitch_deg, k_max_pitch_deg, "deg"));
        }
    }
    return {};
}

Result<CameraPath> CameraPath::from_json(const Json& json, std::string_view where) {
    if (!json.is_object())
        return Error{ErrorKind::usage, fmt::format("{}: must be an object, not {}", where, json_description(json))};
    Description d;
    bool has_keys = false, has_format = false;
    for (const auto& item : json.items()) {
        const Json& value = item.value();
        if (item.key() == "format") {
            if (!value.is_number_integer()) return bad(where, "format", "must be a whole number");
            if (value.get<int64_t>() != 1)
                return Error{
                    ErrorKind::unsupported,
                    fmt::format("{}: camera path format {}; this program reads format 1", where, value.dump())};
            has_format = true;
        } else if (item.key() == "name") {
            if (!value.is_string()) return bad(where, "name", "must be text, not " + json_description(value));
            d.name = value.get<std::string>();
        } else if (item.key() == "vertical_fov_deg") {
            SAHEL_TRY(read_number(value, where, "vertical_fov_deg", d.vertical_fov_deg));
        } else if (item.key() == "ease") {
            if (!value.is_boolean()) return bad(where, "ease", "must be true or false, not " + json_description(value));
            d.ease = value.get<bool>();
        } else if (item.key() == "keys") {
            if (!value.is_array()) return bad(where, "keys", "must be an array, not " + json_description(value));
            if (value.size() > k_max_keys) return bad(where, "keys", fmt::format("has {} key frames", value.size()));
            for (size_t i = 0; i < value.size(); ++i) {
                bool target = false;
                SAHEL_TRY(read_key(value[i], where, i, d.keys.emplace_back(), target));
                if (i == 0) d.aims_at_targets = target;
                if (target != d.aims_at_targets)
                    return bad(where, fmt::format("keys[{}]", i),
                               "aims in another way than keys[0]: all keys need 'target_m', or all 'yaw_deg' and "
                               "'pitch_deg'");
            }
            has_keys = true;
        } else {
            static constexpr std::string_view k_known[] = {"format", "name", "vertical_fov_deg", "ease", "keys"};
            return unknown_key_error(where, item.key(), k_known);
        }
    }
    if (!has_format) return bad(where, "format", "is missing; it is 1");
    if (!has_keys) return bad(where, "keys", "is missing");
    return create(std::move(d), where);
}

Result<CameraPath> CameraPath::load(const std::filesystem::path& file) {
    SAHEL_ASSIGN(const std::string text, read_text_file(file));
    SAHEL_ASSIGN(const Json json, parse_json(text, file.string()));
    return from_json(json, file.string());
}

Json CameraPath::to_json() const {
    Json json = Json::object();
    json["format"] = 1;
    json["name"] = description_.name;
    json["vertical_fov_deg"] = description_.vertical_fov_deg;
    json["ease"] = description_.ease;
    json["keys"] = Json::array();
    for (const CameraKey& key : description_.keys) {
        Json k = Json::object();
        k["time_s"] = key.time_s;
        k["position_m"] = key.position_m;
        if (description_.aims_at_targets) {
            k["target_m"] = key.target_m;
        } else {
            k["yaw_deg"] = key.yaw_deg;
            k["pitch_deg"] = key.pitch_deg;
        }
        json["keys"].push_back(std::move(k));
    }
    return json;
}

Status CameraPath::save(const std::filesystem::path& file) const {
    return write_file(file, to_json().dump(2) + "\n");
}

} // namespace sahel
