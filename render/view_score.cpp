#include "render/view_score.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace sahel {

namespace {

constexpr double k_rad = std::numbers::pi / 180.0;
constexpr double k_aspect = 16.0 / 9.0;

/// 0 up to a, 1 from b to c, 0 from d on; straight in between.
double plateau(double x, double a, double b, double c, double d) {
    if (x <= a || x >= d) return 0.0;
    if (x < b) return (x - a) / (b - a);
    if (x > c) return (d - x) / (d - c);
    return 1.0;
}

/// Mean and standard deviation, one value at a time.
struct Spread {
    double n = 0.0, sum = 0.0, squares = 0.0;
    void add(double v) {
        n += 1.0;
        sum += v;
        squares += v * v;
    }
    [[nodiscard]] double mean() const { return n > 0.0 ? sum / n : 0.0; }
    [[nodiscard]] double deviation() const {
        return n > 0.0 ? std::sqrt(std::max(0.0, squares / n - mean() * mean())) : 0.0;
    }
};

int column_of(double azimuth_deg) {
    return static_cast<int>(std::floor(azimuth_deg / Panorama::k_step_deg));
}
double half_width_deg(double vertical_fov_deg) {
    return std::atan(std::tan(vertical_fov_deg * k_rad / 2.0) * k_aspect) / k_rad;
}

/// Edges of a column behind which the land goes on farther away than a plain would.
double edges_of(const Panorama& panorama, int column, int top, int bottom) {
    double edges = 0.0;
    for (int r = bottom - 1; r > top; --r) {
        const Panorama::Pixel &near = panorama.at(column, r), &beyond = panorama.at(column, r - 1);
        if (near.material == ViewMaterial::sky || beyond.material == ViewMaterial::sky) continue;
        const double down = (r + 0.5) * Panorama::k_step_deg - Panorama::k_top_deg;
        const double beyond_down = down - Panorama::k_step_deg;
        const double plain = beyond_down > 0.0 ? std::tan(down * k_rad) / std::tan(beyond_down * k_rad)
                             : down > -0.5     ? 4.0
                                               : 1.0;
        if (static_cast<double>(beyond.distance_m) > 1.15 * plain * static_cast<double>(near.distance_m)) edges += 1.0;
    }
    return edges;
}

} // namespace

double rising(double x, double from, double to) {
    return std::clamp((x - from) / (to - from), 0.0, 1.0);
}

double eye_height_m(ViewKind kind) {
    switch (kind) {
    case ViewKind::dunes:
        return 4.5;
    case ViewKind::lake:
        return 5.0;
    case ViewKind::shore:
        return 9.0;
    case ViewKind::canyon:
        return 6.0;
    case ViewKind::mountains:
        return 7.0;
    case ViewKind::high:
    case ViewKind::count_:
        break;
    }
    return 130.0;
}

double pitch_for(ViewKind kind, const Panorama& panorama, double yaw_deg, double vertical_fov_deg) {
    const double half = half_width_deg(vertical_fov_deg);
    std::vector<float> skyline;
    for (int c = column_of(yaw_deg - half); c <= column_of(yaw_deg + half); ++c) {
        const int wrapped = ((c % Panorama::k_columns) + Panorama::k_columns) % Panorama::k_columns;
        skyline.push_back(panorama.skyline_deg[static_cast<size_t>(wrapped)]);
    }
    const auto middle = skyline.begin() + static_cast<ptrdiff_t>(skyline.size() / 2);
    std::nth_element(skyline.begin(), middle, skyline.end());
    // A sixth of the height above the middle is the line between the upper third and the rest; from high up the land is
    // what there is to see, and the line lies at a quarter.
    const double above = kind == ViewKind::high ? 1.0 / 2.0 : 1.0 / 3.0;
    const double drop = std::atan(std::tan(vertical_fov_deg * k_rad / 2.0) * above) / k_rad;
    return std::clamp(static_cast<double>(*middle) - drop, -16.0, 6.0);
}

