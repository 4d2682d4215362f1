#include "streaming/scene_species.h"

#include <fmt/format.h>

namespace sahel {

namespace {

constexpr size_t k_arr_length = 30;

Error wrong(std::string_view where, const std::string& key, std::string_view need, const Json& found) {
    return {ErrorKind::usage, fmt::format("{}: '{}' must be {}, not {}", where, key, need, json_description(found))};
}

Status read_numbers(const Json& arr, std::string_view where, const std::string& key, SpeciesParams& out) {
    if (!arr.is_array() || arr.size() > k_arr_length)
        return wrong(where, key, fmt::format("a list of at most {} numbers", k_arr_length), arr);
    for (size_t i = 0; i < arr.size(); ++i)
        if (!arr[i].is_number()) return wrong(where, fmt::format("{}[{}]", key, i), "a number", arr[i]);
    Status status;
    size_t row = 0;
    for_each_field<SpeciesParams>([&](const auto& field) {
        const auto place = static_cast<size_t>(k_species_places[row++]);
        if (!status.ok() || place >= arr.size()) return; // a shorter list sets the first ones only
        status = detail::read_param(field, arr[place], where, fmt::format("{}[{}] ({})", key, place, field.name),
                                    out.*field.member);
    });
    SAHEL_TRY(status);
    if (out.min_light == out.max_light)
        return Error{ErrorKind::usage,
                     fmt::format("{}: '{}[26]' and '{}[27]' (lightConditions) must differ, not both be {}", where, key,
                                 key, out.min_light)};
    return {};
}

} // namespace

Result<std::vector<SceneSpecies>> parse_scene_species(const Json& list, std::string_view where) {
    if (!list.is_array() || list.size() > k_max_species)
        return wrong(where, "vegTypes", fmt::format("a list of at most {} species", k_max_species), list);
    std::vector<SceneSpecies> all;
    for (size_t i = 0; i < list.size(); ++i) {
        const std::string key = fmt::format("vegTypes[{}]", i);
        const Json& object = list[i];
        if (!object.is_object()) return wrong(where, key, "an object", object);
        SceneSpecies species;
        species.name = fmt::format("Type {}", i);
        bool has_numbers = false;
        for (const auto& item : object.items()) {
            const std::string full = key + "." + item.key();
            const Json& value = item.value();
            if (item.key() == "name" || item.key() == "mesh") {
                if (!value.is_string()) return wrong(where, full, "a text", value);
                (item.key() == "name" ? species.name : species.mesh) = value.get<std::string>();
            } else if (item.key() == "arr") {
                SAHEL_TRY(read_numbers(value, where, full, species.params));
                has_numbers = true;
            } else if (item.key() == "dominance") {
                if (!value.is_array() || value.size() > k_max_species)
                    return wrong(where, full, fmt::format("a list of at most {} numbers", k_max_species), value);
                for (size_t j = 0; j < value.size(); ++j) {
                    const float d = value[j].is_number() ? value[j].get<float>() : -1.0f;
                    if (!(d >= 0.0f && d <= 1.0e6f))
                        return wrong(where, fmt::format("{}[{}]", full, j), "a number from 0 to 1e6", value[j]);
                    species.dominance[j] = d;
                }
            } else {
                constexpr std::string_view k_known[] = {"name", "mesh", "arr", "dominance"};
                return unknown_key_error(where, full, k_known);
            }
        }
        if (!has_numbers) return Error{ErrorKind::usage, fmt::format("{}: '{}' lacks the list 'arr'", where, key)};
        all.push_back(std::move(species));
    }
    return all;
}

} // namespace sahel
