#include "tools/tour.h"

#include "tools/flight.h"
#include "world/ground_sampler.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace sahel::tools {

namespace {

constexpr double k_rad = 0.017453292519943295;
constexpr int k_level = 5;         // 32 m cells: what matters for composition
constexpr double k_grid_m = 128.0; // between candidates
constexpr int k_half_grid = 72;    // +-9 km round the origin
constexpr int k_side = 2 * k_half_grid + 1;

struct Place {
    double ground_m = 0.0, water_m = 0.0, sand_m = 0.0;
};

/// The surroundings of the origin on a coarse grid.
class Survey {
  public:
    explicit Survey(GroundSampler& ground) : places_(static_cast<size_t>(k_side) * k_side) {
        for (int j = 0; j < k_side; ++j)
            for (int i = 0; i < k_side; ++i) {
                const GroundSample s = ground.at(metres(i), metres(j));
                places_[index(i, j)] = {s.ground_m, s.water_m, s.sand_m};
            }
    }
    [[nodiscard]] static double metres(int i) { return (i - k_half_grid) * k_grid_m; }
    [[nodiscard]] const Place& at(int i, int j) const {
        return places_[index(std::clamp(i, 0, k_side - 1), std::clamp(j, 0, k_side - 1))];
    }
    [[nodiscard]] const Place& near(double x, double y) const {
        return at(static_cast<int>(std::lround(x / k_grid_m)) + k_half_grid,
                  static_cast<int>(std::lround(y / k_grid_m)) + k_half_grid);
    }
    /// Best inner grid point by score(i, j).
    template <class F> std::array<double, 2> best(int margin, F&& score) const {
        double top = -1e300;
        std::array<double, 2> at_m{};
        for (int j = margin; j < k_side - margin; ++j)
            for (int i = margin; i < k_side - margin; ++i)
                if (const double s = score(i, j); s > top) {
                    top = s;
                    at_m = {metres(i), metres(j)};
                }
        return at_m;
    }

  private:
    static size_t index(int i, int j) { return static_cast<size_t>(j) * k_side + static_cast<size_t>(i); }
    std::vector<Place> places_;
};

/// Steepest view upwards within 9 km, degrees of azimuth: where the range stands.
double towards_relief(const Survey& survey, double x, double y, double from_m, double to_m) {
    double best = -1e30, yaw = 0.0;
    for (int a = 0; a < 72; ++a) {
        const double dx = std::cos(a * 5.0 * k_rad), dy = std::sin(a * 5.0 * k_rad);
        double seen = -1e30;
        for (double d = from_m; d <= to_m; d += 200.0) {
            const Place& p = survey.near(x + dx * d, y + dy * d);
            seen = std::max(seen, (p.ground_m - survey.near(x, y).ground_m) / (d + 1500.0));
        }
        if (seen > best) {
            best = seen;
            yaw = a * 5.0;
        }
    }
    return yaw;
}

Atmosphere golden(double view_yaw_deg, double off_deg, double elevation_deg, double haze) {
    Atmosphere a = atmosphere_presets()[0].atmosphere;
    a.sun_azimuth_deg = static_cast<float>(wrap_degrees(view_yaw_deg + off_deg));
    a.sun_elevation_deg = static_cast<float>(elevation_deg);
    a.haze_per_m = static_cast<float>(haze);
    return a;
}

CameraPose pose_at(GroundSampler& fine, double x, double y, double above_m, double yaw, double pitch) {
    CameraPose pose;
    double high = fine.surface_m(x, y);
    for (int i = 0; i < 12; ++i)
        high = std::max(high, fine.surface_m(x + 4.0 * std::cos(i * 0.5236), y + 4.0 * std::sin(i * 0.5236)));
    pose.eye_m = {x, y, high + above_m};
    pose.yaw_deg = yaw;
    pose.pitch_deg = pitch;
    return pose;
}

/// Among points round a place, the one that stands highest: a crest to look from.
std::array<double, 2> crest_near(GroundSampler& fine, double x, double y, double radius_m) {
    double best = -1e30;
    std::array<double, 2> at{x, y};
    for (double dy = -radius_m; dy <= radius_m; dy += 12.0)
        for (double dx = -radius_m; dx <= radius_m; dx += 12.0)
            if (const double h = fine.surface_m(x + dx, y + dy); h > best) {
                best = h;
                at = {x + dx, y + dy};
            }
    return at;
}

} // namespace

