#include "render/field_picture.h"

#include "render/contact_sheet.h"
#include "world/check.h"
#include "world/executor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace sahel {

namespace {

constexpr float k_to_radians = std::numbers::pi_v<float> / 180.0f;
constexpr PixelColour k_paper{24, 24, 26, 255};
constexpr PixelColour k_ink{232, 228, 218, 255};

struct Rgb {
    float r = 0.0f, g = 0.0f, b = 0.0f;
};

float linear_of(float srgb) {
    return srgb <= 0.04045f ? srgb / 12.92f : std::pow((srgb + 0.055f) / 1.055f, 2.4f);
}
uint8_t srgb_of(float linear) {
    const float c = std::clamp(linear, 0.0f, 1.0f);
    const float s = c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1.0f / 2.4f) - 0.055f;
    return static_cast<uint8_t>(s * 255.0f + 0.5f);
}
Rgb linear_of(const FieldColour& c) {
    return {linear_of(c[0]), linear_of(c[1]), linear_of(c[2])};
}
Rgb mix(Rgb a, Rgb b, float t) {
    return {a.r + (b.r - a.r) * t, a.g + (b.g - a.g) * t, a.b + (b.b - a.b) * t};
}
float smooth(float t) {
    const float c = std::clamp(t, 0.0f, 1.0f);
    return c * c * (3.0f - 2.0f * c);
}

/// Pixels of a cell: the least whole factor that makes the longer side `least` pixels.
int enlargement(int width, int height, int least) {
    const int side = std::max(width, height);
    return side >= least ? 1 : (least + side - 1) / side;
}

struct Surface {
    const GroundFields* f;
    std::vector<float> z; ///< top, of water too

    [[nodiscard]] int wrap(int i, int n) const {
        if (!f->periodic) return std::clamp(i, 0, n - 1);
        const int m = i % n;
        return m < 0 ? m + n : m;
    }
    [[nodiscard]] float at(int x, int y) const {
        return z[static_cast<size_t>(wrap(y, f->height)) * static_cast<size_t>(f->width) +
                 static_cast<size_t>(wrap(x, f->width))];
    }
    [[nodiscard]] float bilinear(float x, float y) const {
        const float fx = std::floor(x);
        const float fy = std::floor(y);
        const int ix = static_cast<int>(fx);
        const int iy = static_cast<int>(fy);
        const float u = x - fx;
        const float v = y - fy;
        return (1 - v) * ((1 - u) * at(ix, iy) + u * at(ix + 1, iy)) +
               v * ((1 - u) * at(ix, iy + 1) + u * at(ix + 1, iy + 1));
    }
};

/// Means over squares of (2 radius + 1) cells, by running sums along both axes.
std::vector<float> box_mean(const Surface& s, int radius) {
    const int w = s.f->width;
    const int h = s.f->height;
    std::vector<float> rows(s.z.size());
    std::vector<float> out(s.z.size());
    const auto scale = static_cast<float>(1.0 / (2 * radius + 1));
    for (int y = 0; y < h; ++y) {
        double sum = 0.0;
        for (int x = -radius; x <= radius; ++x) sum += s.at(x, y);
        for (int x = 0; x < w; ++x) {
            rows[static_cast<size_t>(y * w + x)] = static_cast<float>(sum) * scale;
            sum += static_cast<double>(s.at(x + radius + 1, y)) - s.at(x - radius, y);
        }
    }
    for (int x = 0; x < w; ++x) {
        const auto at = [&](int y) { return rows[static_cast<size_t>(s.wrap(y, h) * w + x)]; };
        double sum = 0.0;
        for (int y = -radius; y <= radius; ++y) sum += at(y);
        for (int y = 0; y < h; ++y) {
            out[static_cast<size_t>(y * w + x)] = static_cast<float>(sum) * scale;
            sum += static_cast<double>(at(y + radius + 1)) - at(y - radius);
        }
    }
    return out;
}

float value_or(std::span<const float> field, size_t i, float otherwise) {
    return field.empty() ? otherwise : field[i];
}

/// Base colour of a cell in linear light, by the display rules.
struct BaseColours {
    Rgb sand, bedrock, soil, water, vegetation, object, shadow, erosion, sticky;
    bool show_shadow, show_erosion, show_sticky;

