#include "sim/sim_layers.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace sahel {
namespace {

TEST(SimLayers, EveryConservedLayerIsATickLayerOfTheWorldsState) {
    k_conserved_layers.for_each([](SimLayer layer) {
        const SimLayerInfo& info = info_of(layer);
        ASSERT_TRUE(info.world.has_value()) << info.name;
        const LayerInfo& stored = info_of(*info.world);
        EXPECT_EQ(info.name, stored.name);
        EXPECT_EQ(info.type, LayerType::ticks) << info.name;
        EXPECT_EQ(stored.type, LayerType::ticks) << info.name;
        EXPECT_EQ(stored.role, LayerRole::state) << info.name;
    });
    EXPECT_EQ(k_conserved_count, 7);
}

TEST(SimLayers, NamesFindTheirLayers) {
    std::set<std::string_view> names;
    for (const SimLayerInfo& info : k_sim_layers) {
        EXPECT_TRUE(names.insert(info.name).second) << info.name;
        EXPECT_EQ(sim_layer_named(info.name), info.layer);
    }
    EXPECT_FALSE(sim_layer_named("gold").has_value());
    EXPECT_FALSE(sim_layer_named("").has_value());
}

} // namespace
} // namespace sahel