ViewMeasures measure_view(const Panorama& panorama, const CameraPose& pose, double sun_azimuth_deg,
                          double sun_elevation_deg) {
    const Vec3d sun = view_direction({.yaw_deg = sun_azimuth_deg, .pitch_deg = sun_elevation_deg});
    const double half = half_width_deg(pose.vertical_fov_deg);
    const int first = column_of(pose.yaw_deg - half), last = column_of(pose.yaw_deg + half);
    const auto row_of = [](double elevation_deg) {
        return std::clamp(static_cast<int>((Panorama::k_top_deg - elevation_deg) / Panorama::k_step_deg), 0,
                          Panorama::k_rows);
    };
    const int top = row_of(pose.pitch_deg + pose.vertical_fov_deg / 2.0);
    const int bottom = row_of(pose.pitch_deg - pose.vertical_fov_deg / 2.0);

    ViewMeasures m;
    double all = 0.0, ground = 0.0, middle_sand = 0.0, far_slopes = 0.0, edge = 0.0, water_left = 0.0,
           water_right = 0.0;
    std::array<double, 5> by_material{};
    Spread light, near_light, middle_light, far_line, line;
    for (int c = first; c <= last; c += 2) {
        m.layers += edges_of(panorama, c, top, bottom);
        const bool at_side = c < first + 2 || c + 2 > last;
        for (int r = top; r < bottom; r += 2) {
            const Panorama::Pixel& p = panorama.at(c, r);
            all += 1.0;
            if (p.material != ViewMaterial::sky && (at_side || r + 2 >= bottom)) {
                edge += 1.0;
                m.water_cut += p.material == ViewMaterial::water ? 1.0 : 0.0;
            }
            by_material[static_cast<size_t>(p.material)] += 1.0;
            if (p.material == ViewMaterial::sky) continue;
            const double d = static_cast<double>(p.distance_m);
            (d < 60.0 ? m.near_ground : d < 900.0 ? m.middle : m.far) += 1.0;
            if (p.material == ViewMaterial::water) {
                if (d < 80.0) m.near_water += 1.0;
                if (d < 200.0) (2 * c < first + last ? water_left : water_right) += 1.0;
                continue;
            }
            ground += 1.0;
            const double east = static_cast<double>(p.east), south = static_cast<double>(p.south);
            const double slope2 = east * east + south * south;
            const double lit = std::max(0.0, (sun[2] - east * sun[0] - south * sun[1]) / std::sqrt(1.0 + slope2));
            light.add(lit);
            if (d < 60.0) near_light.add(lit);
            if (d >= 60.0 && d < 2500.0) middle_light.add(lit);
            if (p.material == ViewMaterial::sand && slope2 > 0.04 && d >= 60.0 && d < 4000.0) m.dunes += 1.0;
            m.lit += lit > 0.02 ? 1.0 : 0.0;
            if (slope2 > 0.04 && d > 900.0) {
                far_slopes += 1.0;
                m.far_lit += lit > 0.12 ? 1.0 : 0.0;
            }
            if (slope2 > 0.64 && d >= 60.0 && d < 4000.0) m.steep += 1.0;
            if (p.material == ViewMaterial::sand && d >= 60.0 && d < 900.0) {
                middle_sand += 1.0;
                m.dune_flanks += slope2 > 0.04 ? 1.0 : 0.0;
            }
        }
        const auto wrapped =
            static_cast<size_t>(((c % Panorama::k_columns) + Panorama::k_columns) % Panorama::k_columns);
        const double skyline = static_cast<double>(panorama.skyline_deg[wrapped]);
        line.add(skyline);
        m.skyline_top_deg = c == first ? skyline : std::max(m.skyline_top_deg, skyline);
        if (panorama.skyline_m[wrapped] > 1200.0f) far_line.add(skyline);
        const bool central = std::abs(c - (first + last) / 2) * 2 < (last - first) * 2 / 3;
        if (central && panorama.near_rise_deg[wrapped] > -1.5f) m.blocked += 1.0;
    }
    all = std::max(all, 1.0);
    m.sky = by_material[0] / all;
    m.sand = by_material[static_cast<size_t>(ViewMaterial::sand)] / all;
    m.water = by_material[static_cast<size_t>(ViewMaterial::water)] / all;
    for (size_t i = 1; i < by_material.size(); ++i) m.materials += by_material[i] / all >= 0.05;
    for (double* share : {&m.near_ground, &m.middle, &m.far, &m.near_water, &m.steep, &m.dunes}) *share /= all;
    m.dune_flanks = middle_sand > 0.0 ? m.dune_flanks / middle_sand : 0.0;
    m.water_cut = edge > 0.0 ? m.water_cut / edge : 0.0;
    m.water_lean = std::abs(water_left - water_right) / std::max(1.0, water_left + water_right);
    m.far_lit = far_slopes > 0.0 ? m.far_lit / far_slopes : 0.0;
    m.lit = ground > 0.0 ? m.lit / ground : 0.0;
    m.light_contrast = light.deviation();
    m.middle_contrast = middle_light.deviation();
    m.foreground_contrast = near_light.deviation();
    m.foreground_light = near_light.mean();
    // A far skyline that fills only a corner does not make a range.
    m.far_relief_deg = far_line.deviation() * std::min(1.0, 3.0 * far_line.n / std::max(line.n, 1.0));
    m.layers /= std::max(1.0, line.n);
    m.skyline_mean_deg = line.mean();
    m.blocked /= std::max(1.0, line.n * 2.0 / 3.0);
    m.sun_off_axis_deg = std::abs(wrap_degrees(sun_azimuth_deg - pose.yaw_deg));
    return m;
}