    explicit BaseColours(const GroundColours& c)
        : sand(linear_of(c.sand)), bedrock(linear_of(c.bedrock)), soil(linear_of(c.soil)), water(linear_of(c.water)),
          vegetation(linear_of(c.vegetation)), object(linear_of(c.object)), shadow(linear_of(c.shadow)),
          erosion(linear_of(c.erosion)), sticky(linear_of(c.sticky)), show_shadow(c.shadow[3] > 0.5f),
          show_erosion(c.erosion[3] > 0.5f), show_sticky(c.sticky[3] > 0.5f) {}

    [[nodiscard]] Rgb at(const GroundFields& f, size_t i) const {
        const float hard = 1.0f - 0.75f * std::clamp(value_or(f.resistance, i, 0.0f), 0.0f, 1.0f);
        Rgb c{bedrock.r * hard, bedrock.g * hard, bedrock.b * hard};
        c = mix(c, soil, std::clamp(value_or(f.soil_m, i, 0.0f), 0.0f, 1.0f));
        c = mix(c, sand, std::clamp(value_or(f.sand_m, i, 0.0f), 0.0f, 1.0f));
        c = mix(c, vegetation, std::clamp(value_or(f.vegetation, i, 0.0f), 0.0f, 1.0f));
        if (!f.object.empty() && f.object[i] != 0) c = object;
        const float echo = value_or(f.echo, i, 0.0f);
        if (show_erosion && echo < 0.0f) c = mix(c, erosion, 0.5f);
        if (show_sticky && echo > 0.0f) c = mix(c, sticky, 0.5f * std::min(echo, 1.0f));
        if (show_shadow) c = mix(c, shadow, 0.5f * std::clamp(value_or(f.wind_shadow, i, 0.0f), 0.0f, 1.0f));
        const float depth = value_or(f.water_m, i, 0.0f);
        if (depth > 0.0f) c = mix(c, water, 0.35f + 0.6f * (1.0f - std::exp(-0.25f * depth)));
        return c;
    }
};

/// Heights are exaggerated until the steeper cells (95 of 100 are less steep) stand at half the slope of repose.
float exaggeration_of(const Surface& s, float cell) {
    std::vector<float> slopes;
    const int step = std::max(1, std::max(s.f->width, s.f->height) / 256);
    for (int y = 0; y < s.f->height; y += step)
        for (int x = 0; x < s.f->width; x += step) {
            const float gx = (s.at(x + 1, y) - s.at(x - 1, y)) / (2 * cell);
            const float gy = (s.at(x, y + 1) - s.at(x, y - 1)) / (2 * cell);
            slopes.push_back(std::sqrt(gx * gx + gy * gy));
        }
    const auto k = static_cast<ptrdiff_t>(0.95 * static_cast<double>(slopes.size() - 1));
    std::nth_element(slopes.begin(), slopes.begin() + k, slopes.end());
    return std::clamp(0.35f / std::max(slopes[static_cast<size_t>(k)], 1.0e-6f), 1.0f, 5.0f);
}

struct Lighting {
    const Surface* surface;
    const std::vector<float>* near_mean;
    const std::vector<float>* far_mean;
    const BaseColours* colours;
    Image* image;
    float cell, exaggeration;
    float near_m, far_m; ///< radii of the means
    float sx, sy, sz;    ///< towards the sun
    float tan_sun;
    int shadow_steps;

    /// Share of the sun that is seen: a march towards it, with a penumbra that widens with the distance.
    [[nodiscard]] float sunlit(int x, int y, float z) const {
        const float flat = std::sqrt(sx * sx + sy * sy);
        const float ux = sx / flat;
        const float uy = sy / flat;
        float seen = 1.0f;
        float step = 1.0f;
        float d = 1.0f;
        for (int i = 0; i < shadow_steps && seen > 0.0f; ++i) {
            const float over = exaggeration * (surface->bilinear(static_cast<float>(x) + d * ux,
                                                                 static_cast<float>(y) + d * uy) -
                                               z) -
                               d * cell * tan_sun; // above the line to the sun's centre
            seen = std::min(seen, 0.75f - over / (0.12f * d * cell));
            if (i >= 32) step *= 1.05f; // far ground in longer steps
            d += step;
        }
        return smooth(seen);
    }

