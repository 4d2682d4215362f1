#pragma once

#include "sim/tile_domain.h"

#include <vector>

/// One layer of a rectangle of resident tiles as one plane, for pictures, reports and files.
namespace sahel {

/// Owned cells row by row over the rectangle around the tiles (cells of tiles that are not there are 0): ticks as
/// metres, the others as they are. Errors: those of the device.
Result<std::vector<float>> field_of(const TileDomain& domain, SimLayer layer);

} // namespace sahel
