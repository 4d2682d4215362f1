#include "fake_world.h"
#include "streaming/selection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

namespace sahel::test {
namespace {

StreamExternals small_externals() {
    StreamExternals e;
    e.max_payload_bytes = 6u << 20;
    e.max_context_bytes = 70000;
    return e;
}

TEST(Selection, OrderIsTotalAndParentsComeFirst) {
    StreamSettings settings;
    NodePool pool(64);
    const Selector selector(settings, 1.0);
    std::mt19937_64 dice(2);
    for (int i = 0; i < 60; ++i) {
        const auto coordinate = [&] { return static_cast<double>(static_cast<int64_t>(dice() % 20000001) - 10000000); };
        std::vector<Want> wants;
        selector.collect(view_at(coordinate(), coordinate(), 2.0 + static_cast<double>(dice() % 9000), 0.1 * i), pool,
                         i % 2 == 1, wants);
        std::sort(wants.begin(), wants.end(), goes_before);
        std::set<TileKey> seen;
        for (size_t k = 0; k < wants.size(); ++k) {
            ASSERT_TRUE(std::isfinite(wants[k].cost));
            ASSERT_TRUE(seen.insert(wants[k].key).second) << "twice";
            if (wants[k].key.level < settings.root_level) {
                ASSERT_TRUE(seen.contains(wants[k].key.parent()));
            }
            if (k == 0) continue;
            ASSERT_TRUE(goes_before(wants[k - 1], wants[k]));
            ASSERT_FALSE(goes_before(wants[k], wants[k - 1]));
        }
    }
}

TEST(Selection, WhatIsSeenGoesBeforeWhatIsBehind) {
    StreamSettings settings;
    NodePool pool(64);
    const Selector selector(settings, 1.0);
    const ViewState view = view_at(1000.0, 1000.0, 20.0, 0.0, 0.0); // to the east
    std::vector<Want> wants;
    selector.collect(view, pool, false, wants);
    int visible = 0, around = 0;
    for (const Want& w : wants) {
        const double side = selector.side_m(w.key.level);
        const bool behind = (static_cast<double>(w.key.x) + 1.0) * side < view.eye_m[0] - 10.0;
        if (w.key.level == settings.root_level) {
            EXPECT_EQ(w.group, WantGroup::urgent);
        } else if (behind) {
            EXPECT_EQ(w.group, WantGroup::around);
        }
        visible += w.group == WantGroup::visible ? 1 : 0;
        around += w.group == WantGroup::around ? 1 : 0;
    }
    EXPECT_GT(visible, 10);
    EXPECT_GT(around, 10);
}

// A frustum may keep what is out of sight; it must not drop what is in sight.
TEST(Selection, FrustumKeepsEveryPointInView) {
    std::mt19937_64 dice(9);
    const auto uniform = [&](double a, double b) {
        return a + (b - a) * static_cast<double>(dice() >> 11) * 0x1.0p-53;
    };
    int inside = 0, culled = 0;
    for (int i = 0; i < 4000; ++i) {
        ViewState view =
            view_at(uniform(-1e6, 1e6), uniform(-1e6, 1e6), uniform(2, 9000), uniform(0, 6.28), uniform(-1.5, 0.7));
        view.vertical_fov_rad = uniform(0.3, 1.4);
        view.aspect = uniform(0.5, 2.5);
        const Frustum frustum(view);
        GroundSquare square{view.eye_m[0] + uniform(-30000, 30000), view.eye_m[1] + uniform(-30000, 30000),
                            uniform(10, 20000), 0, 0};
        square.low = uniform(-100, 800);
        square.high = square.low + uniform(0, 900);
        const bool kept = frustum.may_see(square);
        culled += kept ? 0 : 1;
        // The same by angles: a point is in view when it lies between the four edges of the picture.
        const double yaw = std::atan2(view.forward[1], view.forward[0]), pitch = std::asin(view.forward[2]);
        for (int k = 0; k < 20; ++k) {
            const double dx = square.x0 + uniform(0, 1) * square.side - view.eye_m[0];
            const double dy = square.y0 + uniform(0, 1) * square.side - view.eye_m[1];
            const double dz =
                uniform(square.low, square.high) - view.eye_m[2] - (dx * dx + dy * dy) / (2.0 * 6371000.0);
            const double east = std::cos(yaw) * dx + std::sin(yaw) * dy,
                         aside = -std::sin(yaw) * dx + std::cos(yaw) * dy;
            const double depth = std::cos(pitch) * east + std::sin(pitch) * dz;
            const double above = -std::sin(pitch) * east + std::cos(pitch) * dz;
            const double tan_v = std::tan(0.5 * view.vertical_fov_rad);
            if (depth <= 0.0 || std::abs(above) > tan_v * depth || std::abs(aside) > tan_v * view.aspect * depth)
                continue;
            ++inside;
            ASSERT_TRUE(kept);
        }
    }
    EXPECT_GT(inside, 1000);
    EXPECT_GT(culled, 1000);
}

TEST(StreamSettingsTest, ErrorsInPixels) {
    EXPECT_NEAR(error_px_of(lod_factor_for(1.0, 512, 0.9, 720), 512, 0.9, 720), 1.0, 1e-5);
    EXPECT_EQ(lod_factor_for(1e-3, 512, 0.9, 720), 6.0f); // clamped to what is allowed
    EXPECT_EQ(lod_factor_for(1e3, 512, 0.9, 720), 1.5f);
    for (const int radius : {0, 1, 2}) {
        const int level = root_level_for(60000.0, 1.0, 512, radius);
        const double reach = radius > 0 ? radius : 0.5;
        EXPECT_GE(std::ldexp(512.0, level) * reach, 60000.0);
        EXPECT_LT(std::ldexp(512.0, level - 1) * reach, 60000.0);
    }
    EXPECT_NEAR(horizon_m(100.0, 0.0), 35700.0, 10.0); // sqrt(2 R h)
}

TEST(StreamSettingsTest, WhatCannotBeKeptIsRefused) {
    const auto refusal = [](const StreamSettings& s, const StreamExternals& e) {
        const Status status = check_stream(s, e);
        return status.ok() ? std::string() : status.error().message;
    };
    const StreamSettings good;
    EXPECT_EQ(refusal(good, small_externals()), "");
    StreamSettings s = good;
    s.slots = 31; // 2 x 16 roots
    EXPECT_NE(refusal(s, small_externals()).find("slots must be at least 32"), std::string::npos);
    s = good;
    s.in_flight_mib = 5;
    EXPECT_NE(refusal(s, small_externals()).find("in_flight_mib must be at least 6"), std::string::npos);
    s = good;
    s.publish_mib_per_frame = 5;
    EXPECT_NE(refusal(s, small_externals()).find("publish_mib_per_frame must be at least 6"), std::string::npos);
    s = good;
    s.context_mib = 4;
    EXPECT_NE(refusal(s, small_externals()).find("context_mib must be at least 5"), std::string::npos);
    s = good;
    s.lod_factor = 1.0f;
    EXPECT_NE(refusal(s, small_externals()).find("lod_factor"), std::string::npos);
    StreamExternals e = small_externals();
    e.cell_m = 0.0;
    EXPECT_NE(refusal(good, e).find("cell_m"), std::string::npos);
}

TEST(StreamSettingsTest, PlannedBytesAreTheBudgets) {
    StreamSettings s;
    StreamExternals e = small_externals();
    e.slot_bytes = 1000;
    const StreamBytes b = plan_stream_bytes(s, e);
    EXPECT_EQ(b.slots, 96000u);
    EXPECT_EQ(b.host(), (static_cast<uint64_t>(s.in_flight_mib) + static_cast<uint64_t>(s.context_mib)) << 20);
}

} // namespace
} // namespace sahel::test
