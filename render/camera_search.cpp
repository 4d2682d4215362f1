#include "render/camera_search.h"

#include "render/view_panorama.h"
#include "render/view_score.h"
#include "world/executor.h"
#include "world/ground_sampler.h"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sahel {

std::string_view name_of(ViewKind kind) {
    switch (kind) {
    case ViewKind::dunes:
        return "dunes";
    case ViewKind::lake:
        return "lake";
    case ViewKind::shore:
        return "shore";
    case ViewKind::canyon:
        return "canyon";
    case ViewKind::mountains:
        return "mountains";
    case ViewKind::high:
        return "high";
    case ViewKind::count_:
        break;
    }
    return "";
}

namespace {

struct Standpoint {
    ViewKind kind;
    double x_m, y_m;
};

/// Cells of about 32 m around the centre: where standpoints may be worth a look.
class Survey {
  public:
    static Result<Survey> make(const SurfaceSource& source, const CameraSearchOptions& options) {
        Survey s;
        int level = 0;
        while (level < 20 && std::ldexp(source.cell_m(), level) < 24.0) ++level;
        s.cell_m_ = std::ldexp(source.cell_m(), level);
        s.n_ = std::max(16, 2 * static_cast<int>(std::ceil(options.radius_m / s.cell_m_)));
        s.x0_ = static_cast<int64_t>(std::floor(options.centre_m[0] / s.cell_m_)) - s.n_ / 2;
        s.y0_ = static_cast<int64_t>(std::floor(options.centre_m[1] / s.cell_m_)) - s.n_ / 2;
        SAHEL_ASSIGN(LayerBlock block,
                     LayerBlock::allocate(level, {s.x0_, s.y0_, s.x0_ + s.n_, s.y0_ + s.n_}, 0, k_surface_layers));
        SAHEL_TRY(source.read(block));
        const auto rock = block.ints(Layer::bedrock), soil = block.ints(Layer::soil);
        const auto sand = block.ints(Layer::sand), water = block.ints(Layer::water);
        for (int y = 0; y < s.n_; ++y)
            for (int x = 0; x < s.n_; ++x) {
                s.surface_m_.push_back(metres_of_ticks(rock(x, y) + soil(x, y) + sand(x, y) + water(x, y)));
                s.sand_m_.push_back(metres_of_ticks(sand(x, y)));
                s.wet_.push_back(metres_of_ticks(water(x, y)) > 0.1f ? 1 : 0);
            }
        s.measure_water_distance();
        s.measure_relief();
        return s;
    }

    /// The `count` best cells of a kind, spaced apart, as world metres.
    [[nodiscard]] std::vector<Standpoint> propose(ViewKind kind, int count) const {
        struct Ranked {
            float score;
            int x, y;
        };
        std::vector<Ranked> ranked;
        const int margin = std::min(n_ / 8, 12);
        for (int y = margin; y < n_ - margin; ++y)
            for (int x = margin; x < n_ - margin; ++x)
                if (const float score = promise(kind, x, y); score > 0.0f) ranked.push_back({score, x, y});
        std::sort(ranked.begin(), ranked.end(), [](const Ranked& a, const Ranked& b) {
            return a.score != b.score ? a.score > b.score : a.y != b.y ? a.y < b.y : a.x < b.x;
        });
        const int apart = std::max(3, n_ / 24);
        std::vector<Ranked> taken;
        for (const Ranked& r : ranked) {
            if (static_cast<int>(taken.size()) == count) break;
            if (std::none_of(taken.begin(), taken.end(), [&](const Ranked& t) {
                    return std::max(std::abs(t.x - r.x), std::abs(t.y - r.y)) < apart;
                }))
                taken.push_back(r);
        }
        std::vector<Standpoint> points;
        for (const Ranked& r : taken)
            points.push_back({kind, (static_cast<double>(x0_ + r.x) + 0.5) * cell_m_,
                              (static_cast<double>(y0_ + r.y) + 0.5) * cell_m_});
        return points;
    }

  private:
    [[nodiscard]] size_t at(int x, int y) const {
        return static_cast<size_t>(std::clamp(y, 0, n_ - 1)) * static_cast<size_t>(n_) +
               static_cast<size_t>(std::clamp(x, 0, n_ - 1));
    }

