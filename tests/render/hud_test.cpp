#include "render/hud.h"

#include "render/contact_sheet.h"
#include "render/gl_context.h"

#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

namespace sahel {
namespace {

TEST(HudLayout, PanelsStayInsideAndApart) {
    for (const auto& [w, h] :
         std::vector<std::pair<int, int>>{{1280, 720}, {1920, 1080}, {3840, 2160}, {1024, 600}, {800, 600}, {640, 360}})
        for (const bool map : {true, false}) {
            const float scale = Hud::scale_for(h);
            const HudLayout l = hud_layout(w, h, scale, map, true);
            std::vector<HudRect> rects{l.stats, l.bookmarks, l.controls, l.message};
            if (map) rects.push_back(l.map);
            for (size_t i = 0; i < rects.size(); ++i) {
                const HudRect& a = rects[i];
                EXPECT_GE(a.x, 0.0f);
                EXPECT_GE(a.y, 0.0f);
                EXPECT_LE(a.x + a.width, static_cast<float>(w)) << i;
                EXPECT_LE(a.y + a.height, static_cast<float>(h)) << i;
                EXPECT_GT(a.width, 40.0f) << w << " x " << h << " panel " << i;
                EXPECT_GT(a.height, 20.0f) << w << " x " << h << " panel " << i;
                for (size_t k = 0; k < i; ++k) {
                    const HudRect& b = rects[k];
                    EXPECT_TRUE(a.x + a.width <= b.x || b.x + b.width <= a.x || a.y + a.height <= b.y ||
                                b.y + b.height <= a.y)
                        << w << " x " << h << ": panels " << i << " and " << k << " overlap";
                }
            }
            EXPECT_GE(l.help.x, 0.0f);
            EXPECT_LE(l.help.y + l.help.height, static_cast<float>(h));
        }
}

/// A framebuffer with something like a landscape in it.
class Canvas {
  public:
    Canvas(int width, int height) : width_(width), height_(height) {
        glCreateRenderbuffers(1, &colour_);
        glNamedRenderbufferStorage(colour_, GL_RGBA8, width, height);
        glCreateFramebuffers(1, &framebuffer_);
        glNamedFramebufferRenderbuffer(framebuffer_, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colour_);
        glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
        glViewport(0, 0, width, height);
    }
    ~Canvas() {
        glDeleteFramebuffers(1, &framebuffer_);
        glDeleteRenderbuffers(1, &colour_);
    }
    void clear() const {
        glDisable(GL_SCISSOR_TEST);
        glClearColor(0.55f, 0.66f, 0.78f, 1.0f);
        glClear(GL_COLOR_BUFFER_BIT);
        glEnable(GL_SCISSOR_TEST);
        glScissor(0, 0, width_, height_ / 2);
        glClearColor(0.80f, 0.62f, 0.42f, 1.0f);
        glClear(GL_COLOR_BUFFER_BIT);
        glDisable(GL_SCISSOR_TEST);
    }
    [[nodiscard]] Image read() const {
        Image image(width_, height_, 4);
        glPixelStorei(GL_PACK_ALIGNMENT, 1);
        glReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, image.pixels.data());
        image.flip_rows();
        return image;
    }