double sunlit_share(ViewTerrain& terrain, const Panorama& panorama, const CameraPose& pose, double sun_azimuth_deg,
                    double sun_elevation_deg) {
    const Vec3d sun = view_direction({.yaw_deg = sun_azimuth_deg, .pitch_deg = sun_elevation_deg});
    const double level_length = std::hypot(sun[0], sun[1]);
    const double climb = sun[2] / std::max(level_length, 1e-6);
    const double ux = sun[0] / std::max(level_length, 1e-6), uy = sun[1] / std::max(level_length, 1e-6);
    const double half = half_width_deg(pose.vertical_fov_deg);
    const auto in_shade = [&](double x, double y, int level) {
        const double from = static_cast<double>(terrain.at(level, x, y).surface_m) + 1.0;
        double step = 2.0 * terrain.cell_m(level);
        for (double d = step; d < 12000.0 && d * climb < 1500.0; d += step) {
            while (level < 8 && terrain.cell_m(level + 1) <= 0.06 * d) ++level;
            step = std::max(step, 0.06 * d);
            if (static_cast<double>(terrain.at(level, x + ux * d, y + uy * d).surface_m) > from + d * climb)
                return true;
        }
        return false;
    };
    double ground = 0.0, lit = 0.0;
    for (int c = column_of(pose.yaw_deg - half); c <= column_of(pose.yaw_deg + half); c += 6)
        for (int r = 0; r < Panorama::k_rows; r += 3) {
            const double elevation = Panorama::k_top_deg - (r + 0.5) * Panorama::k_step_deg;
            if (std::abs(elevation - pose.pitch_deg) > pose.vertical_fov_deg / 2.0) continue;
            const Panorama::Pixel& p = panorama.at(c, r);
            if (p.material == ViewMaterial::sky || p.material == ViewMaterial::water) continue;
            ground += 1.0;
            const double facing = sun[2] - static_cast<double>(p.east) * sun[0] - static_cast<double>(p.south) * sun[1];
            if (facing <= 0.02) continue;
            const double d = static_cast<double>(p.distance_m), azimuth = (c + 0.5) * Panorama::k_step_deg * k_rad;
            int level = 2;
            while (level < 7 && terrain.cell_m(level + 1) <= 0.02 * d) ++level;
            lit +=
                in_shade(pose.eye_m[0] + d * std::cos(azimuth), pose.eye_m[1] + d * std::sin(azimuth), level) ? 0 : 1;
        }
    return ground > 0.0 ? lit / ground : 0.0;
}

