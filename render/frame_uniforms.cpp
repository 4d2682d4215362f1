#include "render/frame_uniforms.h"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sahel {

namespace {

constexpr float k_near_m = 0.1f;
/// Halton (2, 3): where the samples of a pixel lie.
constexpr std::array<std::array<float, 2>, 8> k_halton = {{{0.5f, 0.333f},
                                                           {0.25f, 0.667f},
                                                           {0.75f, 0.111f},
                                                           {0.125f, 0.444f},
                                                           {0.625f, 0.778f},
                                                           {0.375f, 0.222f},
                                                           {0.875f, 0.556f},
                                                           {0.0625f, 0.889f}}};

double fraction(double v) {
    return v - std::floor(v);
}

/// Where the eye is in a noise texture turned by (c, s) and scaled.
glm::vec2 noise_phase(double x, double y, double m00, double m01, double m10, double m11, double scale) {
    // GLSL mat2(a, b, c, d) * v = (a x + c y, b x + d y)
    return {static_cast<float>(fraction((m00 * x + m10 * y) * scale)),
            static_cast<float>(fraction((m01 * x + m11 * y) * scale))};
}

/// Where the eye is in the ripples along (dx, dy): turns of each wavelength.
glm::vec2 ripple_phase(double x, double y, double dx, double dy) {
    const double u = x * dx + y * dy;
    return {static_cast<float>(fraction(u / 0.34)), static_cast<float>(fraction(u / 2.3))};
}

} // namespace

FrameUniforms frame_uniforms(const RendererDesc& desc, const Atmosphere& atmosphere, const SkyTable& table,
                             const FrameDesc& frame, int sample) {
    const ViewState& v = frame.view;
    FrameUniforms u{};
    const auto axis = [](const std::array<double, 3>& a) { // world (x, y south, z up) to shader (x, y up, z south)
        return glm::vec3(static_cast<float>(a[0]), static_cast<float>(a[2]), static_cast<float>(a[1]));
    };
    const float f = 1.0f / std::tan(0.5f * static_cast<float>(v.vertical_fov_rad));
    const float aspect = static_cast<float>(desc.width) / static_cast<float>(desc.height);
    glm::mat4 projection(0.0f); // reversed and infinite: depth = near / distance along the axis
    projection[0][0] = f / aspect;
    projection[1][1] = f;
    projection[2][3] = -1.0f;
    projection[3][2] = k_near_m;
    const auto& jitter = k_halton[static_cast<size_t>(sample) % k_halton.size()];
    projection[2][0] = (jitter[0] - 0.5f) * 2.0f / static_cast<float>(desc.width);
    projection[2][1] = (jitter[1] - 0.5f) * 2.0f / static_cast<float>(desc.height);
    const glm::mat4 look = glm::lookAt(glm::vec3(0.0f), axis(v.forward), axis(v.up));
    u.view_projection = projection * look;
    u.inverse_view_projection = glm::inverse(u.view_projection);

    const double x = v.eye_m[0], y = v.eye_m[1], cell = desc.cell_m;
    u.eye = {static_cast<float>(x - std::floor(x / cell) * cell), static_cast<float>(v.eye_m[2]),
             static_cast<float>(y - std::floor(y / cell) * cell), static_cast<float>(frame.time_s)};
    u.lod = {static_cast<float>(v.eye_m[2] - v.ground_m), desc.lod_factor, static_cast<float>(cell),
             static_cast<float>(sample)};
    const SunDirection s = sun_direction(atmosphere);
    u.sun = {std::cos(s.azimuth_rad) * std::cos(s.elevation_rad), std::sin(s.elevation_rad),
             std::sin(s.azimuth_rad) * std::cos(s.elevation_rad), 0.0f};
    const auto rgb = [](const Rgb& c) { return glm::vec4(c[0], c[1], c[2], 0.0f); };
    u.sun_light = rgb(table.sun);
    u.light_up = rgb(table.up);
    u.light_side = rgb(table.side);
    u.light_ground = rgb(table.ground);
    u.haze = {atmosphere.haze_per_m, atmosphere.haze_height_m, 1.0f, u.eye.y - frame.haze_base_m};
    u.screen = {table.exposure_key * atmosphere.exposure, static_cast<float>(desc.width),
                static_cast<float>(desc.height),
                2.0f * std::tan(0.5f * static_cast<float>(v.vertical_fov_rad)) / static_cast<float>(desc.height)};
    const float wind = frame.look.wind_azimuth_deg * 0.017453293f;
    const double wx = std::cos(wind), wy = std::sin(wind);
    const glm::vec2 along_wind = ripple_phase(x, y, wx, wy);
    u.wind = {static_cast<float>(wx), static_cast<float>(wy), std::min(atmosphere.wind_m_per_s / 10.0f, 1.0f),
              along_wind.x};
    u.look = {frame.look.sand_hue, atmosphere.cloud_cover, atmosphere.silt, frame.look.strata};
    u.rock = {frame.look.grey_rock_from_m, frame.look.grey_rock_to_m, frame.look.snow_from_m, along_wind.y};
    const glm::vec2 n1 = noise_phase(x, y, 1, 0, 0, 1, 0.43), n2 = noise_phase(x, y, 0.96, 0.28, -0.28, 0.96, 0.047);
    const glm::vec2 n3 = noise_phase(x, y, 0.6, 0.8, -0.8, 0.6, 0.0061),
                    n4 = noise_phase(x, y, 0.8, 0.6, -0.6, 0.8, 0.00071);
    const glm::vec2 nb = noise_phase(x, y, 0.96, 0.28, -0.28, 0.96, 0.021),
                    c1 = noise_phase(x, y, 1, 0, 0, 1, 0.000031);
    const glm::vec2 c2 = noise_phase(x, y, 0.8, 0.6, -0.6, 0.8, 0.000093), c3 = noise_phase(y, x, 1, 0, 0, 1, 0.00037);
    u.noise_phase = {glm::vec4(n1, n2), glm::vec4(n3, n4), glm::vec4(nb, c1), glm::vec4(c2, c3)};
    u.wall_phase = {noise_phase(x, y, 1, 0, 0, 1, 0.047), noise_phase(x, y, 1, 0, 0, 1, 0.3)};
    u.grain_phase = {noise_phase(x, y, 1, 0, 0, 1, 1.0 / 8192.0), 0.0f, 0.0f};
    for (int i = 0; i < k_contour_directions; ++i) {
        const double turn = std::numbers::pi * i / k_contour_directions;
        u.contour_phase[static_cast<size_t>(i / 4)][i % 4] =
            static_cast<float>(fraction((x * std::cos(turn) + y * std::sin(turn)) * 0.047));
    }
    for (int i = 0; i < k_ripple_directions; ++i) {
        const double turn = 2.0 * std::numbers::pi * i / k_ripple_directions;
        const glm::vec2 phase = ripple_phase(x, y, std::cos(turn), std::sin(turn));
        glm::vec4& pair = u.ripple_phase[static_cast<size_t>(i / 2)];
        pair[2 * (i % 2)] = phase.x;
        pair[2 * (i % 2) + 1] = phase.y;
    }
    u.mode = {static_cast<int>(frame.debug), 0, frame.samples, 0};
    return u;
}

} // namespace sahel