    void operator()(int32_t x, int32_t y) const {
        const GroundFields& f = *surface->f;
        const auto i = static_cast<size_t>(y) * static_cast<size_t>(f.width) + static_cast<size_t>(x);
        const float z = surface->z[i];
        const float gx = exaggeration * (surface->at(x + 1, y) - surface->at(x - 1, y)) / (2 * cell);
        const float gy = exaggeration * (surface->at(x, y + 1) - surface->at(x, y - 1)) / (2 * cell);
        const float nz = 1.0f / std::sqrt(gx * gx + gy * gy + 1.0f);
        const float towards = std::max(-gx * sx - gy * sy + sz, 0.0f) * nz;
        const float sun = towards > 0.0f ? towards * sunlit(x, y, z) : 0.0f;
        // The sky: less of it on steep ground and in hollows, at two scales.
        const float hollow = exaggeration * (((*near_mean)[i] - z) / near_m + 0.7f * ((*far_mean)[i] - z) / far_m);
        const float sky = (0.5f + 0.5f * nz) * std::clamp(1.0f - 1.6f * hollow, 0.45f, 1.35f);
        const Rgb base = colours->at(f, i);
        constexpr float k_sun[3] = {1.34f, 1.22f, 1.02f};
        constexpr float k_sky[3] = {0.27f, 0.31f, 0.39f};
        const float light[3] = {k_sun[0] * sun + k_sky[0] * sky, k_sun[1] * sun + k_sky[1] * sky,
                                k_sun[2] * sun + k_sky[2] * sky};
        // A shoulder, so that slopes that face the sun keep their colour.
        const auto shoulder = [](float c) { return c < 0.6f ? c : 0.6f + 0.4f * (1.0f - std::exp((0.6f - c) / 0.4f)); };
        const uint8_t rgb[3] = {srgb_of(shoulder(base.r * light[0])), srgb_of(shoulder(base.g * light[1])),
                                srgb_of(shoulder(base.b * light[2]))};
        uint8_t* p = image->at(x, y);
        std::copy_n(rgb, 3, p);
        p[3] = 255;
    }
};

/// Whole times as large, bilinear: cells must not show as squares.
Image enlarged(const Image& from, int factor) {
    Image to(from.width_px * factor, from.height_px * factor, 4);
    const auto place = [&](int pixel, int side, int& low, int& high) {
        const float p = (static_cast<float>(pixel) + 0.5f) / static_cast<float>(factor) - 0.5f;
        const int whole = static_cast<int>(std::floor(p));
        low = std::clamp(whole, 0, side - 1);
        high = std::clamp(whole + 1, 0, side - 1);
        return p - static_cast<float>(whole);
    };
    for (int y = 0; y < to.height_px; ++y) {
        int y0 = 0;
        int y1 = 0;
        const float v = place(y, from.height_px, y0, y1);
        for (int x = 0; x < to.width_px; ++x) {
            int x0 = 0;
            int x1 = 0;
            const float u = place(x, from.width_px, x0, x1);
            for (int c = 0; c < 4; ++c) {
                const float top =
                    static_cast<float>(from.at(x0, y0)[c]) * (1 - u) + static_cast<float>(from.at(x1, y0)[c]) * u;
                const float low =
                    static_cast<float>(from.at(x0, y1)[c]) * (1 - u) + static_cast<float>(from.at(x1, y1)[c]) * u;
                to.at(x, y)[c] = static_cast<uint8_t>(top * (1 - v) + low * v + 0.5f);
            }
        }
    }
    return to;
}

float quantile(std::vector<float>& values, double share) {
    const auto k = static_cast<ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + k, values.end());
    return values[static_cast<size_t>(k)];
}

/// First and last value of the colours.
std::pair<float, float> span_of(std::span<const float> values, const FieldPictureOptions& o) {
    std::vector<float> known;
    const size_t step = std::max<size_t>(1, values.size() >> 20);
    for (size_t i = 0; i < values.size(); i += step)
        if (std::isfinite(values[i])) known.push_back(values[i]);
    float low = 0.0f;
    float high = 1.0f;
    if (!known.empty()) {
        low = quantile(known, 0.005);
        high = quantile(known, 0.995);
        if (low == high) { // nearly constant: the few others count
            low = *std::min_element(known.begin(), known.end());
            high = *std::max_element(known.begin(), known.end());
        }
    }
    low = o.low.value_or(low);
    high = o.high.value_or(high);
    if (o.palette == FieldPalette::balance && !o.low && !o.high) {
        high = std::max(std::abs(low), std::abs(high));
        low = -high;
    }
    return {low, high};
}

