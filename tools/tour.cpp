#include "tools/tour.h"

#include "render/camera_search.h"
#include "render/view_score.h"
#include "tools/flight.h"
#include "world/executor.h"
#include "world/ground_sampler.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

namespace sahel::tools {

namespace {

constexpr double k_rad = std::numbers::pi / 180.0;
constexpr std::array k_kinds = {ViewKind::dunes, ViewKind::shore, ViewKind::mountains, ViewKind::high,
                                ViewKind::canyon};
constexpr size_t k_stills = 4;
constexpr int k_proposals = 3; ///< views of a kind from which flights may start

Atmosphere golden_hour(double sun_azimuth_deg, double sun_elevation_deg) {
    Atmosphere a = atmosphere_presets()[0].atmosphere;
    a.sun_azimuth_deg = static_cast<float>(wrap_degrees(sun_azimuth_deg));
    a.sun_elevation_deg = static_cast<float>(sun_elevation_deg);
    return a;
}

TourStill still_of(const std::string& name, const FoundView& view, const CameraSearchOptions& searched) {
    return {name, view.pose, golden_hour(view.sun_azimuth_deg, searched.sun_elevation_deg), view.score};
}

/// The best view of each kind that is good, then the best of what is left: four where the landscape has four. A
/// landscape without mountains shows more of its dunes.
std::vector<FoundView> choose_stills(const std::vector<FoundView>& found) {
    constexpr double k_good = 0.62;
    std::vector<FoundView> chosen, rest;
    for (const FoundView& view : found) {
        const bool first =
            std::none_of(chosen.begin(), chosen.end(), [&](const auto& c) { return c.kind == view.kind; });
        (first && view.score >= k_good ? chosen : rest).push_back(view);
    }
    if (chosen.size() > k_stills) chosen.resize(k_stills);
    std::stable_sort(rest.begin(), rest.end(), [](const auto& a, const auto& b) { return a.score > b.score; });
    for (const FoundView& view : rest)
        if (chosen.size() < k_stills) chosen.push_back(view);
    return chosen;
}

struct Flight {
    CameraPath path;
    double sun_azimuth_deg = 0.0;
    double score = -1.0;
};

/// A bend towards what the view shows, from behind its standpoint.
Result<CameraPath> flight_from(const FoundView& view, double bend, double seconds, const GroundFunction& ground) {
    FlyoverOptions o;
    const double c = std::cos(view.pose.yaw_deg * k_rad), s = std::sin(view.pose.yaw_deg * k_rad);
    for (const double along : {-160.0, 40.0, 240.0, 460.0, 700.0, 960.0}) {
        const double aside = bend * 90.0 * std::sin((along + 160.0) / 1120.0 * std::numbers::pi);
        o.waypoints_m.push_back(
            {view.pose.eye_m[0] + along * c - aside * s, view.pose.eye_m[1] + along * s + aside * c});
    }
    o.height_m = view.kind == ViewKind::high ? 60.0 : 26.0;
    o.look_down_deg = 4.0;
    o.duration_s = seconds;
    return flyover_path(o, ground);
}

/// Mean worth of what the flight sees, the poorest moment counted twice, and how much it changes on the way: ten
/// seconds over open water show one picture.
double flight_score(ViewTerrain& terrain, const CameraPath& path, double sun_azimuth_deg, double sun_elevation_deg) {
    double sum = 0.0, least = 1.0, change = 0.0;
    constexpr int k_moments = 5;
    ViewMeasures last;
    for (int i = 0; i < k_moments; ++i) {
        const CameraPose pose = path.pose_at(path.start_s() + path.duration_s() * i / (k_moments - 1));
        const Panorama panorama = cast_panorama(terrain, pose.eye_m);
        const ViewMeasures m = measure_view(panorama, pose, sun_azimuth_deg, sun_elevation_deg);
        double best = 0.0;
        for (const ViewKind kind :
             {ViewKind::dunes, ViewKind::lake, ViewKind::shore, ViewKind::mountains, ViewKind::high})
            best = std::max(best, score_view(kind, m));
        const double sunlit = sunlit_share(terrain, panorama, pose, sun_azimuth_deg, sun_elevation_deg);
        best *= std::clamp((sunlit - 0.15) / 0.40, 0.0, 1.0);
        sum += best + 0.5 * rising(m.water, 0.0, 0.08) * (1.0 - rising(m.water, 0.25, 0.45)) +
               0.5 * rising(m.layers, 0.5, 2.5);
        least = std::min(least, best);
        if (i > 0)
            change += std::abs(m.water - last.water) + std::abs(m.sand - last.sand) + std::abs(m.middle - last.middle) +
                      std::abs(m.dunes - last.dunes);
        last = m;
    }
    return (sum + least) / (k_moments + 1) + 0.4 * rising(change / (k_moments - 1), 0.03, 0.25);
}

Result<Flight> choose_flight(const World& world, const std::vector<FoundView>& found, double sun_elevation_deg,
                             double seconds) {
    GroundSampler sampler(world.surface(), 1);
    const GroundFunction ground = camera_ground(sampler);
    std::vector<Flight> flights;
    for (const FoundView& view : found)
        for (const double bend : {-1.0, 1.0}) {
            SAHEL_ASSIGN(CameraPath path, flight_from(view, bend, seconds, ground));
            flights.push_back({std::move(path), view.sun_azimuth_deg, -1.0});
        }
    tbb::enumerable_thread_specific<ViewTerrain> terrains([&] { return ViewTerrain(world.surface()); });
    for_each_index("tour/flights", static_cast<int64_t>(flights.size()), [&](int64_t i) {
        Flight& f = flights[static_cast<size_t>(i)];
        f.score = flight_score(terrains.local(), f.path, f.sun_azimuth_deg, sun_elevation_deg);
    });
    return *std::max_element(flights.begin(), flights.end(),
                             [](const Flight& a, const Flight& b) { return a.score < b.score; });
}

} // namespace

Result<Tour> plan_tour(const World& world, double seconds) {
    CameraSearchOptions options;
    options.kinds.assign(k_kinds.begin(), k_kinds.end());
    options.per_kind = k_proposals;
    options.standpoints = 32;  // a second or two for pictures that hold more
    options.least_score = 0.0; // a plain is shown as well as it can be
    SAHEL_ASSIGN(const std::vector<FoundView> found, find_views(world.surface(), options));
    Tour tour;
    for (const FoundView& view : choose_stills(found)) {
        std::string name(name_of(view.kind));
        const auto same = std::count_if(tour.stills.begin(), tour.stills.end(),
                                        [&](const TourStill& s) { return s.name.starts_with(name); });
        if (same > 0) name += std::to_string(same + 1);
        tour.stills.push_back(still_of(name, view, options));
    }
    if (found.empty()) {
        GroundSampler ground(world.surface(), 1);
        SAHEL_ASSIGN(tour.flight, default_path(world, ground, seconds));
        return tour;
    }
    SAHEL_ASSIGN(const Flight flight, choose_flight(world, found, options.sun_elevation_deg, seconds));
    tour.flight = flight.path;
    tour.atmosphere = golden_hour(flight.sun_azimuth_deg, options.sun_elevation_deg);
    return tour;
}

Status look_again_at_dunes(const World& world, const TileRect& blown, Tour& tour) {
    const double tile_m = world.desc().tile_cells * world.desc().cell_m;
    const auto within = [&](double x_m, double y_m) {
        return x_m > blown.x0 * tile_m && x_m < blown.x1 * tile_m && y_m > blown.y0 * tile_m && y_m < blown.y1 * tile_m;
    };
    // What fills the picture: the ground so far ahead, to both sides of the heading.
    const auto inside = [&](const FoundView& view, double reach_m) {
        const Vec3d& eye = view.pose.eye_m;
        bool all = within(eye[0], eye[1]);
        for (const double aside_deg : {-35.0, 0.0, 35.0}) {
            const double yaw = (view.pose.yaw_deg + aside_deg) * k_rad;
            all = all && within(eye[0] + reach_m * std::cos(yaw), eye[1] + reach_m * std::sin(yaw));
        }
        return all;
    };
    for (TourStill& still : tour.stills) {
        if (still.name != name_of(ViewKind::dunes)) continue;
        CameraSearchOptions options;
        options.kinds = {ViewKind::dunes};
        options.centre_m = {0.5 * (blown.x0 + blown.x1) * tile_m, 0.5 * (blown.y0 + blown.y1) * tile_m};
        options.sites_m = {options.centre_m, {still.pose.eye_m[0], still.pose.eye_m[1]}};
        options.radius_m = std::clamp(0.5 * (blown.x1 - blown.x0) * tile_m, 200.0, 5000.0);
        options.per_kind = 24;
        options.spacing_m = 30.0;
        options.least_score = 0.0;
        SAHEL_ASSIGN(const std::vector<FoundView> found, find_views(world.surface(), options));
        if (found.empty()) continue;
        auto best = found.end();
        for (const double reach_m : {600.0, 450.0, 300.0})
            if (best == found.end())
                best = std::find_if(found.begin(), found.end(),
                                    [&](const FoundView& view) { return inside(view, reach_m); });
        still = still_of(still.name, best == found.end() ? found.front() : *best, options);
    }
    return {};
}

} // namespace sahel::tools