Result<Tour> plan_tour(const World& world, double seconds) {
    GroundSampler coarse(world.surface(), k_level), fine(world.surface(), 0);
    const Survey survey(coarse);
    constexpr int k_margin = 16;
    const auto relief = [&](int i, int j, int r) {
        double low = 1e30, high = -1e30;
        for (int dj = -r; dj <= r; dj += std::max(1, r / 2))
            for (int di = -r; di <= r; di += std::max(1, r / 2)) {
                low = std::min(low, survey.at(i + di, j + dj).ground_m);
                high = std::max(high, survey.at(i + di, j + dj).ground_m);
            }
        return high - low;
    };
    const auto water_within = [&](int i, int j, int r) {
        double sum = 0.0;
        for (int dj = -r; dj <= r; ++dj)
            for (int di = -r; di <= r; ++di) sum += std::min(survey.at(i + di, j + dj).water_m, 2.0);
        return sum;
    };

    // Dunes: deep sand that varies. Shore: dry, water near, relief behind. Heights: high ground over low.
    const auto dunes = survey.best(k_margin, [&](int i, int j) {
        double mean = 0.0, square = 0.0;
        for (int dj = -4; dj <= 4; ++dj)
            for (int di = -4; di <= 4; ++di) {
                const double s = survey.at(i + di, j + dj).sand_m;
                mean += s / 81.0;
                square += s * s / 81.0;
            }
        return std::sqrt(std::max(0.0, square - mean * mean)) + 0.5 * std::min(mean, 12.0) + 0.004 * relief(i, j, 4) -
               8.0 * survey.at(i, j).water_m;
    });
    const auto shore = survey.best(k_margin, [&](int i, int j) {
        if (survey.at(i, j).water_m > 0.05) return -1e6 - survey.at(i, j).water_m;
        return std::min(water_within(i, j, 4), 40.0) * 0.5 + std::min(relief(i, j, 40), 900.0) * 0.02 +
               std::min(survey.at(i, j).sand_m, 4.0);
    });
    const auto front = survey.best(k_margin, [&](int i, int j) {
        // Low ground with a wall of mountains one to three kilometres away.
        double wall = -1e30;
        for (int a = 0; a < 16; ++a)
            wall = std::max(wall, survey
                                      .near(survey.metres(i) + 1800.0 * std::cos(a * 0.3927),
                                            survey.metres(j) + 1800.0 * std::sin(a * 0.3927))
                                      .ground_m);
        return wall - survey.at(i, j).ground_m - 30.0 * std::min(survey.at(i, j).water_m, 3.0);
    });

    Tour tour{CameraPath{}, {}, {}};
    {
        const auto crest = crest_near(fine, dunes[0], dunes[1], 120.0);
        const double yaw = towards_relief(survey, crest[0], crest[1], 2500.0, 9000.0);
        tour.stills.push_back(
            {"dunes", pose_at(fine, crest[0], crest[1], 5.0, yaw, -5.0), golden(yaw, 62.0, 9.0, 9e-5)});
    }
    const double shore_yaw = [&] { // over the water, with the range behind it
        double best = -1e30, yaw = 0.0;
        const double range = towards_relief(survey, shore[0], shore[1], 2500.0, 9000.0);
        for (int a = 0; a < 72; ++a) {
            double wet = 0.0;
            for (double d = 60.0; d < 900.0; d += 60.0) {
                const GroundSample s =
                    coarse.at(shore[0] + d * std::cos(a * 5.0 * k_rad), shore[1] + d * std::sin(a * 5.0 * k_rad));
                wet += s.water_m > 0.2 ? 1.0 : 0.0;
            }
            const double score = wet + 5.0 * std::cos((a * 5.0 - range) * k_rad);
            if (score > best) {
                best = score;
                yaw = a * 5.0;
            }
        }
        return yaw;
    }();
    tour.stills.push_back(
        {"shore", pose_at(fine, shore[0], shore[1], 6.0, shore_yaw, -4.0), golden(shore_yaw, -70.0, 11.0, 5e-5)});
    {
        const double yaw = towards_relief(survey, front[0], front[1], 800.0, 3500.0);
        tour.stills.push_back(
            {"mountains", pose_at(fine, front[0], front[1], 25.0, yaw, 2.0), golden(yaw, 75.0, 14.0, 5e-5)});
    }
    {
        const double back = 700.0;
        const double x = shore[0] - back * std::cos(shore_yaw * k_rad),
                     y = shore[1] - back * std::sin(shore_yaw * k_rad);
        tour.stills.push_back(
            {"high", pose_at(fine, x, y, 130.0, shore_yaw, -9.0), golden(shore_yaw, 65.0, 17.0, 5e-5)});
    }

    // The flight: from dry land over the shore towards the range.
    FlyoverOptions options;
    const double c = std::cos(shore_yaw * k_rad), s = std::sin(shore_yaw * k_rad);
    for (const auto& [along, aside] :
         {std::pair{-420.0, -60.0}, {-180.0, 30.0}, {120.0, 60.0}, {420.0, 0.0}, {760.0, -90.0}})
        options.waypoints_m.push_back({shore[0] + along * c - aside * s, shore[1] + along * s + aside * c});
    options.height_m = 34.0;
    options.look_down_deg = 5.0;
    options.duration_s = seconds;
    GroundSampler path_ground(world.surface(), 1);
    SAHEL_ASSIGN(tour.flight, flyover_path(options, camera_ground(path_ground)));
    tour.atmosphere = golden(shore_yaw, 62.0, 11.0, 5e-5);
    return tour;
}

} // namespace sahel::tools