double score_view(ViewKind kind, const ViewMeasures& m) {
    double sum = 0.0, weights = 0.0;
    const auto add = [&](double weight, double value) {
        sum += weight * value;
        weights += weight;
    };
    const bool high = kind == ViewKind::high;
    // Three depths.
    if (!high) add(0.6, plateau(m.near_ground, 0.0, 0.08, 0.40, 0.65));
    add(0.6, plateau(m.middle, 0.02, 0.10, 0.60, 0.90));
    add(0.8, high ? plateau(m.far, 0.05, 0.15, 0.50, 0.75) : plateau(m.far, 0.0, 0.03, 0.35, 0.60));
    add(high ? 1.8 : 1.2, rising(m.far_relief_deg, 0.1, kind == ViewKind::mountains ? 3.0 : 1.6));
    // Light from the side, shade as well as light.
    add(0.8, plateau(m.sun_off_axis_deg, 20.0, 40.0, 110.0, 150.0));
    add(0.8, plateau(m.lit, 0.25, 0.50, 0.90, 1.02));
    add(0.6, rising(m.light_contrast, 0.02, 0.14));
    if (kind != ViewKind::dunes) add(high ? 1.5 : 0.8, rising(m.middle_contrast, 0.02, 0.12));
    if (!high) add(0.6, rising(m.foreground_contrast, 0.005, 0.08));
    add(0.8, high ? plateau(m.sky, 0.05, 0.14, 0.30, 0.45) : plateau(m.sky, 0.05, 0.22, 0.42, 0.60));

    double gate = 1.0 - 0.85 * rising(m.blocked, 0.1, 0.5);
    const double land = std::max(1e-6, 1.0 - m.sky - m.water);
    switch (kind) {
    case ViewKind::dunes:
        gate *= rising(m.sand / land, 0.35, 0.75) * (1.0 - rising(m.water, 0.02, 0.10));
        add(2.5, plateau(m.dune_flanks, 0.02, 0.20, 0.75, 1.05));
        add(1.0, m.sand / land);
        break;
    case ViewKind::lake:
        gate *= rising(m.water, 0.02, 0.05);
        add(3.0, plateau(m.water, 0.03, 0.07, 0.22, 0.40));
        add(0.6, 1.0 - rising(m.near_water, 0.02, 0.10));
        break;
    case ViewKind::shore:
        gate *= rising(m.water, 0.05, 0.12) * rising(m.near_water, 0.002, 0.02);
        add(2.0, plateau(m.water, 0.05, 0.12, 0.30, 0.50));
        add(1.5, plateau(m.near_water, 0.0, 0.07, 0.20, 0.40));
        add(2.0, rising(m.water - m.near_water, 0.03, 0.10));    // a lake and not the bend of a stream
        add(1.0, plateau(m.water_lean, 0.05, 0.30, 0.80, 1.10)); // it leads into the picture and does not bar it
        add(1.5, plateau(m.near_ground - m.near_water, 0.02, 0.05, 0.15, 0.30));
        add(0.6, rising(m.foreground_light, 0.08, 0.20));
        add(1.6, rising(m.skyline_top_deg, 1.5, 7.0));
        add(1.6, plateau(m.far_lit, 0.10, 0.4, 0.9, 1.05));
        break;
    case ViewKind::canyon:
        gate *= rising(m.steep, 0.01, 0.05);
        add(3.0, plateau(m.steep, 0.01, 0.08, 0.35, 0.70));
        add(0.8, rising(m.skyline_top_deg - m.skyline_mean_deg, 0.5, 4.0));
        break;
    case ViewKind::mountains:
        gate *= rising(m.skyline_top_deg, 1.0, 4.0);
        add(2.5, rising(m.skyline_top_deg, 2.0, 14.0));
        add(1.0, rising(m.steep, 0.01, 0.12));
        add(0.8, 1.0 - rising(m.near_ground, 0.35, 0.60));
        add(1.0, plateau(m.far_lit, 0.15, 0.5, 0.9, 1.05));
        break;
    case ViewKind::high:
    case ViewKind::count_:
        // Water near enough to be looked into, not a sliver far off, and whole: a lake that the picture cuts is a stain
        // in its corner.
        add(2.5, plateau(m.water, 0.01, 0.06, 0.20, 0.40));
        add(3.0, 1.0 - rising(m.water_cut, 0.0, 0.25));
        add(2.0, rising(m.skyline_top_deg, 1.0, 5.0));
        add(1.0, plateau(m.far_lit, 0.15, 0.5, 0.9, 1.05));
        add(1.2, rising(m.dunes, 0.0, 0.04));
        add(3.0, rising(m.layers, 0.5, 3.0));
        add(1.0, rising(m.materials, 1.0, 3.0));
        break;
    }
    return gate * sum / weights;
}

FoundView best_heading(ViewKind kind, const Panorama& panorama, const Vec3d& eye_m,
                       const CameraSearchOptions& options) {
    FoundView best;
    best.kind = kind;
    best.score = -1.0;
    for (int i = 0; i < 72; ++i) {
        CameraPose pose{.eye_m = eye_m, .yaw_deg = wrap_degrees(5.0 * i), .vertical_fov_deg = options.vertical_fov_deg};
        pose.pitch_deg = pitch_for(kind, panorama, pose.yaw_deg, pose.vertical_fov_deg);
        std::array<double, 2> suns{wrap_degrees(pose.yaw_deg + 66.0), wrap_degrees(pose.yaw_deg - 66.0)};
        if (options.sun_azimuth_deg) suns = {*options.sun_azimuth_deg, *options.sun_azimuth_deg};
        for (const double sun : suns) {
            const ViewMeasures measures = measure_view(panorama, pose, sun, options.sun_elevation_deg);
            const double score = score_view(kind, measures);
            if (score > best.score) best = {kind, pose, sun, score, measures};
            if (options.sun_azimuth_deg) break;
        }
    }
    return best;
}

} // namespace sahel
