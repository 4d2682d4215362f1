#pragma once

#include "render/camera.h"
#include "render/gl_context.h"
#include "render/png_io.h"
#include "tools/view_session.h"
#include "world/base_terrain.h"
#include "world/ground_sampler.h"

#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <string>

/// What tests of pictures share: a landscape, its view session and cameras over it. Every test has a context of its
/// own.
namespace sahel {

/// A landscape whose finer levels can be kept back: a load below `least_level` fails for good.
class WithheldTerrain final : public SurfaceSource {
  public:
    WithheldTerrain(uint64_t seed, const std::string& preset) : terrain_(seed, base_terrain_preset(preset).value()) {}
    Status read(LayerBlock& block) const override;
    [[nodiscard]] double cell_m() const override { return terrain_.cell_m(); }
    std::atomic<int> least_level{0};
    /// As if wind had been simulated, blowing to this direction (0 east, 90 south) at 8 m/s, more slowly in a stripe
    /// every 64 cells, where there is shelter and sand in the air. Below 0: no wind.
    std::atomic<float> wind_deg{-1.0f};

  private:
    BaseTerrain terrain_;
};

struct SceneOptions {
    std::string preset = "oasis";
    uint64_t seed = 1;
    int width = 320, height = 180;
    int workers = 0;
    int root_level = 5;
    Atmosphere atmosphere = atmosphere_presets()[0].atmosphere;
};

class Scene {
  public:
    explicit Scene(const SceneOptions& options);

    /// An eye so high over the surface below it; pitch 0.
    [[nodiscard]] CameraPose pose(double x_m, double y_m, double height_m, double yaw_deg = 0.0);
    [[nodiscard]] FrameDesc frame(const CameraPose& pose) const;
    /// The settled picture.
    [[nodiscard]] Image picture(const FrameDesc& frame);
    /// The picture of what is there, after `dt_s` of streaming.
    [[nodiscard]] Image picture_now(const FrameDesc& frame, double dt_s);
    [[nodiscard]] Image read() const;

    WithheldTerrain terrain;
    GroundSampler ground;
    std::unique_ptr<tools::ViewSession> session;
};

class GlTest : public ::testing::Test {
  protected:
    void SetUp() override;
    void TearDown() override;
    std::unique_ptr<GlContext> context;
};

struct Difference {
    double mean = 0.0;        ///< mean of |a - b| over pixels and channels, 0 .. 1
    double worst_block = 0.0; ///< the largest |mean(a) - mean(b)| of a block of 16 x 16 pixels and a channel
    double jumped = 0.0;      ///< share of pixels whose luminance differs by more than 0.1
};
Difference compare(const Image& a, const Image& b);

/// Writes a picture where SAHEL_TEST_PICTURES names a folder, to be looked at.
void save_for_eyes(const std::string& name, const Image& image);

} // namespace sahel
