#include "tests/render/gl_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

namespace sahel {

Status WithheldTerrain::read(LayerBlock& block) const {
    if (block.level() < least_level) return Error{ErrorKind::unsupported, "this level is withheld"};
    SAHEL_TRY(terrain_.read(block));
    const LayerSet shown{Layer::wind_x, Layer::wind_y, Layer::wind_shadow, Layer::airborne_sand};
    if (wind_deg < 0.0f || !block.layers().contains(shown)) return {};
    const float turn = wind_deg * 0.017453293f;
    const auto wx = block.reals(Layer::wind_x), wy = block.reals(Layer::wind_y),
               shelter = block.reals(Layer::wind_shadow);
    const auto air = block.ints(Layer::airborne_sand);
    for (int32_t y = wx.y0; y < wx.y1; ++y)
        for (int32_t x = wx.x0; x < wx.x1; ++x) {
            const bool stripe = ((block.owned().x0 + x) & 63) < 16;
            wx(x, y) = std::cos(turn) * (stripe ? 4.0f : 8.0f);
            wy(x, y) = std::sin(turn) * (stripe ? 4.0f : 8.0f);
            shelter(x, y) = stripe ? 0.75f : 0.0f;
            air(x, y) = stripe ? ticks_of_metres(0.1f) : 0;
        }
    return {};
}

Scene::Scene(const SceneOptions& o) : terrain(o.seed, o.preset), ground(terrain, 1) {
    tools::ViewSessionDesc desc;
    desc.width = o.width;
    desc.height = o.height;
    desc.workers = o.workers;
    desc.atmosphere = o.atmosphere;
    desc.stream.root_level = o.root_level;
    desc.stream.publishes_per_frame = 64;
    desc.stream.publish_ms_per_frame = 1000.0f;
    session = tools::ViewSession::create(terrain, desc).value();
}

CameraPose Scene::pose(double x_m, double y_m, double height_m, double yaw_deg) {
    return {.eye_m = {x_m, y_m, ground.surface_m(x_m, y_m) + height_m}, .yaw_deg = yaw_deg, .vertical_fov_deg = 50.0};
}

FrameDesc Scene::frame(const CameraPose& pose) const {
    FrameDesc frame;
    frame.view = make_view_state(pose, {}, session->renderer().width(), session->renderer().height(), 0.0);
    frame.time_s = 3.0;
    frame.haze_base_m = 300.0f;
    return frame;
}

Image Scene::read() const {
    const Renderer& r = session->renderer();
    Image image(r.width(), r.height(), 4);
    r.read_pixels(image.pixels);
    return image;
}

Image Scene::picture(const FrameDesc& frame) {
    const Status drawn = session->render_settled(frame);
    EXPECT_TRUE(drawn.ok()) << (drawn.ok() ? "" : drawn.error().message);
    return read();
}

Image Scene::picture_now(const FrameDesc& frame, double dt_s) {
    session->render_now(frame, dt_s);
    return read();
}

void GlTest::SetUp() {
    auto made = GlContext::headless();
    if (!made.ok()) GTEST_SKIP() << made.error().message;
    context = std::move(made).value();
}

void GlTest::TearDown() {
    if (!context) return; // skipped
    EXPECT_EQ(context->take_errors(), "");
}

Difference compare(const Image& a, const Image& b) {
    Difference d;
    EXPECT_EQ(a.width_px, b.width_px);
    EXPECT_EQ(a.height_px, b.height_px);
    if (a.width_px != b.width_px || a.height_px != b.height_px) return {1.0, 1.0, 1.0};
    constexpr int k_block = 16;
    double sum = 0.0, jumped = 0.0;
    for (int by = 0; by < a.height_px; by += k_block)
        for (int bx = 0; bx < a.width_px; bx += k_block) {
            std::array<double, 3> block{};
            const int y1 = std::min(by + k_block, a.height_px), x1 = std::min(bx + k_block, a.width_px);
            for (int y = by; y < y1; ++y)
                for (int x = bx; x < x1; ++x) {
                    const uint8_t *p = a.at(x, y), *q = b.at(x, y);
                    std::array<double, 3> delta{};
                    for (size_t c = 0; c < 3; ++c) {
                        delta[c] = (p[c] - q[c]) / 255.0;
                        block[c] += delta[c];
                        sum += std::fabs(delta[c]);
                    }
                    const double luminance = 0.2126 * delta[0] + 0.7152 * delta[1] + 0.0722 * delta[2];
                    jumped += std::fabs(luminance) > 0.1 ? 1.0 : 0.0;
                }
            for (const double c : block)
                d.worst_block = std::max(d.worst_block, std::fabs(c) / ((y1 - by) * (x1 - bx)));
        }
    const double pixels = double{1} * a.width_px * a.height_px;
    d.mean = sum / (3.0 * pixels);
    d.jumped = jumped / pixels;
    return d;
}

void save_for_eyes(const std::string& name, const Image& image) {
    if (const char* folder = std::getenv("SAHEL_TEST_PICTURES")) {
        EXPECT_TRUE(write_png(std::filesystem::path(folder) / name, image).ok());
    }
}

} // namespace sahel