std::string number_text(float v) {
    const float a = std::abs(v);
    if (a != 0.0f && (a < 0.001f || a >= 100000.0f)) return fmt::format("{:.1e}", v);
    return fmt::format("{:.{}f}", v, a >= 100.0f ? 0 : (a >= 10.0f ? 1 : 2));
}

/// The picture with a strip below it: title and the colours with their values.
Image with_bar(const Image& picture, const FieldPictureOptions& o, float low, float high) {
    if (!o.bar) return picture;
    const float size = std::clamp(static_cast<float>(picture.width_px) / 40.0f, 12.0f, 28.0f);
    const TextPainter text(size);
    const int line = text.line_px();
    const int gap = line / 2;
    const int strip = gap + line + gap / 2 + line / 2 + gap / 2 + line + gap;
    Image out(picture.width_px, picture.height_px + strip, 4);
    std::copy(picture.pixels.begin(), picture.pixels.end(), out.pixels.begin());
    for (int y = picture.height_px; y < out.height_px; ++y)
        for (int x = 0; x < out.width_px; ++x) std::copy_n(k_paper.data(), 4, out.at(x, y));
    int y = picture.height_px + gap;
    text.draw(out, gap, y, o.unit.empty() ? o.title : fmt::format("{}, {}", o.title, o.unit), k_ink);
    y += line + gap / 2;
    const int width = out.width_px - 2 * gap;
    for (int x = 0; x < width; ++x) {
        const auto c = palette_colour(o.palette, static_cast<float>(x) / static_cast<float>(std::max(width - 1, 1)));
        for (int k = 0; k < line / 2; ++k) {
            uint8_t* p = out.at(gap + x, y + k);
            for (size_t j = 0; j < 3; ++j) p[j] = c[j];
        }
    }
    y += line / 2 + gap / 2;
    const std::string left = number_text(low);
    const std::string middle = number_text(0.5f * (low + high));
    const std::string right = number_text(high);
    text.draw(out, gap, y, left, k_ink);
    text.draw(out, out.width_px / 2 - text.width_px(middle) / 2, y, middle, k_ink);
    text.draw(out, out.width_px - gap - text.width_px(right), y, right, k_ink);
    return out;
}

Image colour_field(std::span<const float> values, int width, int height, FieldPalette palette, float low, float high,
                   int enlarge) {
    Image image(width * enlarge, height * enlarge, 4);
    const float scale = high > low ? 1.0f / (high - low) : 0.0f;
    for (int y = 0; y < image.height_px; ++y)
        for (int x = 0; x < image.width_px; ++x) {
            const float v = values[static_cast<size_t>(y / enlarge) * static_cast<size_t>(width) +
                                   static_cast<size_t>(x / enlarge)];
            uint8_t* p = image.at(x, y);
            const auto c =
                std::isfinite(v) ? palette_colour(palette, (v - low) * scale) : std::array<uint8_t, 3>{128, 128, 128};
            std::copy(c.begin(), c.end(), p);
            p[3] = 255;
        }
    return image;
}

/// A dot blended over a pixel, `cover` from 0 to 1.
void blend(Image& image, int x, int y, float grey, float cover) {
    if (x < 0 || y < 0 || x >= image.width_px || y >= image.height_px) return;
    uint8_t* p = image.at(x, y);
    for (int c = 0; c < 3; ++c)
        p[c] = static_cast<uint8_t>(static_cast<float>(p[c]) * (1.0f - cover) + grey * 255.0f * cover);
}

