#include "streaming/streamer.h"
#include "streaming/view_geometry.h"

#include <algorithm>
#include <cmath>

namespace sahel {

Status check_stream(const StreamSettings& settings, const StreamExternals& externals) {
    SAHEL_TRY(check_ranges(settings, "stream settings"));
    const auto refuse = [](const std::string& text) { return Error{ErrorKind::usage, "stream settings: " + text}; };
    const auto mib_for = [](uint64_t bytes) { return std::to_string((bytes + (1u << 20) - 1) >> 20); };
    const uint64_t mib = 1u << 20;
    const int across = 2 * settings.root_radius + 2; // with those that come next
    const int roots = 2 * across * across;           // and those of the view before a jump
    if (roots > settings.slots)
        return refuse("slots must be at least " + std::to_string(roots) + " for root_radius " +
                      std::to_string(settings.root_radius));
    const uint64_t payload = externals.max_payload_bytes, context = externals.max_context_bytes;
    if (payload > static_cast<uint64_t>(settings.in_flight_mib) * mib)
        return refuse("in_flight_mib must be at least " + mib_for(payload) + ", the size of one tile");
    if (payload > static_cast<uint64_t>(settings.publish_mib_per_frame) * mib)
        return refuse("publish_mib_per_frame must be at least " + mib_for(payload) + ", the size of one tile");
    const uint64_t contexts = 2 * context * static_cast<uint64_t>(roots);
    if (contexts > static_cast<uint64_t>(settings.context_mib) * mib)
        return refuse("context_mib must be at least " + mib_for(contexts) + " for the roots");
    if (!(externals.cell_m > 0.0) || !std::isfinite(externals.cell_m)) return refuse("cell_m must be positive");
    return {};
}

StreamBytes plan_stream_bytes(const StreamSettings& settings, const StreamExternals& externals) {
    StreamBytes b;
    b.slots = static_cast<uint64_t>(settings.slots) * externals.slot_bytes;
    b.in_flight = static_cast<uint64_t>(settings.in_flight_mib) << 20;
    b.contexts = static_cast<uint64_t>(settings.context_mib) << 20;
    return b;
}

double error_px_of(float lod_factor, int view_cells, double vertical_fov_rad, int viewport_height_px) {
    const double pixel_rad = 2.0 * std::tan(0.5 * vertical_fov_rad) / viewport_height_px;
    return 2.0 / (static_cast<double>(lod_factor) * view_cells * pixel_rad);
}

float lod_factor_for(double error_px, int view_cells, double vertical_fov_rad, int viewport_height_px) {
    const double f = error_px_of(1.0f, view_cells, vertical_fov_rad, viewport_height_px) / error_px;
    return static_cast<float>(std::clamp(f, 1.5, 6.0));
}

int root_level_for(double view_distance_m, double cell_m, int view_cells, int root_radius) {
    // From the edge of the eye's own root, root_radius sides are left; of radius 0 nothing more than its own half.
    const double sides = root_radius > 0 ? root_radius : 0.5;
    int level = 0;
    while (level < 20 && std::ldexp(cell_m * view_cells, level) * sides < view_distance_m) ++level;
    return level;
}

double horizon_m(double eye_m, double top_m) {
    const auto reach = [](double h) { return std::sqrt(2.0 * k_earth_radius_m * std::max(0.0, h)); };
    return reach(eye_m) + reach(top_m);
}

} // namespace sahel
