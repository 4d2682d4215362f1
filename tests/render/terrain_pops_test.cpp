#include "render/terrain_nodes.h"
#include "tests/render/gl_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

/// No popping: where the ground is drawn finer or coarser from one frame to the next, its shape does not jump.
///
/// The eye goes 1 mm from one picture to the next. What it sees moves then by a little, everywhere; a level that
/// switches without having morphed would move whole nodes by as much as the two levels differ. Measured by distance,
/// which shading cannot hide.
namespace sahel {
namespace {

constexpr int k_width = 480, k_height = 272;

/// How far the distances of two pictures are apart, as a share: the largest, over blocks of 8 x 4 pixels that are full
/// of ground in both, of the block's median. A node fills blocks; a silhouette, where distances jump as the eye moves,
/// crosses them.
double apart(const std::vector<float>& a, const std::vector<float>& b) {
    constexpr int k_across = 8, k_down = 4;
    double worst = 0.0;
    std::vector<float> change;
    for (int y0 = 0; y0 < k_height; y0 += k_down)
        for (int x0 = 0; x0 < k_width; x0 += k_across) {
            change.clear();
            for (int y = y0; y < y0 + k_down; ++y)
                for (int x = x0; x < x0 + k_across; ++x) {
                    const auto i = static_cast<size_t>(y * k_width + x);
                    if (a[i] > 0.0f && b[i] > 0.0f) // depth is near / distance
                        change.push_back(std::abs(a[i] / b[i] - 1.0f));
                }
            if (change.size() < k_across * k_down) continue;
            std::nth_element(change.begin(), change.begin() + k_across * k_down / 2, change.end());
            worst = std::max(worst, double{change[k_across * k_down / 2]});
        }
    return worst;
}

/// Nodes of each step, 2, 4 and 8 cells: they change where ground is drawn finer or coarser.
std::array<int, 3> nodes_by_step(const Scene& scene, const CameraPose& pose) {
    std::vector<NodeInstance> nodes;
    const double above = pose.eye_m[2] - scene.session->lod_ground_m(pose.eye_m[0], pose.eye_m[1]);
    select_nodes(scene.session->streamer().frame().visible, {pose.eye_m[0], pose.eye_m[1]},
                 {1.0, 2.1f, std::max(above, 1.0), false}, nodes);
    std::array<int, 3> count{};
    for (const NodeInstance& n : nodes)
        if (n.node[2] <= 8) ++count[n.node[2] == 2 ? 0 : n.node[2] == 4 ? 1 : 2];
    return count;
}

TEST_F(GlTest, NoPopWhereALevelSwitches) {
    SceneOptions options;
    options.preset = "dunes";
    options.width = k_width;
    options.height = k_height;
    Scene scene(options);
    Renderer& r = scene.session->renderer();
    CameraPose pose = scene.pose(1100.0, -3900.0, 30.0);
    pose.pitch_deg = -10.0;
    const auto depth_at = [&](const CameraPose& eye) {
        FrameDesc frame = scene.frame(eye);
        frame.depth_only = true;
        EXPECT_TRUE(scene.session->render_settled(frame).ok());
        std::vector<float> depth;
        r.read_depth(depth);
        return depth;
    };
    const double from_m = pose.eye_m[0];
    struct Seen {
        std::vector<float> depth;
        std::array<int, 3> nodes;
    };
    const auto at = [&](double way_m) {
        pose.eye_m[0] = from_m + way_m;
        std::vector<float> depth = depth_at(pose);
        return Seen{std::move(depth), nodes_by_step(scene, pose)};
    };
    constexpr int k_places = 14;
    constexpr double k_stride_m = 4.096, k_step_m = 0.001; // halved twelve times
    double still = 0.0, switched = 0.0;
    int switches = 0;
    Seen here = at(0.0);
    for (int i = 0; i < k_places; ++i) {
        double low = i * k_stride_m, high = low + k_stride_m;
        Seen next = at(high);
        Seen there = next;
        if (next.nodes == here.nodes) {
            there = at(low + k_step_m);
            if (there.nodes == here.nodes) still = std::max(still, apart(here.depth, there.depth));
        } else {
            while (high - low > 1.01 * k_step_m) {
                const double middle = 0.5 * (low + high);
                Seen m = at(middle);
                (m.nodes == here.nodes ? low : high) = middle;
                (m.nodes == here.nodes ? here : there) = std::move(m);
            }
            switches += here.nodes[0] != there.nodes[0] && here.nodes[1] != there.nodes[1]; // not one out of sight
            switched = std::max(switched, apart(here.depth, there.depth));
        }
        here = std::move(next);
    }
    ASSERT_GE(switches, 2) << "the flight crosses no switch: it tests nothing";

    RecordProperty("between_pictures", std::to_string(still));
    RecordProperty("at_switches", std::to_string(switched));
    if (std::getenv("SAHEL_TEST_PICTURES"))
        std::printf("%d switches: %g without, %g with\n", switches, still, switched);
    // Without the morph these switches give 0.0015, where 6e-5 is the motion alone.
    EXPECT_LE(switched, 1.5 * still);
}

} // namespace
} // namespace sahel