    /// Cells to the nearest water, by two sweeps (steps of 1 and 1.5).
    void measure_water_distance() {
        water_cells_.assign(surface_m_.size(), 1e6f);
        for (size_t i = 0; i < wet_.size(); ++i)
            if (wet_[i]) water_cells_[i] = 0.0f;
        const auto relax = [&](int x, int y, int dx, int dy, float step) {
            if (x + dx < 0 || y + dy < 0 || x + dx >= n_ || y + dy >= n_) return;
            float& d = water_cells_[at(x, y)];
            d = std::min(d, water_cells_[at(x + dx, y + dy)] + step);
        };
        for (int y = 0; y < n_; ++y)
            for (int x = 0; x < n_; ++x)
                for (const auto& [dx, dy] : {std::pair{-1, 0}, {0, -1}, {-1, -1}, {1, -1}})
                    relax(x, y, dx, dy, dx && dy ? 1.5f : 1.0f);
        for (int y = n_ - 1; y >= 0; --y)
            for (int x = n_ - 1; x >= 0; --x)
                for (const auto& [dx, dy] : {std::pair{1, 0}, {0, 1}, {1, 1}, {-1, 1}})
                    relax(x, y, dx, dy, dx && dy ? 1.5f : 1.0f);
    }

    /// Highest and lowest of coarse squares of 8 x 8 cells: the relief around a cell at little cost.
    void measure_relief() {
        squares_ = (n_ + 7) / 8;
        const auto count = static_cast<size_t>(squares_) * static_cast<size_t>(squares_);
        high_.assign(count, -1e30f);
        low_.assign(count, 1e30f);
        wet_share_.assign(count, 0.0f);
        steep_.assign(count, 0.0f);
        for (int y = 0; y < n_; ++y)
            for (int x = 0; x < n_; ++x) {
                const auto q = static_cast<size_t>(y / 8 * squares_ + x / 8);
                high_[q] = std::max(high_[q], surface_m_[at(x, y)]);
                low_[q] = std::min(low_[q], surface_m_[at(x, y)]);
                wet_share_[q] += wet_[at(x, y)] ? 1.0f / 64.0f : 0.0f;
                steep_[q] = std::max(steep_[q], slope(x, y));
            }
    }
    [[nodiscard]] float slope(int x, int y) const {
        const auto two = static_cast<float>(2.0 * cell_m_);
        return std::hypot((surface_m_[at(x + 1, y)] - surface_m_[at(x - 1, y)]) / two,
                          (surface_m_[at(x, y + 1)] - surface_m_[at(x, y - 1)]) / two);
    }
    template <class F> void for_squares_around(int x, int y, int reach, F&& f) const {
        for (int b = std::max(0, y / 8 - reach); b <= std::min(squares_ - 1, y / 8 + reach); ++b)
            for (int a = std::max(0, x / 8 - reach); a <= std::min(squares_ - 1, x / 8 + reach); ++a)
                f(static_cast<size_t>(b * squares_ + a));
    }

    /// How likely a good standpoint is; 0: none.
    [[nodiscard]] float promise(ViewKind kind, int x, int y) const {
        const size_t i = at(x, y);
        if (wet_[i]) return 0.0f;
        const float to_water = water_cells_[i];
        float wall = 0.0f, wet = 0.0f, steep = 0.0f; // within about 2.5 km, 0.8 km, 0.5 km
        for_squares_around(x, y, 10, [&](size_t q) { wall = std::max(wall, high_[q] - surface_m_[i]); });
        for_squares_around(x, y, 3, [&](size_t q) { wet += wet_share_[q]; });
        for_squares_around(x, y, 2, [&](size_t q) { steep = std::max(steep, steep_[q]); });
        const float here = slope(x, y);
        const float range = std::min(wall, 600.0f) / 600.0f;
        switch (kind) {
        case ViewKind::dunes: {
            if (to_water < 6.0f || sand_m_[i] < 0.5f) return 0.0f;
            float sum = 0.0f, squares = 0.0f, lower = 0.0f;
            for (int dy = -3; dy <= 3; ++dy)
                for (int dx = -3; dx <= 3; ++dx) {
                    const float s = surface_m_[at(x + dx, y + dy)];
                    const float cover = std::min(sand_m_[at(x + dx, y + dy)], 3.0f) / 3.0f;
                    sum += cover;
                    squares += std::abs(s - surface_m_[i]);
                    lower += s < surface_m_[i] ? 1.0f : 0.0f;
                }
            // Sand all around, uneven, and seen from its higher parts.
            return sum / 49.0f * (0.3f + std::min(squares / 49.0f, 12.0f) / 12.0f) * (0.4f + lower / 49.0f) *
                   (0.8f + 0.4f * range);
        }
        case ViewKind::lake:
            if (to_water < 1.0f || to_water > 7.0f) return 0.0f;
            return std::min(wet, 16.0f) / 16.0f + 0.5f * range - 0.5f * std::min(here, 1.0f);
        case ViewKind::shore:
            if (to_water > 2.0f) return 0.0f;
            return std::min(wet, 16.0f) / 16.0f + 0.6f * range - 0.3f * std::min(here, 1.0f);
        case ViewKind::canyon:
            return steep < 0.35f ? 0.0f : std::min(steep, 2.0f) - 1.5f * here;
        case ViewKind::mountains:
            return wall < 120.0f ? 0.0f : std::min(wall, 1500.0f) / 1500.0f - std::min(here, 1.0f);
        case ViewKind::high:
        case ViewKind::count_:
            break;
        }
        // A lake below is worth more than the highest range: it is what a landscape is looked at from above for.
        const float water = to_water < 2.0f || to_water > 40.0f ? 0.0f : 1.0f + 0.5f * std::min(wet, 16.0f) / 16.0f;
        // Dunes before it lead the eye there.
        float dunes = 0.0f;
        for (int dy = -12; dy <= 12; dy += 3)
            for (int dx = -12; dx <= 12; dx += 3)
                dunes += sand_m_[at(x + dx, y + dy)] > 1.5f ? std::min(slope(x + dx, y + dy), 0.3f) : 0.0f;
        return 0.05f + water + range + 0.3f * std::min(steep, 1.0f) + std::min(dunes / 81.0f * 6.0f, 0.6f);
    }

