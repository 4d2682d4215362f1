#include "streaming/simulation_params.h"

#include "world/file_io.h"
#include "world/params_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace sahel {

namespace {

constexpr std::array<std::string_view, 3> k_groups = {"wind", "sand", "rose"};

Status read(const Json& json, std::string_view where, SimulationParams& params) {
    for (const auto& item : json.items()) {
        const std::string key = "simulation." + item.key();
        if (item.key() == "wind") {
            SAHEL_ASSIGN(params.wind, params_from_json(item.value(), where, key, params.wind));
        } else if (item.key() == "sand") {
            SAHEL_ASSIGN(params.sand, params_from_json(item.value(), where, key, params.sand));
        } else if (item.key() == "rose") {
            if (!item.value().is_string())
                return Error{ErrorKind::usage, fmt::format("{}: {} must be the name of a file, not {}", where, key,
                                                           json_description(item.value()))};
            params.rose = item.value().get<std::string>();
        } else {
            return unknown_key_error(where, key, k_groups);
        }
    }
    return {};
}

std::vector<std::string_view> all_keys(std::vector<std::string>& storage) {
    for (const std::string_view name : field_names<WindParams>()) storage.push_back(param_key("wind", name));
    for (const std::string_view name : field_names<SandParams>()) storage.push_back(param_key("sand", name));
    storage.emplace_back("rose");
    return {storage.begin(), storage.end()};
}

} // namespace

SimulationParams default_simulation(const WorldDesc& desc) {
    SimulationParams params;
    if (desc.preset == "none") return params;
    const double angle_deg =
        std::atan2(static_cast<double>(desc.terrain.wind_y), static_cast<double>(desc.terrain.wind_x)) * 180.0 /
        std::numbers::pi;
    params.wind.angle_deg = static_cast<float>(std::round(angle_deg * 10.0) / 10.0);
    params.wind.second_angle_deg = params.wind.angle_deg + 45.0f; // where two winds take turns, if they are asked to
    return params;
}

std::string simulation_json(const SimulationParams& params) {
    Json json = Json::object();
    json["wind"] = params_to_json(params.wind);
    json["sand"] = params_to_json(params.sand);
    if (!params.rose.empty()) json["rose"] = params.rose;
    return json.dump();
}

Result<SimulationParams> simulation_of(const WorldDesc& desc, std::string_view where) {
    SimulationParams params = default_simulation(desc);
    if (desc.simulation.empty()) return params;
    SAHEL_ASSIGN(const Json json, parse_json(desc.simulation, where));
    if (!json.is_object()) return Error{ErrorKind::usage, fmt::format("{}: simulation must be an object", where)};
    SAHEL_TRY(read(json, where, params));
    return params;
}

Status set_simulation(SimulationParams& params, std::string_view assignment, std::string_view where) {
    const size_t equals = assignment.find('=');
    if (equals == std::string_view::npos || equals == 0)
        return Error{ErrorKind::usage,
                     fmt::format("{}: '{}': write KEY=VALUE, for example sand.lift_rate=0.5", where, assignment)};
    const std::string key(assignment.substr(0, equals));
    const std::string text(assignment.substr(equals + 1));
    std::vector<std::string> storage;
    const std::vector<std::string_view> known = all_keys(storage);
    if (std::find(known.begin(), known.end(), key) == known.end()) return unknown_key_error(where, key, known);
    if (key == "rose") {
        params.rose = text;
        return {};
    }
    Json value = Json::parse(text, nullptr, false);
    if (value.is_discarded()) value = text;
    const std::string group = key.substr(0, 4);
    Json object = Json::object();
    object[key.substr(5)] = value;
    if (group == "wind") {
        SAHEL_ASSIGN(params.wind, params_from_json(object, where, group, params.wind));
    } else {
        SAHEL_ASSIGN(params.sand, params_from_json(object, where, group, params.sand));
    }
    return {};
}

Result<Aeolian::Desc> aeolian_desc(const SimulationParams& params, const WorldDesc& desc,
                                   const std::filesystem::path& world_folder) {
    Aeolian::Desc aeolian;
    aeolian.wind = params.wind;
    aeolian.sand = params.sand;
    aeolian.cell_m = desc.cell_m;
    aeolian.seed = desc.seed;
    if (!params.rose.empty()) {
        const std::filesystem::path file = world_folder / params.rose;
        SAHEL_ASSIGN(const std::string text, read_text_file(file));
        SAHEL_ASSIGN(aeolian.schedule, file.extension() == ".json" ? WindSchedule::from_json(text, file.string())
                                                                   : WindSchedule::from_csv(text, file.string()));
    }
    return aeolian;
}

} // namespace sahel