/// A soft line of the given half width.
void draw_line(Image& image, float x0, float y0, float x1, float y1, float half, float grey) {
    const int left = static_cast<int>(std::floor(std::min(x0, x1) - half - 1));
    const int right = static_cast<int>(std::ceil(std::max(x0, x1) + half + 1));
    const int top = static_cast<int>(std::floor(std::min(y0, y1) - half - 1));
    const int bottom = static_cast<int>(std::ceil(std::max(y0, y1) + half + 1));
    const float dx = x1 - x0;
    const float dy = y1 - y0;
    const float length2 = std::max(dx * dx + dy * dy, 1.0e-6f);
    for (int y = top; y <= bottom; ++y)
        for (int x = left; x <= right; ++x) {
            const float px = static_cast<float>(x) - x0;
            const float py = static_cast<float>(y) - y0;
            const float t = std::clamp((px * dx + py * dy) / length2, 0.0f, 1.0f);
            const float distance = std::hypot(px - t * dx, py - t * dy);
            const float cover = std::clamp(half + 0.5f - distance, 0.0f, 1.0f);
            if (cover > 0.0f) blend(image, x, y, grey, cover);
        }
}

void draw_arrow(Image& image, float x, float y, float dx, float dy) {
    const float length = std::hypot(dx, dy);
    if (length < 2.0f) return;
    const float ux = dx / length;
    const float uy = dy / length;
    const float head = std::min(0.4f * length, 7.0f);
    const float tip_x = x + 0.5f * dx;
    const float tip_y = y + 0.5f * dy;
    for (const auto& [half, grey] : {std::pair{1.7f, 0.05f}, std::pair{0.6f, 1.0f}}) { // dark rim, light line
        draw_line(image, x - 0.5f * dx, y - 0.5f * dy, tip_x, tip_y, half, grey);
        draw_line(image, tip_x, tip_y, tip_x - head * (ux + 0.6f * uy), tip_y - head * (uy - 0.6f * ux), half, grey);
        draw_line(image, tip_x, tip_y, tip_x - head * (ux - 0.6f * uy), tip_y - head * (uy + 0.6f * ux), half, grey);
    }
}

} // namespace

std::array<uint8_t, 3> palette_colour(FieldPalette palette, float t) {
    // Viridis of matplotlib (CC0), every sixteenth of the way; the others are mixed between a few anchors.
    using Row = std::array<uint8_t, 3>;
    static constexpr std::array<Row, 17> k_viridis = {{{68, 1, 84},
                                                       {72, 24, 106},
                                                       {71, 45, 123},
                                                       {66, 64, 134},
                                                       {59, 82, 139},
                                                       {51, 99, 141},
                                                       {44, 114, 142},
                                                       {38, 130, 142},
                                                       {33, 145, 140},
                                                       {31, 160, 136},
                                                       {40, 174, 128},
                                                       {63, 188, 115},
                                                       {94, 201, 98},
                                                       {132, 212, 75},
                                                       {173, 220, 48},
                                                       {216, 226, 25},
                                                       {253, 231, 37}}};
    static constexpr std::array<Row, 5> k_sand = {
        {{38, 30, 30}, {98, 70, 54}, {160, 117, 74}, {214, 172, 110}, {252, 240, 200}}};
    static constexpr std::array<Row, 5> k_water = {
        {{240, 238, 226}, {170, 208, 214}, {98, 162, 196}, {42, 100, 160}, {14, 40, 96}}};
    static constexpr std::array<Row, 5> k_balance = {
        {{28, 66, 138}, {124, 168, 206}, {240, 240, 236}, {218, 138, 104}, {142, 30, 36}}};
    const auto mixed = [&](std::span<const Row> rows) {
        const float s = std::clamp(t, 0.0f, 1.0f) * static_cast<float>(rows.size() - 1);
        const auto i = std::min(static_cast<size_t>(s), rows.size() - 2);
        const float f = s - static_cast<float>(i);
        Row c{};
        for (size_t k = 0; k < 3; ++k)
            c[k] = static_cast<uint8_t>(static_cast<float>(rows[i][k]) * (1.0f - f) +
                                        static_cast<float>(rows[i + 1][k]) * f + 0.5f);
        return c;
    };
    switch (palette) {
    case FieldPalette::sand:
        return mixed(k_sand);
    case FieldPalette::water:
        return mixed(k_water);
    case FieldPalette::balance:
        return mixed(k_balance);
    case FieldPalette::viridis:
        break;
    }
    return mixed(k_viridis);
}

