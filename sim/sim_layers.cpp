#include "sim/sim_layers.h"

namespace sahel {

std::optional<SimLayer> sim_layer_named(std::string_view name) {
    for (const SimLayerInfo& info : k_sim_layers)
        if (info.name == name) return info.layer;
    return std::nullopt;
}

} // namespace sahel