  private:
    int width_, height_;
    GLuint colour_ = 0, framebuffer_ = 0;
};

HudModel busy_model(const std::vector<Bookmark>& bookmarks) {
    HudModel m;
    m.title = "oasis, seed 1";
    m.device = "llvmpipe (LLVM 15.0.6, 256 bits), OpenGL 4.5";
    m.pose = {.eye_m = {12345.0, -6789.0, 412.0}, .yaw_deg = 35.0, .pitch_deg = -4.0};
    m.speed_m_per_s = 30.0;
    m.ground_m = 350.0;
    m.render = {.tiles = 61,
                .nodes = 744,
                .triangles = 1523776,
                .terrain_ms = 74.1,
                .sky_ms = 9.0,
                .water_ms = 19.2,
                .post_ms = 11.3};
    m.stream.nodes_in_state = {20, 7, 4, 2, 61, 1, 1};
    m.stream.wanted = 73;
    m.stream.visible = 49;
    m.stream.fallbacks = 3;
    m.stream.published_total = 12045;
    m.stream.evicted_total = 11984;
    m.stream.oldest_request_frames = 12;
    m.stream.failed_total = 1;
    m.budgets = {{"Slots", 76, 96, false},
                 {"Video memory", 812ull << 20, 1024ull << 20, true},
                 {"In flight", 126ull << 20, 128ull << 20, true}};
    m.rows = {{"Sun, height", "12.0 deg"}};
    // Rings of finer tiles around the eye.
    int i = 0;
    for (int level = 5; level >= 0; --level) {
        const double side = std::ldexp(512.0, level);
        const auto cx = static_cast<int64_t>(std::floor(m.pose.eye_m[0] / side));
        const auto cy = static_cast<int64_t>(std::floor(m.pose.eye_m[1] / side));
        for (int64_t y = cy - 1; y <= cy + 1; ++y)
            for (int64_t x = cx - 1; x <= cx + 1; ++x) {
                const auto state = ++i % 11 == 0 ? NodeState::loading
                                   : i % 7 == 0  ? NodeState::queued
                                   : i % 23 == 0 ? NodeState::failed
                                                 : NodeState::resident;
                m.nodes.push_back(
                    {{level, x, y}, state, state == NodeState::resident && (level == 0 || x != cx || y != cy)});
            }
    }
    m.bookmarks = bookmarks;
    return m;
}

void save_for_eyes(const char* name, const Image& image) {
    if (const char* folder = std::getenv("SAHEL_TEST_PICTURES")) {
        EXPECT_TRUE(write_png(std::filesystem::path(folder) / name, image).ok());
    }
}

size_t different_pixels(const Image& a, const Image& b) {
    size_t n = 0;
    for (size_t i = 0; i < a.pixels.size(); i += 4) n += !std::equal(&a.pixels[i], &a.pixels[i] + 3, &b.pixels[i]);
    return n;
}

class HudTest : public ::testing::Test {
  protected:
    void SetUp() override {
        auto context = GlContext::headless();
        if (!context.ok()) GTEST_SKIP() << context.error().message;
        context_ = std::move(context).value();
        hud_ = Hud::create(nullptr);
    }
    void TearDown() override {
        hud_.reset();
        context_.reset();
    }
    /// The second of two pictures: panels have settled.
    Image picture(const HudModel& model, HudControls& controls, int width, int height) {
        const Canvas canvas(width, height);
        for (int i = 0; i < 2; ++i) {
            canvas.clear();
            hud_->draw(model, controls, width, height, 1.0 / 60);
        }
        return canvas.read();
    }
    std::unique_ptr<GlContext> context_;
    std::unique_ptr<Hud> hud_;
};

TEST_F(HudTest, DrawsAllPanelsWithoutGlErrors) {
    const std::vector<Bookmark> bookmarks{
        {"North shore", {}}, {"Great dune", {}}, {"A rather long name for a place on the mesa", {}}};
    HudModel model = busy_model(bookmarks);
    Image ground(64, 64, 4);
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) {
            uint8_t* p = ground.at(x, y);
            p[0] = static_cast<uint8_t>(120 + x);
            p[1] = static_cast<uint8_t>(90 + y);
            p[2] = 60;
            p[3] = 255;
        }
    model.map = {&ground, 1, 9000.0, -9800.0, 6400.0, "0 to 12 m"};
    HudControls controls;
    controls.map_layer = Layer::sand;
    for (int i = 0; i < 200; ++i) {
        model.frame_ms = 15.0 + 8.0 * std::sin(i * 0.2) + (i % 37 == 0 ? 40.0 : 0.0);
        const Canvas canvas(1280, 720);
        hud_->draw(model, controls, 1280, 720, 1.0 / 60);
        if (i > 0) break; // one picture with a short curve, then only the curve
    }
    for (const auto& [w, h] : std::vector<std::pair<int, int>>{{1280, 720}, {1920, 1080}, {800, 600}}) {
        for (int i = 0; i < 170; ++i) {
            model.frame_ms = 15.0 + 8.0 * std::sin(i * 0.2) + (i % 37 == 0 ? 40.0 : 0.0);
            hud_->draw(model, controls, 0, 0, 1.0 / 60); // no room: only the curve goes on
        }
        const Image image = picture(model, controls, w, h);
        save_for_eyes(("hud_" + std::to_string(w) + ".png").c_str(), image);
        EXPECT_EQ(hud_->panels().size(), 5u);
        for (const Hud::Panel& p : hud_->panels()) {
            EXPECT_GE(p.rect.x, 0.0f) << p.name;
            EXPECT_GE(p.rect.y, 0.0f) << p.name;
            EXPECT_LE(p.rect.x + p.rect.width, static_cast<float>(w)) << p.name;
            EXPECT_LE(p.rect.y + p.rect.height, static_cast<float>(h)) << p.name;
        }
        // The middle of the picture is left to the landscape.
        const uint8_t* middle = image.at(w / 2, h / 4);
        EXPECT_EQ(middle[0], 140);
        EXPECT_EQ(middle[2], 199);
    }
    EXPECT_EQ(context_->take_errors(), "");
    EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
}

