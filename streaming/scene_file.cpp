#include "streaming/scene_file.h"

#include "world/file_io.h"

#include <fmt/format.h>

#include <algorithm>

namespace sahel {

namespace {

constexpr uint64_t k_max_scene_bytes = uint64_t{4} << 20;

/// Keys of the viewer and of schemes that are not offered: known, of no effect here.
constexpr std::string_view k_viewer_keys[] = {"vSync", "targetFrameRate", "shadowStrength", "renderVegetation"};
constexpr std::string_view k_multigrid_keys[] = {"multigridLevelCount", "multigridVCycleIterations",
                                                 "multigridSolverIterations", "multigridPresweepCount",
                                                 "multigridPostsweepCount"};

template <size_t n> bool is_one_of(std::string_view key, const std::string_view (&keys)[n]) {
    return std::find(std::begin(keys), std::end(keys), key) != std::end(keys);
}

FieldText text_of(std::string_view key, std::string_view type, std::string_view unit, std::string min,
                  std::string max) {
    FieldText text;
    text.name = std::string(key);
    text.type = std::string(type);
    text.unit = std::string(unit);
    text.min = std::move(min);
    text.max = std::move(max);
    return text;
}

/// One scalar within [min, max].
template <class T>
Status read_value(const Json& value, std::string_view where, std::string_view key, std::string_view unit,
                  typename detail::SceneElement<T>::type min, typename detail::SceneElement<T>::type max, T& out) {
    const auto text = [&] { return text_of(key, param_type_name<T>(), unit, param_text(min), param_text(max)); };
    const auto wrong_type = [&] { return type_error(where, key, json_description(value), text()); };
    const auto wrong_range = [&] { return range_error(where, key, value.dump(), text()); };
    if constexpr (std::is_same_v<T, bool>) {
        if (!value.is_boolean()) return wrong_type();
        out = value.template get<bool>();
    } else if constexpr (std::is_same_v<T, int>) {
        if (!value.is_number_integer()) return wrong_type();
        const bool fits = value.is_number_unsigned() ? std::in_range<int>(value.template get<uint64_t>())
                                                     : std::in_range<int>(value.template get<int64_t>());
        if (!fits || value.template get<int>() < min || value.template get<int>() > max) return wrong_range();
        out = value.template get<int>();
    } else if constexpr (std::is_same_v<T, float>) {
        if (!value.is_number()) return wrong_type();
        const auto narrow = static_cast<float>(value.template get<double>());
        if (!(narrow >= min && narrow <= max)) return wrong_range();
        out = narrow;
    } else {
        if (!value.is_string()) return wrong_type();
        const auto& s = value.template get_ref<const std::string&>();
        if (s.size() < min || s.size() > max) return wrong_range();
        out = s;
    }
    return {};
}

template <class T, size_t n>
Status read_value(const Json& value, std::string_view where, std::string_view key, std::string_view unit,
                  typename detail::SceneElement<T>::type min, typename detail::SceneElement<T>::type max,
                  std::array<T, n>& out) {
    if (!value.is_array() || value.size() != n)
        return Error{
            ErrorKind::usage,
            fmt::format("{}: '{}' must be a list of {} {}s, each from {} to {}{}{}, not {}", where, key, n,
                        param_type_name<T>(), param_text(min), param_text(max), unit.empty() ? "" : " ", unit,
                        value.is_array() ? fmt::format("a list of {}", value.size()) : json_description(value))};
    for (size_t i = 0; i < n; ++i)
        SAHEL_TRY(read_value<T>(value[i], where, fmt::format("{}[{}]", key, i), unit, min, max, out[i]));
    return {};
}

Status missing(std::string_view where, std::string_view key) {
    return Error{ErrorKind::usage, fmt::format("{}: the key '{}' is missing", where, key)};
}

Status read_layer(const Json& object, std::string_view where, const std::string& name, bool all_required,
                  SceneNoise& noise, std::vector<std::string>& ignored) {
    const std::string group = "initializationParameters." + name;
    if (!object.is_object())
        return Error{ErrorKind::usage,
                     fmt::format("{}: '{}' must be an object, not {}", where, group, json_description(object))};
    int known = 0;
    for (const auto& item : object.items()) {
        const std::string key = group + "." + item.key();
        const Json& v = item.value();
        ++known;
        if (item.key() == "enable")
            SAHEL_TRY(read_value<bool>(v, where, key, "", false, true, noise.enable));
        else if (item.key() == "flat")
            SAHEL_TRY(read_value<bool>(v, where, key, "", false, true, noise.flat));
        else if (item.key() == "uniform_random")
            SAHEL_TRY(read_value<bool>(v, where, key, "", false, true, noise.uniform));
        else if (item.key() == "iterations")
            SAHEL_TRY(read_value<int>(v, where, key, "", 0, 50, noise.iterations));
        else if (item.key() == "scale")
            SAHEL_TRY(read_value<float>(v, where, key, "", 0.0f, 10000.0f, noise.scale));
        else if (item.key() == "bias")
            SAHEL_TRY(read_value<float>(v, where, key, "", -10000.0f, 10000.0f, noise.bias));
        else if (item.key() == "stretch")
            SAHEL_TRY((read_value<float, 2>(v, where, key, "", 0.0f, 100.0f, noise.stretch)));
        else if (item.key() == "offset")
            SAHEL_TRY((read_value<float, 2>(v, where, key, "", -1.0e6f, 1.0e6f, noise.offset)));
        else if (item.key() == "border")
            SAHEL_TRY((read_value<float, 2>(v, where, key, "", 0.0f, 1.0f, noise.border)));
        else {
            --known;
            ignored.push_back(key);
        }
    }
    if (all_required && known < 9)
        for (const char* key :
             {"enable", "flat", "uniform_random", "iterations", "scale", "bias", "stretch", "offset", "border"})
            if (!object.contains(key)) return missing(where, group + "." + key);
    return {};
}

Status read_layers(const Json& object, std::string_view where, Scene& scene) {
    if (!object.is_object())
        return Error{ErrorKind::usage, fmt::format("{}: 'initializationParameters' must be an object, not {}", where,
                                                   json_description(object))};
    const bool oasis = scene.format == SceneFormat::oasis;
    for (const auto& item : object.items()) {
        SceneNoise* noise = nullptr;
        if (item.key() == "Bedrock") noise = &scene.layers.bedrock;
        if (item.key() == "Sand") noise = &scene.layers.sand;
        if (item.key() == "Vegetation") noise = &scene.layers.vegetation;
        if (item.key() == "Abrasion Resistance") noise = &scene.layers.resistance;
        if (item.key() == "Soil" && oasis) noise = &scene.layers.soil;
        if (item.key() == "Water" && oasis) noise = &scene.layers.water;
        if (item.key() == "Moisture" && oasis) noise = &scene.layers.moisture;
        if (!noise) {
            scene.ignored.push_back("initializationParameters." + item.key());
            continue;
        }
        SAHEL_TRY(read_layer(item.value(), where, item.key(), !oasis, *noise, scene.ignored));
    }
    return {};
}

bool has_text(const Json& file, const char* key, std::string_view text) {
    const auto at = file.find(key);
    return at != file.end() && at->is_string() && at->get_ref<const std::string&>() == text;
}

/// Method 4.3; what water and plants need is only in files of Oasis.
SceneFormat format_of(const Json& file) {
    for (const char* key : {"vegTypes", "vegTypeCount", "maxVegCount", "sandMoistureRate", "soilAvalancheIterations",
                            "wavePeriod", "rainStrength", "sedimentCapacityConstant", "soilColor"})
        if (file.contains(key)) return SceneFormat::oasis;
    if (const auto init = file.find("initializationParameters"); init != file.end() && init->is_object())
        for (const char* key : {"Soil", "Water", "Moisture"})
            if (init->contains(key)) return SceneFormat::oasis;
    const bool old = has_text(file, "saltationMode", "Continuous") || file.contains("multigridPresweepCount") ||
                     file.contains("multigridPostsweepCount") || !file.contains("projectionMode");
    return old && !file.contains("reptationSmoothingStrength") ? SceneFormat::dunes_2023 : SceneFormat::dunes_2025;
}

/// What a freshly started program holds, where the formats differ.
void set_defaults(Scene& scene) {
    if (scene.format == SceneFormat::dunes_2023) scene.values.avalanche_strength = 0.5f;
    if (scene.format != SceneFormat::oasis) return;
    scene.values.fixed_delta_time = 0.5f;
    scene.values.shadow_colour[3] = 0.0f;
    scene.values.vegetation_colour[3] = 0.0f;
    scene.layers.sand = {.scale = 100.0f, .bias = 1.0f};
    scene.layers.soil = {.scale = 100.0f, .bias = 10.0f};
    scene.layers.water = {.scale = 100.0f, .bias = 20.0f};
    scene.layers.moisture = {.scale = 100.0f, .bias = 0.3f};
}

bool known_in(SceneKeyIn in, SceneFormat format) {
    return in == SceneKeyIn::both || (in == SceneKeyIn::oasis) == (format == SceneFormat::oasis);
}

} // namespace

std::string_view scene_format_name(SceneFormat format) {
    switch (format) {
    case SceneFormat::dunes_2023:
        return "Desertscape 2023";
    case SceneFormat::dunes_2025:
        return "Desertscape 2025";
    case SceneFormat::oasis:
        return "Oasis";
    }
    return {};
}

Result<Scene> parse_scene(std::string_view text, std::string_view where) {
    if (text.size() > k_max_scene_bytes)
        return Error{ErrorKind::corrupt, fmt::format("{}: {} bytes are no scene file", where, text.size())};
    SAHEL_ASSIGN(const Json file, parse_json(text, where));
    if (!file.is_object())
        return Error{ErrorKind::usage,
                     fmt::format("{}: a scene must be an object, not {}", where, json_description(file))};
    Scene scene;
    scene.format = format_of(file);
    set_defaults(scene);
    for (const auto& item : file.items()) {
        bool known = false;
        Status status;
        for_each_scene_key([&](const auto& row) {
            if (known || row.key != item.key() || !known_in(row.in, scene.format)) return;
            known = true;
            using T = typename std::remove_cvref_t<decltype(row)>::value_type;
            if constexpr (std::is_same_v<T, typename detail::SceneElement<T>::type> || std::is_same_v<T, std::string>)
                status =
                    read_value<T>(item.value(), where, row.key, row.unit, row.min, row.max, scene.values.*row.member);
            else
                status = read_value(item.value(), where, row.key, row.unit, row.min, row.max, scene.values.*row.member);
        });
        SAHEL_TRY(status);
        if (known) continue;
        if (item.key() == "initializationParameters")
            SAHEL_TRY(read_layers(item.value(), where, scene));
        else if (item.key() == "vegTypes" && scene.format == SceneFormat::oasis) {
            SAHEL_ASSIGN(scene.species, parse_scene_species(item.value(), where));
        } else {
            scene.ignored.push_back(item.key());
        }
    }
    if (scene.format != SceneFormat::oasis) {
        Status status;
        for_each_scene_key([&](const auto& row) {
            if (status.ok() && row.need == SceneKeyNeed::required && known_in(row.in, scene.format) &&
                !file.contains(std::string(row.key)))
                status = missing(where, row.key);
        });
        SAHEL_TRY(status);
        if (!file.contains("initializationParameters")) return missing(where, "initializationParameters").error();
    } else if (file.contains("vegTypeCount") && scene.values.plant_types != static_cast<int>(scene.species.size())) {
        return Error{ErrorKind::usage, fmt::format("{}: 'vegTypeCount' is {}, but 'vegTypes' lists {} species", where,
                                                   scene.values.plant_types, scene.species.size())};
    }
    // Unknown keys are named in notes; those of the viewer and of other schemes are only listed.
    for (const std::string& key : scene.ignored)
        if (!is_one_of(key, k_viewer_keys) && !is_one_of(key, k_multigrid_keys))
            scene.notes.push_back(fmt::format("the key '{}' is unknown and was ignored", key));
    SAHEL_TRY(detail::translate_scene(scene, where));
    return scene;
}

Result<Scene> load_scene(const std::filesystem::path& file) {
    std::error_code failed;
    if (std::filesystem::is_directory(file, failed))
        return Error{ErrorKind::usage, fmt::format("{}: a folder, not a scene file", file.string())};
    SAHEL_ASSIGN(const std::string text, read_text_file(file, k_max_scene_bytes));
    SAHEL_ASSIGN(Scene scene, parse_scene(text, file.string()));
    scene.path = file;
    scene.name = file.stem().string();
    return scene;
}

} // namespace sahel