Image make_ground_picture(const GroundFields& f, const GroundColours& colours, const SunLight& sun, int least_side_px) {
    const auto cells = static_cast<size_t>(f.width) * static_cast<size_t>(f.height);
    SAHEL_CHECK(cells > 0 && f.bedrock_m.size() == cells);
    Surface surface{&f, std::vector<float>(cells)};
    for (size_t i = 0; i < cells; ++i)
        surface.z[i] =
            f.bedrock_m[i] + value_or(f.soil_m, i, 0.0f) + value_or(f.sand_m, i, 0.0f) + value_or(f.water_m, i, 0.0f);
    const auto cell = static_cast<float>(f.cell_m);
    const int side = std::max(f.width, f.height);
    const int near = std::clamp(side / 128, 2, 8);
    const int far = std::clamp(side / 24, 6, 48);
    const std::vector<float> near_mean = box_mean(surface, near);
    const std::vector<float> far_mean = box_mean(surface, far);
    const BaseColours base(colours);
    const int enlarge = enlargement(f.width, f.height, least_side_px);
    Image image(f.width, f.height, 4);
    Lighting light{};
    light.surface = &surface;
    light.near_mean = &near_mean;
    light.far_mean = &far_mean;
    light.colours = &base;
    light.image = &image;
    light.cell = cell;
    light.exaggeration = sun.exaggeration > 0.0f ? sun.exaggeration : exaggeration_of(surface, cell);
    light.near_m = static_cast<float>(near) * cell;
    light.far_m = static_cast<float>(far) * cell;
    const float elevation = std::clamp(sun.elevation_deg, 2.0f, 89.0f) * k_to_radians;
    light.sx = std::sin(sun.azimuth_deg * k_to_radians) * std::cos(elevation);
    light.sy = -std::cos(sun.azimuth_deg * k_to_radians) * std::cos(elevation); // rows run south
    light.sz = std::sin(elevation);
    light.tan_sun = std::tan(elevation);
    const auto [lowest, highest] = std::minmax_element(surface.z.begin(), surface.z.end());
    const float reach = light.exaggeration * (*highest - *lowest) / (light.tan_sun * cell);
    light.shadow_steps = std::clamp(static_cast<int>(reach) + 1, 1, 96);
    for_each_cell("picture/ground", {0, 0, f.width, f.height}, light);
    return enlarge > 1 ? enlarged(image, enlarge) : image;
}

Image make_field_picture(std::span<const float> values, int width, int height, const FieldPictureOptions& options) {
    SAHEL_CHECK(width > 0 && height > 0 && values.size() == static_cast<size_t>(width) * static_cast<size_t>(height));
    const auto [low, high] = span_of(values, options);
    const int enlarge = enlargement(width, height, options.least_side_px);
    return with_bar(colour_field(values, width, height, options.palette, low, high, enlarge), options, low, high);
}

Image make_wind_picture(std::span<const float> wind_x, std::span<const float> wind_y, int width, int height,
                        const FieldPictureOptions& options) {
    SAHEL_CHECK(wind_x.size() == wind_y.size());
    std::vector<float> speed(wind_x.size());
    for (size_t i = 0; i < speed.size(); ++i) speed[i] = std::hypot(wind_x[i], wind_y[i]);
    const auto [low, high] = span_of(speed, options);
    const int enlarge = enlargement(width, height, options.least_side_px);
    Image image = colour_field(speed, width, height, options.palette, low, high, enlarge);
    const float spacing = std::max(static_cast<float>(std::max(image.width_px, image.height_px)) / 24.0f, 24.0f);
    for (float y = spacing / 2; y < static_cast<float>(image.height_px); y += spacing)
        for (float x = spacing / 2; x < static_cast<float>(image.width_px); x += spacing) {
            const auto i = static_cast<size_t>(static_cast<int>(y) / enlarge) * static_cast<size_t>(width) +
                           static_cast<size_t>(static_cast<int>(x) / enlarge);
            if (high > 0.0f && std::isfinite(speed[i]))
                draw_arrow(image, x, y, 0.85f * spacing * wind_x[i] / std::max(high, speed[i]),
                           0.85f * spacing * wind_y[i] / std::max(high, speed[i]));
        }
    return with_bar(image, options, low, high);
}

} // namespace sahel