TEST_F(HudTest, SwitchesHidePanels) {
    const HudModel model = busy_model({});
    HudControls controls;
    const Image all = picture(model, controls, 1280, 720);
    controls.show_map = false;
    const Image without_map = picture(model, controls, 1280, 720);
    EXPECT_GT(different_pixels(all, without_map), 20000u);
    controls.show_panels = false;
    const Image left_only = picture(model, controls, 1280, 720);
    save_for_eyes("hud_left.png", left_only);
    EXPECT_GT(different_pixels(without_map, left_only), 20000u);
    controls.show_hud = false;
    const Image none = picture(model, controls, 1280, 720);
    EXPECT_TRUE(hud_->panels().empty());
    const Canvas empty(1280, 720);
    empty.clear();
    EXPECT_EQ(different_pixels(none, empty.read()), 0u);
    controls.show_help = true;
    HudModel talking = model;
    talking.message = "Screenshot: shots/0001.png";
    const Image help = picture(talking, controls, 1280, 720);
    save_for_eyes("hud_help.png", help);
    EXPECT_EQ(hud_->panels().size(), 2u);
    EXPECT_EQ(context_->take_errors(), "");
}

TEST_F(HudTest, PicturesAreTheSameEachTime) {
    const HudModel model = busy_model({});
    HudControls controls;
    const Image first = picture(model, controls, 1280, 720);
    EXPECT_EQ(different_pixels(first, picture(model, controls, 1280, 720)), 0u);
}

TEST_F(HudTest, LeavesTheClipControlAlone) {
    glClipControl(GL_UPPER_LEFT, GL_ZERO_TO_ONE);
    HudControls controls;
    picture(busy_model({}), controls, 640, 360);
    GLint origin = 0, depth = 0;
    glGetIntegerv(GL_CLIP_ORIGIN, &origin);
    glGetIntegerv(GL_CLIP_DEPTH_MODE, &depth);
    EXPECT_EQ(origin, GL_UPPER_LEFT);
    EXPECT_EQ(depth, GL_ZERO_TO_ONE);
}

TEST_F(HudTest, NothingIsChangedWithoutAHand) {
    HudControls controls;
    controls.atmosphere.sun_elevation_deg = 33.0f;
    const HudControls before = controls;
    const Canvas canvas(1280, 720);
    const HudEvents events = hud_->draw(busy_model({}), controls, 1280, 720, 1.0 / 60);
    EXPECT_FALSE(events.atmosphere_changed || events.sun_settled || events.look_changed || events.add_bookmark);
    EXPECT_FALSE(events.go_to_bookmark || events.remove_bookmark || events.rename_bookmark);
    EXPECT_EQ(controls.atmosphere.sun_elevation_deg, before.atmosphere.sun_elevation_deg);
    EXPECT_EQ(controls.view, before.view);
}

} // namespace
} // namespace sahel
