#pragma once

#include "world/dem_mosaic.h"

#include <cstdint>

/// Heights of target cells from the samples of the files.
///
/// Bicubic convolution with a = -1/2 (R. Keys, Cubic convolution interpolation for digital image processing, IEEE
/// Trans. ASSP 29, 1981), the kernel GDAL calls "cubic". Where a cell is larger than a sample the kernel is widened by
/// the ratio, so that it averages instead of skipping. A cell whose centre is a sample's centre gets that sample
/// exactly.
///
/// Overshoot: beside missing samples the cubic would ring, so there the triangle (bilinear) kernel over the samples
/// that exist is taken: a mean, never above or below them. A cell has data if at least half of that kernel's weight
/// does.
namespace sahel {

/// Bits of one cell while the import runs: those of Layer::mask in a byte.
using DemMask = uint8_t;

/// Fills `ticks` (height minus `datum_m`, ticks of layers.h) and `mask` (0: data; k_mask_filled: inside a file but no
/// data; k_mask_outside: in no file) for the cells, row after row. The result does not depend on the rectangle. At most
/// about `window_bytes` of samples are held at a time, by cutting the rectangle. Errors: those of DemSource::read.
Status resample_dem(DemMosaic& mosaic, const CellRect& cells, double datum_m, uint64_t window_bytes, int32_t* ticks,
                    DemMask* mask);

} // namespace sahel
