#include "world/world_json.h"

#include "world/params_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace sahel {

namespace {

constexpr int k_min_tile_cells = 128;
constexpr int k_max_tile_cells = 8192;

/// Reads the keys of one object; what is left over at the end is unknown.
class Reader {
  public:
    Reader(const Json& object, std::string_view where, std::string prefix)
        : object_(object), where_(where), prefix_(std::move(prefix)) {}

    template <class T> void take(const char* key, T& out, bool required = false) {
        known_.emplace_back(key);
        const auto found = object_.find(key);
        if (found == object_.end()) {
            if (required) fail(key, "is missing");
            return;
        }
        const bool fits = std::is_same_v<T, std::string> ? found->is_string()
                          : std::is_integral_v<T>        ? found->is_number_integer()
                                                         : found->is_number();
        if (!fits) return fail(key, "has the wrong type: " + json_description(*found));
        if constexpr (std::is_integral_v<T>) {
            const bool holds = found->is_number_unsigned() ? std::in_range<T>(found->template get<uint64_t>())
                                                           : std::in_range<T>(found->template get<int64_t>());
            if (!holds) return fail(key, "is out of range: " + json_description(*found));
        }
        out = found->template get<T>();
    }
    const Json* object(const char* key) {
        known_.emplace_back(key);
        const auto found = object_.find(key);
        if (found == object_.end() || found->is_null()) return nullptr;
        if (!found->is_object()) {
            fail(key, "has the wrong type: an object is wanted");
            return nullptr;
        }
        return &*found;
    }
    void fail(const std::string& key, const std::string& why) {
        if (status_.ok()) status_ = Error{ErrorKind::usage, fmt::format("{}: {}{} {}", where_, prefix_, key, why)};
    }
    Status finish() {
        for (const auto& item : object_.items())
            if (std::find(known_.begin(), known_.end(), item.key()) == known_.end())
                fail(item.key(), fmt::format("is not a key of this file; it knows {}", fmt::join(known_, ", ")));
        return status_;
    }

  private:
    const Json& object_;
    std::string_view where_;
    std::string prefix_;
    std::vector<std::string> known_;
    Status status_;
};

} // namespace

std::string world_json(const WorldDesc& desc) {
    Json json = Json::object();
    json["format_version"] = k_world_format_version;
    json["name"] = desc.name;
    json["preset"] = desc.preset;
    json["seed"] = desc.seed;
    json["tile_cells"] = desc.tile_cells;
    json["cell_m"] = desc.cell_m;
    if (desc.preset == "none") json["outside_m"] = desc.outside_m;
    if (desc.sea_m) json["sea_m"] = *desc.sea_m;
    if (desc.georeference) {
        const GeoReference& g = *desc.georeference;
        json["georeference"] = {{"projection_wkt", g.projection_wkt},
                                {"origin_x", g.origin_x},
                                {"origin_y", g.origin_y},
                                {"cell_x", g.cell_x},
                                {"cell_y", g.cell_y},
                                {"datum_m", g.datum_m}};
    }
    if (desc.preset != "none") json["terrain"] = params_to_json(desc.terrain);
    if (!desc.simulation.empty()) json["simulation"] = Json::parse(desc.simulation); // check_world_desc looked at it
    return json.dump(2) + "\n";
}

Result<WorldDesc> parse_world_json(std::string_view text, std::string_view where) {
    SAHEL_ASSIGN(const Json json, parse_json(text, where));
    if (!json.is_object()) return Error{ErrorKind::corrupt, fmt::format("{}: not a JSON object", where)};
    WorldDesc desc;
    int version = 0;
    double sea_m = std::nan("");
    Reader reader(json, where, "");
    reader.take("format_version", version, true);
    if (version > k_world_format_version)
        return Error{ErrorKind::unsupported,
                     fmt::format("{}: world format {} is newer than this program's {}; use a newer sahel", where,
                                 version, k_world_format_version)};
    if (version < 1) reader.fail("format_version", "must be at least 1");
    reader.take("name", desc.name);
    reader.take("preset", desc.preset, true);
    reader.take("seed", desc.seed, true);
    reader.take("tile_cells", desc.tile_cells, true);
    reader.take("cell_m", desc.cell_m, true);
    reader.take("outside_m", desc.outside_m);
    reader.take("sea_m", sea_m);
    if (!std::isnan(sea_m)) desc.sea_m = sea_m;
    if (const Json* geo = reader.object("georeference")) {
        GeoReference g;
        Reader inner(*geo, where, "georeference.");
        inner.take("projection_wkt", g.projection_wkt);
        inner.take("origin_x", g.origin_x);
        inner.take("origin_y", g.origin_y);
        inner.take("cell_x", g.cell_x);
        inner.take("cell_y", g.cell_y);
        inner.take("datum_m", g.datum_m);
        SAHEL_TRY(inner.finish());
        desc.georeference = g;
    }
    const Json* terrain = reader.object("terrain");
    if (const Json* simulation = reader.object("simulation")) desc.simulation = simulation->dump();
    SAHEL_TRY(reader.finish());
    if (desc.preset != "none") {
        auto preset = base_terrain_preset(desc.preset);
        if (!preset.ok()) return Error{ErrorKind::usage, fmt::format("{}: preset: {}", where, preset.error().message)};
        desc.terrain = *preset;
    }
    // A missing key keeps the preset's value, so files written before a parameter was added still open.
    if (terrain) {
        SAHEL_ASSIGN(desc.terrain, params_from_json(*terrain, where, "terrain", desc.terrain));
    }
    SAHEL_TRY(check_world_desc(desc, where));
    return desc;
}

Status check_world_desc(const WorldDesc& desc, std::string_view where) {
    const auto bad = [&](const std::string& why) { return Error{ErrorKind::usage, fmt::format("{}: {}", where, why)}; };
    if (desc.tile_cells < k_min_tile_cells || desc.tile_cells > k_max_tile_cells ||
        !std::has_single_bit(static_cast<unsigned>(desc.tile_cells)))
        return bad(fmt::format("tile_cells {} must be a power of two from {} to {}", desc.tile_cells, k_min_tile_cells,
                               k_max_tile_cells));
    if (!(desc.cell_m >= 0.01 && desc.cell_m <= 10000.0))
        return bad(fmt::format("cell_m {} must lie between 0.01 and 10000", desc.cell_m));
    if (!(std::abs(desc.outside_m) < 16000.0))
        return bad(fmt::format("outside_m {} must lie between -16000 and 16000", desc.outside_m));
    if (desc.sea_m && !(std::abs(*desc.sea_m) < 16000.0))
        return bad(fmt::format("sea_m {} must lie between -16000 and 16000", *desc.sea_m));
    if (const auto& g = desc.georeference)
        for (const double v : {g->origin_x, g->origin_y, g->cell_x, g->cell_y, g->datum_m})
            if (!(std::abs(v) < 1e12)) return bad(fmt::format("georeference holds {}, beyond any map", v));
    if (desc.preset != "none") SAHEL_TRY(check_ranges(desc.terrain, where));
    if (!desc.simulation.empty()) {
        SAHEL_ASSIGN(const Json simulation, parse_json(desc.simulation, where));
        if (!simulation.is_object()) return bad("simulation must be an object");
    }
    return {};
}

} // namespace sahel