    double cell_m_ = 32.0;
    int n_ = 0, squares_ = 0;
    int64_t x0_ = 0, y0_ = 0;
    std::vector<float> surface_m_, sand_m_, water_cells_;
    std::vector<uint8_t> wet_;
    std::vector<float> high_, low_, wet_share_, steep_; ///< of squares of 8 x 8 cells
};

/// Rings of standpoints around given places.
void add_sites(const CameraSearchOptions& options, ViewKind kind, std::vector<Standpoint>& points) {
    for (const auto& site : options.sites_m) {
        points.push_back({kind, site[0], site[1]});
        for (const double radius : {90.0, 260.0, 700.0})
            for (int i = 0; i < 8; ++i) {
                const double angle = (i + radius / 1000.0) * std::numbers::pi / 4.0;
                points.push_back({kind, site[0] + radius * std::cos(angle), site[1] + radius * std::sin(angle)});
            }
    }
}

/// To a dozen metres from the nearest water, if it is within 90 m: there the picture has wet sand and shallows in
/// front.
void walk_to_water(ViewTerrain& terrain, double& x_m, double& y_m) {
    constexpr double k_step_m = 3.0, k_from_water_m = 12.0;
    for (double d = k_step_m; d < 90.0; d += k_step_m)
        for (int i = 0; i < 24; ++i) {
            const double angle = i * std::numbers::pi / 12.0, c = std::cos(angle), s = std::sin(angle);
            if (terrain.at(1, x_m + d * c, y_m + d * s).material != ViewMaterial::water) continue;
            // Back from the water, as far as the ground there is dry.
            double to = d - k_step_m;
            while (to > d - k_from_water_m &&
                   terrain.at(1, x_m + (to - k_step_m) * c, y_m + (to - k_step_m) * s).material != ViewMaterial::water)
                to -= k_step_m;
            x_m += to * c;
            y_m += to * s;
            return;
        }
}

/// The eye above a standpoint; kinds that look down on things stand on the highest ground within some steps.
Vec3d eye_at(ViewTerrain& terrain, const Standpoint& point) {
    double x = point.x_m, y = point.y_m;
    const double cell = terrain.cell_m(1);
    if (point.kind == ViewKind::dunes || point.kind == ViewKind::canyon) {
        double highest = -1e30;
        for (int j = -8; j <= 8; ++j)
            for (int i = -8; i <= 8; ++i) {
                const double h = static_cast<double>(
                    terrain.at(1, point.x_m + 3.0 * i * cell, point.y_m + 3.0 * j * cell).surface_m);
                if (h > highest) {
                    highest = h;
                    x = point.x_m + 3.0 * i * cell;
                    y = point.y_m + 3.0 * j * cell;
                }
            }
    }
    if (point.kind == ViewKind::shore) walk_to_water(terrain, x, y);
    double ground = -1e30;
    for (int j = -2; j <= 2; ++j)
        for (int i = -2; i <= 2; ++i)
            ground = std::max(ground, static_cast<double>(terrain.at(1, x + i * cell, y + j * cell).surface_m));
    return {x, y, ground + eye_height_m(point.kind)};
}

/// Shade decides late, it takes rays: views that lie in it fall back, and the sun may change sides.
void judge_shade(ViewTerrain& terrain, const CameraSearchOptions& options, FoundView& view) {
    const Panorama panorama = cast_panorama(terrain, view.pose.eye_m);
    std::array<double, 2> suns{view.sun_azimuth_deg, wrap_degrees(2.0 * view.pose.yaw_deg - view.sun_azimuth_deg)};
    if (options.sun_azimuth_deg) suns[1] = suns[0];
    FoundView best = view;
    best.score = -1.0;
    for (const double sun : suns) {
        FoundView v = view;
        v.sun_azimuth_deg = sun;
        v.measures = measure_view(panorama, v.pose, sun, options.sun_elevation_deg);
        v.measures.sunlit = sunlit_share(terrain, panorama, v.pose, sun, options.sun_elevation_deg);
        const double in_light = std::clamp((v.measures.sunlit - 0.15) / 0.50, 0.0, 1.0);
        v.score = score_view(v.kind, v.measures) * (0.25 + 0.75 * in_light);
        if (v.score > best.score) best = v;
    }
    view = best;
}

Status check_options(const CameraSearchOptions& o) {
    const auto usage = [](const std::string& what) { return Error{ErrorKind::usage, "camera search: " + what}; };
    if (!(o.radius_m >= 200.0 && o.radius_m <= 50000.0))
        return usage(fmt::format("radius {} m; 200 to 50000", o.radius_m));
    if (o.standpoints < 0 || o.standpoints > 1000)
        return usage(fmt::format("{} standpoints; 0 to 1000", o.standpoints));
    if (o.per_kind < 1 || o.per_kind > 100) return usage(fmt::format("{} views of a kind; 1 to 100", o.per_kind));
    if (!(o.vertical_fov_deg >= 20.0 && o.vertical_fov_deg <= 70.0))
        return usage(fmt::format("field of view {} deg; 20 to 70", o.vertical_fov_deg));
    if (!(o.sun_elevation_deg > 0.0 && o.sun_elevation_deg <= 90.0))
        return usage(fmt::format("sun {} deg high; above 0, to 90", o.sun_elevation_deg));
    if (!(std::abs(o.centre_m[0]) < 1e13 && std::abs(o.centre_m[1]) < 1e13)) return usage("centre out of range");
    return {};
}

} // namespace

