#include "render/camera_flights.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sahel {

namespace {

Vec3d minus(const Vec3d& a, const Vec3d& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
double length(const Vec3d& a) {
    return std::hypot(a[0], a[1], a[2]);
}

constexpr double k_key_interval_s = 0.25;
// The limits hold between the key frames too, where the spline differs a little from the plan.
constexpr double k_speed_margin = 0.93;
constexpr double k_turn_margin = 0.85;

double angle_rad(const Vec3d& a, const Vec3d& b) {
    return 2.0 * std::asin(std::min(1.0, 0.5 * length(minus(a, b))));
}

/// A flight planned along its way: poses a step apart, then speeds, then times.
struct Plan {
    std::vector<CameraPose> poses;
    std::vector<double> top_speed; ///< at each pose, m/s
    std::vector<double> way_m;     ///< from the start
};

/// Lifts the poses to `height_m` over the highest ground within a window, smoothed within that window.
void set_heights(std::vector<CameraPose>& poses, double height_m, double step_m, const GroundFunction& ground) {
    const auto n = static_cast<int64_t>(poses.size());
    const int64_t half = std::max<int64_t>(2, std::llround(std::clamp(2.0 * height_m, 20.0, 400.0) / step_m));
    // The plan goes on straight beyond its ends, so that the window is full there.
    std::vector<double> top(static_cast<size_t>(n));
    for (size_t i = 0; i < top.size(); ++i) top[i] = ground(poses[i].eye_m[0], poses[i].eye_m[1]);
    const auto clamped = [n](int64_t i) { return static_cast<size_t>(std::clamp<int64_t>(i, 0, n - 1)); };
    std::vector<double> highest(top.size());
    for (int64_t i = 0; i < n; ++i) {
        double m = top[clamped(i)];
        for (int64_t k = -half; k <= half; ++k) m = std::max(m, top[clamped(i + k)]);
        highest[clamped(i)] = m;
    }
    // Two boxes of half the window each: together they reach no further than the window.
    for (int pass = 0; pass < 2; ++pass) {
        const int64_t reach = half / 2;
        std::vector<double> smooth(highest.size());
        for (int64_t i = 0; i < n; ++i) {
            double sum = 0.0;
            for (int64_t k = -reach; k <= reach; ++k) sum += highest[clamped(i + k)];
            smooth[clamped(i)] = sum / static_cast<double>(2 * reach + 1);
        }
        highest = std::move(smooth);
    }
    for (size_t i = 0; i < poses.size(); ++i) poses[i].eye_m[2] = highest[i] + height_m;
}

/// The way, and the speed that the limits allow at each pose, without jolts.
Plan make_plan(std::vector<CameraPose> poses, double height_m, double wished_m_per_s, const FlightLimits& limits) {
    Plan plan;
    plan.poses = std::move(poses);
    const size_t n = plan.poses.size();
    double most = limits.speed_per_height_per_s * height_m * k_speed_margin;
    if (wished_m_per_s > 0.0) most = std::min(most, wished_m_per_s);
    plan.way_m.assign(n, 0.0);
    plan.top_speed.assign(n, most);
    const double turn_rad_per_s = limits.turn_deg_per_s * k_turn_margin * std::numbers::pi / 180.0;
    for (size_t i = 1; i < n; ++i) {
        const double step = length(minus(plan.poses[i].eye_m, plan.poses[i - 1].eye_m));
        plan.way_m[i] = plan.way_m[i - 1] + step;
        const double turn = angle_rad(view_direction(plan.poses[i]), view_direction(plan.poses[i - 1]));
        const double limit = turn > 1e-9 ? std::min(most, turn_rad_per_s * step / turn) : most;
        plan.top_speed[i - 1] = std::min(plan.top_speed[i - 1], limit);
        plan.top_speed[i] = std::min(plan.top_speed[i], limit);
    }
    // Braking and gathering speed by at most a third of the top speed in a second: v^2 changes by 2 a s.
    const double a = most / 3.0;
    for (size_t i = 1; i < n; ++i)
        plan.top_speed[i] = std::min(plan.top_speed[i], std::sqrt(plan.top_speed[i - 1] * plan.top_speed[i - 1] +
                                                                  2 * a * (plan.way_m[i] - plan.way_m[i - 1])));
    for (size_t i = n - 1; i-- > 0;)
        plan.top_speed[i] = std::min(plan.top_speed[i], std::sqrt(plan.top_speed[i + 1] * plan.top_speed[i + 1] +
                                                                  2 * a * (plan.way_m[i + 1] - plan.way_m[i])));
    return plan;
}

/// Times at the poses of a plan flown to `end_m`, from rest to rest.
std::vector<double> plan_times(const Plan& plan, double end_m, double ease_s) {
    double most = 0.0;
    for (const double v : plan.top_speed) most = std::max(most, v);
    const auto speed = [&](size_t i) {
        double v = plan.top_speed[i];
        if (ease_s > 0.0) {
            const double a2 = 2.0 * most / ease_s;
            const double left = std::max(0.0, std::min(plan.way_m[i], end_m - plan.way_m[i]));
            v = std::min(v, std::sqrt(a2 * left));
        }
        return v;
    };
    std::vector<double> times{0.0};
    for (size_t i = 1; i < plan.way_m.size() && plan.way_m[i - 1] < end_m; ++i) {
        const double step = std::min(plan.way_m[i], end_m) - plan.way_m[i - 1];
        // The time of a constant acceleration between the two speeds.
        times.push_back(times.back() + 2.0 * step / std::max(speed(i - 1) + speed(i), 1e-6 * most));
    }
    return times;
}

CameraPath path_of_plan(const Plan& plan, double duration_s, double ease_s, CameraPath::Description description) {
    double end_m = plan.way_m.back();
    std::vector<double> times = plan_times(plan, end_m, ease_s);
    if (duration_s > 0.0 && times.back() > duration_s) {
        double low = 0.0;
        double high = end_m;
        for (int i = 0; i < 60; ++i) {
            const double middle = 0.5 * (low + high);
            (plan_times(plan, middle, ease_s).back() > duration_s ? high : low) = middle;
        }
        end_m = low;
        times = plan_times(plan, end_m, ease_s);
    }
    const double stretch = duration_s > 0.0 ? duration_s / times.back() : 1.0;
    const double total_s = times.back() * stretch;
    const auto keys = std::max<int64_t>(2, std::llround(total_s / k_key_interval_s) + 1);
    size_t i = 1;
    for (int64_t k = 0; k < keys; ++k) {
        const double t = static_cast<double>(k) / static_cast<double>(keys - 1) * times.back();
        while (i + 1 < times.size() && times[i] < t) ++i;
        const double last_m = std::min(plan.way_m[i], end_m);
        const double share = std::clamp((t - times[i - 1]) / (times[i] - times[i - 1]), 0.0, 1.0) *
                             (last_m - plan.way_m[i - 1]) / (plan.way_m[i] - plan.way_m[i - 1]);
        const CameraPose& a = plan.poses[i - 1];
        const CameraPose& b = plan.poses[i];
        CameraKey key;
        key.time_s = t * stretch;
        for (size_t c = 0; c < 3; ++c) key.position_m[c] = a.eye_m[c] + (b.eye_m[c] - a.eye_m[c]) * share;
        key.yaw_deg = wrap_degrees(a.yaw_deg + wrap_degrees(b.yaw_deg - a.yaw_deg) * share);
        key.pitch_deg = a.pitch_deg + (b.pitch_deg - a.pitch_deg) * share;
        description.keys.push_back(key);
    }
    description.ease = false; // the times have it already
    description.aims_at_targets = false;
    auto path = CameraPath::create(std::move(description), "planned flight");
    return std::move(path).value();
}

Status check_flight(const char* what, double height_m, double duration_s, double ease_s, double fov_deg,
                    const FlightLimits& limits) {
    const auto usage = [&](const std::string& text) {
        return Error{ErrorKind::usage, fmt::format("{}: {}", what, text)};
    };
    if (!(height_m >= std::max(limits.clearance_m, 0.5)) || !(height_m <= 1e5))
        return usage(
            fmt::format("height {} m over the ground; {} to 100000", height_m, std::max(limits.clearance_m, 0.5)));
    if (!(duration_s >= 0.0 && duration_s <= 86400.0))
        return usage(fmt::format("duration {} s; 0 to 86400", duration_s));
    if (!(ease_s >= 0.0 && ease_s <= 60.0)) return usage(fmt::format("ease {} s; 0 to 60", ease_s));
    if (!(fov_deg >= 5.0 && fov_deg <= 120.0)) return usage(fmt::format("field of view {} deg; 5 to 120", fov_deg));
    if (!(limits.speed_per_height_per_s > 0.0) || !(limits.turn_deg_per_s > 0.0))
        return usage("limits of speed and turn must be above 0");
    return {};
}

/// Pose spacing for a way of some length: fine enough for the ground, few enough to plan quickly.
double plan_step_m(double way_m, double height_m) {
    return std::max(std::clamp(height_m / 16.0, 0.5, 8.0), way_m / 100000.0);
}

} // namespace

Result<CameraPath> orbit_path(const OrbitOptions& o, const GroundFunction& ground) {
    SAHEL_TRY(check_flight("orbit", o.height_m, o.duration_s, o.ease_s, o.vertical_fov_deg, o.limits));
    if (!(o.radius_m >= 1.0 && o.radius_m <= 1e6))
        return Error{ErrorKind::usage, fmt::format("orbit: radius {} m; 1 to 1000000", o.radius_m)};
    if (!(std::abs(o.arc_deg) >= 1.0 && std::abs(o.arc_deg) <= 3600.0))
        return Error{ErrorKind::usage, fmt::format("orbit: arc {} deg; 1 to 3600, either sign", o.arc_deg)};

    const double arc = o.arc_deg * std::numbers::pi / 180.0;
    const double step = plan_step_m(std::abs(arc) * o.radius_m, o.height_m);
    const auto n = std::max<int64_t>(16, std::llround(std::abs(arc) * o.radius_m / step));
    std::vector<CameraPose> poses(static_cast<size_t>(n + 1));
    for (int64_t i = 0; i <= n; ++i) {
        const double at =
            o.start_deg * std::numbers::pi / 180.0 + arc * static_cast<double>(i) / static_cast<double>(n);
        poses[static_cast<size_t>(i)].eye_m = {o.centre_m[0] + o.radius_m * std::cos(at),
                                               o.centre_m[1] + o.radius_m * std::sin(at), 0.0};
    }
    set_heights(poses, o.height_m, std::abs(arc) * o.radius_m / static_cast<double>(n), ground);
    const Vec3d target{o.centre_m[0], o.centre_m[1], ground(o.centre_m[0], o.centre_m[1]) + 0.2 * o.height_m};
    for (CameraPose& pose : poses) look_at(pose, target);
    const Plan plan = make_plan(std::move(poses), o.height_m, 0.0, o.limits);
    return path_of_plan(plan, o.duration_s, o.ease_s,
                        {.name = "orbit", .vertical_fov_deg = o.vertical_fov_deg, .keys = {}});
}

Result<CameraPath> flyover_path(const FlyoverOptions& o, const GroundFunction& ground) {
    SAHEL_TRY(check_flight("flyover", o.height_m, o.duration_s, o.ease_s, o.vertical_fov_deg, o.limits));
    if (!(o.speed_m_per_s >= 0.0 && o.speed_m_per_s <= 1e5))
        return Error{ErrorKind::usage, fmt::format("flyover: speed {} m/s; 0 to 100000", o.speed_m_per_s)};
    if (!(o.look_down_deg >= -80.0 && o.look_down_deg <= 80.0))
        return Error{ErrorKind::usage, fmt::format("flyover: look down {} deg; -80 to 80", o.look_down_deg)};
    if (o.waypoints_m.size() < 2) return Error{ErrorKind::usage, "flyover: needs two way points or more"};
    // The way points at their distance along straight lines: a curve whose speed is about 1.
    std::vector<double> way{0.0};
    std::vector<Vec3d> points;
    for (size_t i = 0; i < o.waypoints_m.size(); ++i) {
        points.push_back({o.waypoints_m[i][0], o.waypoints_m[i][1], 0.0});
        if (i == 0) continue;
        const double leg = length(minus(points[i], points[i - 1]));
        if (!(leg >= 1.0 && leg <= 1e7))
            return Error{ErrorKind::usage,
                         fmt::format("flyover: way points {} and {} lie {} m apart; 1 to 10000000", i - 1, i, leg)};
        way.push_back(way.back() + leg);
    }
    const SplineCurve curve(way, points, false);
    const double step = plan_step_m(way.back(), o.height_m);
    const auto n = std::max<int64_t>(16, std::llround(way.back() / step));
    std::vector<CameraPose> poses(static_cast<size_t>(n + 1));
    const auto place = [&](int64_t i) { return way.back() * static_cast<double>(i) / static_cast<double>(n); };
    for (int64_t i = 0; i <= n; ++i) poses[static_cast<size_t>(i)].eye_m = curve.at(place(i));
    set_heights(poses, o.height_m, way.back() / static_cast<double>(n), ground);
    // The view follows the way a little ahead: it leads into a turn, as a pilot's does.
    const double ahead_m = std::clamp(2.0 * o.height_m, 20.0, 500.0);
    for (int64_t i = 0; i <= n; ++i) {
        Vec3d from = curve.at(place(i) - 0.25 * ahead_m);
        Vec3d to = curve.at(place(i) + ahead_m);
        // Near the last way point the heading is that of its approach.
        if (place(i) + ahead_m > way.back()) from = curve.at(way.back() - 1.25 * ahead_m);
        const Vec3d heading = minus(to, from);
        CameraPose& pose = poses[static_cast<size_t>(i)];
        if (length(heading) > 1e-9) pose.yaw_deg = std::atan2(heading[1], heading[0]) * 180.0 / std::numbers::pi;
        pose.pitch_deg = -o.look_down_deg;
        pose.vertical_fov_deg = o.vertical_fov_deg;
    }
    const Plan plan = make_plan(std::move(poses), o.height_m, o.speed_m_per_s, o.limits);
    return path_of_plan(plan, o.duration_s, o.ease_s,
                        {.name = "flyover", .vertical_fov_deg = o.vertical_fov_deg, .keys = {}});
}

FlightReport measure_flight(const CameraPath& path, const GroundFunction& ground, double samples_per_s) {
    FlightReport report;
    const auto samples = std::max<int64_t>(2, std::llround(path.duration_s() * samples_per_s) + 1);
    const double step_s = path.duration_s() / static_cast<double>(samples - 1);
    CameraPose before;
    for (int64_t i = 0; i < samples; ++i) {
        const double t = path.start_s() + static_cast<double>(i) * step_s;
        const CameraPose pose = path.pose_at(t);
        const double height = pose.eye_m[2] - ground(pose.eye_m[0], pose.eye_m[1]);
        const double speed = length(path.velocity_at(t));
        report.lowest_m = i == 0 ? height : std::min(report.lowest_m, height);
        report.top_speed_m_per_s = std::max(report.top_speed_m_per_s, speed);
        report.top_speed_per_height_per_s = std::max(report.top_speed_per_height_per_s, speed / std::max(height, 1e-9));
        if (i > 0) {
            report.length_m += length(minus(pose.eye_m, before.eye_m));
            const Vec3d a = view_direction(before), b = view_direction(pose);
            const double turn = 2.0 * std::asin(std::min(1.0, 0.5 * length(minus(a, b)))) * 180.0 / std::numbers::pi;
            report.top_turn_deg_per_s = std::max(report.top_turn_deg_per_s, turn / step_s);
        }
        before = pose;
    }
    return report;
}

} // namespace sahel
