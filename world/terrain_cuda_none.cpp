#include "world/terrain_driver.h"

namespace sahel {

Status read_terrain_cuda(const TerrainTables&, int32_t, float, LayerBlock&) {
    return Error{ErrorKind::unsupported, "base terrain: this program was built without CUDA"};
}

} // namespace sahel