Result<std::vector<FoundView>> find_views(const SurfaceSource& source, const CameraSearchOptions& options) {
    SAHEL_TRY(check_options(options));
    std::vector<ViewKind> kinds = options.kinds;
    if (kinds.empty())
        for (int k = 0; k < static_cast<int>(ViewKind::count_); ++k) kinds.push_back(static_cast<ViewKind>(k));
    SAHEL_ASSIGN(const Survey survey, Survey::make(source, options));
    std::vector<Standpoint> points;
    for (const ViewKind kind : kinds) {
        const auto proposed = survey.propose(kind, options.standpoints);
        points.insert(points.end(), proposed.begin(), proposed.end());
        add_sites(options, kind, points);
    }

    // Each standpoint is looked at by itself: the order and the threads do not matter.
    std::vector<FoundView> seen(points.size());
    tbb::enumerable_thread_specific<ViewTerrain> terrains([&] { return ViewTerrain(source, uint64_t{64} << 20); });
    for_each_index("camera/look around", static_cast<int64_t>(points.size()), [&](int64_t index) {
        const auto i = static_cast<size_t>(index);
        ViewTerrain& terrain = terrains.local();
        const Vec3d eye = eye_at(terrain, points[i]);
        // Water is no place to stand.
        if (terrain.at(1, eye[0], eye[1]).material == ViewMaterial::water && points[i].kind != ViewKind::high) return;
        seen[i] = best_heading(points[i].kind, cast_panorama(terrain, eye), eye, options);
    });

    std::vector<FoundView> found;
    for (const ViewKind kind : kinds) {
        std::vector<FoundView> ranked;
        for (size_t i = 0; i < points.size(); ++i)
            if (points[i].kind == kind && seen[i].score >= options.least_score) ranked.push_back(seen[i]);
        const auto better = [](const FoundView& a, const FoundView& b) { return a.score > b.score; };
        std::stable_sort(ranked.begin(), ranked.end(), better);
        const auto judged = std::min(ranked.size(), static_cast<size_t>(4 * options.per_kind + 6));
        for_each_index("camera/shade", static_cast<int64_t>(judged),
                       [&](int64_t i) { judge_shade(terrains.local(), options, ranked[static_cast<size_t>(i)]); });
        ranked.resize(judged);
        std::stable_sort(ranked.begin(), ranked.end(), better);
        int taken = 0;
        for (const FoundView& view : ranked) {
            if (taken == options.per_kind || view.score < options.least_score) break;
            const bool crowded = std::any_of(found.begin(), found.end(), [&](const FoundView& f) {
                return f.kind == kind && std::hypot(f.pose.eye_m[0] - view.pose.eye_m[0],
                                                    f.pose.eye_m[1] - view.pose.eye_m[1]) < options.spacing_m;
            });
            if (crowded) continue;
            found.push_back(view);
            ++taken;
        }
    }
    return found;
}

} // namespace sahel
