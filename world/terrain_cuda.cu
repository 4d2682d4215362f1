// nvcc's own host code of pointers to members
#pragma GCC diagnostic ignored "-Wparentheses"
#define SAHEL_ISA_NAMESPACE isa_cuda
#include "world/cuda_runtime.h"
#include "world/executor_cuda.cuh"
#include "world/terrain_cell_rows.h"
#include "world/terrain_driver.h"
#include "world/terrain_lakes.h"
#include "world/terrain_layout.h"
#include "world/terrain_spline_rows.h"
#include "world/terrain_streams.h"
#include "world/terrain_water_rows.h"

#include <algorithm>
#include <vector>

// The base terrain on a device: the row kernels of the CPU with rows of one sample, one thread each.
namespace sahel {

namespace {

constexpr int64_t k_piece_side = 512; // remainders stay within int32, memory within some 30 MB

/// Lattices in device memory: fields one after the other.
struct DeviceFields {
    float* data = nullptr;
    int64_t field_elements = 0;
    int32_t columns = 0;
    __device__ float* at(int field, int32_t x, int32_t y) const {
        return data + field * field_elements + static_cast<int64_t>(y) * columns + x;
    }
};

struct DevicePiece {
    const TerrainTables* tables;
    const LakeSite* lakes;
    int32_t lake_count;
    const StreamPiece* streams;
    int32_t stream_count;
    bool dune, canyon;
    TerrainLayout l;
    DeviceFields coarse, sharp_coarse; // sums at every fourth node
    DeviceFields sum, land, node, sharp, mid, sharp_mid;

    __device__ bool has_lake() const { return lake_count > 0 || stream_count > 0; } // streams hold off what lakes do
    __device__ BaseRow base_row(int32_t x, int32_t y, float (&scratch)[k_row_scratch]) const {
        BaseRow row{};
        for (int f = 0; f < k_sum_fields; ++f) row.sum[f] = sum.at(f, x, y);
        row.height = land.at(0, x, y);
        for (int f = 0; f < k_node_fields; ++f) row.field[f] = node.at(f, x, y);
        for (int i = 0; i < k_row_scratch; ++i) row.scratch[i] = &scratch[i];
        return row;
    }
    __device__ const float* node_data(int f, int32_t x, int32_t y) const {
        return f == static_cast<int>(NodeField::height) && l.has_spline() ? sharp.at(0, x, y) : node.at(f, x, y);
    }
    __device__ const float* mid_data(int f, int32_t x, int32_t y) const {
        return f == static_cast<int>(MidField::height) ? sharp_mid.at(0, x, y) : mid.at(f, x, y);
    }
    __device__ static float spline_at(const float* a, int32_t columns, const float (&weights)[4], float f) {
        float v[4];
        for (int k = 0; k < 4; ++k)
            v[k] = spline_mix(weights, a[k], a[columns + k], a[2 * columns + k], a[3 * columns + k]);
        return spline_value(f, v[0], v[1], v[2], v[3]);
    }
    __device__ void nodes_at(int64_t sample_x, int64_t sample_y, int32_t per_interval, float offset,
                             float (&out)[k_node_fields]) const {
        const SplinePlace px = spline_place(sample_x, per_interval, offset, l.node_x.first);
        const SplinePlace py = spline_place(sample_y, per_interval, offset, l.node_y.first);
        float weights[4];
        spline_weights(py.f, weights);
        for (int f = 0; f < k_node_fields; ++f)
            out[f] = spline_at(node_data(f, px.at, py.at), l.node_x.count, weights, px.f);
    }
    __device__ MidRow mid_row(const float (&from)[k_node_fields], float (&scratch)[k_row_scratch]) const {
        MidRow row{};
        for (int f = 0; f < k_node_fields; ++f) row.node[f] = &from[f];
        for (int i = 0; i < k_row_scratch; ++i) row.scratch[i] = &scratch[i];
        row.has_dune = dune;
        row.has_canyon = canyon;
        row.has_lake = has_lake();
        return row;
    }
};

struct CoarseSumKernel {
    DevicePiece p;
    SumRange range;
    __device__ void operator()(int32_t x, int32_t y) const {
        float scratch[k_row_scratch];
        BaseRow row{};
        for (int f = 0; f < k_sum_fields; ++f) row.sum[f] = p.coarse.at(f, x, y);
        for (int i = 0; i < k_row_scratch; ++i) row.scratch[i] = &scratch[i];
        isa_cuda::sum_row(*p.tables, p.l.sum_row(y, x), 1, p.l.node_m, range, row);
    }
};
struct SharpenSumKernel {
    DevicePiece p;
    __device__ void operator()(int32_t x, int32_t y) const {
        for (int f = 0; f < k_sum_fields; ++f)
            if (sum_needed(*p.tables, static_cast<SumField>(f)))
                isa_cuda::sharpen_row(p.coarse.at(f, x, y - 1), p.coarse.at(f, x, y), p.coarse.at(f, x, y + 1), 1,
                                      p.sharp_coarse.at(f, x, y));
    }
};
struct BaseKernel {
    DevicePiece p;
    SumRange range;
    __device__ void operator()(int32_t x, int32_t y) const {
        float scratch[k_row_scratch];
        const BaseRow row = p.base_row(x, y, scratch);
        const SplinePlace px = spline_place(p.l.node_x.first + x, k_nodes_per_sum, p.l.sum_offset(), p.l.sum_x.first);
        const SplinePlace py = spline_place(p.l.node_y.first + y, k_nodes_per_sum, p.l.sum_offset(), p.l.sum_y.first);
        float weights[4];
        spline_weights(py.f, weights);
        for (int f = 0; f < k_sum_fields; ++f)
            if (sum_needed(*p.tables, static_cast<SumField>(f)))
                *row.sum[f] =
                    DevicePiece::spline_at(p.sharp_coarse.at(f, px.at, py.at), p.l.sum_x.count, weights, px.f);
        isa_cuda::sum_row(*p.tables, p.l.node_row(y, x), 1, p.l.node_m, range, row);
        isa_cuda::base_row(*p.tables, p.l.node_row(y, x), 1, p.l.node_m, row);
        isa_cuda::lake_row(*p.tables, p.l.node_row(y, x), 1, p.l.node_m, p.lakes, p.lake_count, row);
        isa_cuda::stream_row(*p.tables, p.l.node_row(y, x), 1, p.l.node_m, p.streams, p.stream_count, row);
    }
};
struct DetailKernel {
    DevicePiece p;
    __device__ void operator()(int32_t x, int32_t y) const {
        float scratch[k_row_scratch];
        isa_cuda::detail_row(*p.tables, p.l.node_row(y, x), 1, p.l.node_m, p.land.at(0, x, y - 1),
                             p.land.at(0, x, y + 1), p.dune, p.canyon, p.l.has_spline(), p.base_row(x, y, scratch));
    }
};
struct SharpenKernel {
    DevicePiece p;
    __device__ void operator()(int32_t x, int32_t y) const {
        constexpr int k_height = static_cast<int>(NodeField::height);
        isa_cuda::sharpen_row(p.node.at(k_height, x, y - 1), p.node.at(k_height, x, y), p.node.at(k_height, x, y + 1),
                              1, p.sharp.at(0, x, y));
    }
};
struct SharpenMidKernel {
    DevicePiece p;
    __device__ void operator()(int32_t x, int32_t y) const {
        constexpr int k_height = static_cast<int>(MidField::height);
        isa_cuda::sharpen_row(p.mid.at(k_height, x, y - 1), p.mid.at(k_height, x, y), p.mid.at(k_height, x, y + 1), 1,
                              p.sharp_mid.at(0, x, y));
    }
};
struct MidKernel {
    DevicePiece p;
    __device__ void operator()(int32_t x, int32_t y) const {
        float from[k_node_fields], scratch[k_row_scratch];
        p.nodes_at(p.l.mid_x.first + x, p.l.mid_y.first + y, k_mids_per_node, 0.0f, from);
        MidRow row = p.mid_row(from, scratch);
        for (int f = 0; f < k_mid_fields; ++f) row.out[f] = p.mid.at(f, x, y);
        isa_cuda::middle_row(*p.tables, p.l.mid_row(y, x), 1, p.l.mid_m, row);
    }
};

struct CellKernel {
    DevicePiece p;
    float stretch;
    int32_t left, top; // of the piece in the block
    FieldView<int32_t> surface[4];
    FieldView<float> weight[4]; // mountain, dune, canyon, wetness; null where the block has none

    __device__ void operator()(int32_t x, int32_t y) const {
        const TerrainLayout& l = p.l;
        float node[k_node_fields], mid[k_mid_fields], scratch[k_row_scratch];
        if (l.has_spline())
            p.nodes_at(l.rect.x0 + x, l.rect.y0 + y, l.cells_per_node, 0.5f, node);
        else
            for (int f = 0; f < k_node_fields; ++f) node[f] = *p.node.at(f, x + 1, y + 1);
        if (l.has_mid_spline()) {
            const SplinePlace px = spline_place(l.rect.x0 + x, l.cells_per_mid, 0.5f, l.mid_x.first);
            const SplinePlace py = spline_place(l.rect.y0 + y, l.cells_per_mid, 0.5f, l.mid_y.first);
            float weights[4];
            spline_weights(py.f, weights);
            for (int f = 0; f < k_mid_fields; ++f)
                mid[f] = DevicePiece::spline_at(p.mid_data(f, px.at, py.at), l.mid_x.count, weights, px.f);
        } else {
            MidRow row = p.mid_row(node, scratch);
            for (int f = 0; f < k_mid_fields; ++f) row.out[f] = &mid[f];
            isa_cuda::middle_row(*p.tables, l.cell_row(y, x), 1, l.mid_m, row);
        }
        float out[4];
        CellRow row{};
        for (int f = 0; f < k_node_fields; ++f) row.node[f] = &node[f];
        for (int f = 0; f < k_mid_fields; ++f) row.mid[f] = &mid[f];
        for (int i = 0; i < k_row_scratch; ++i) row.scratch[i] = &scratch[i];
        row.rock = &out[0];
        row.soil = &out[1];
        row.sand = &out[2];
        row.water = &out[3];
        row.has_dune = p.dune;
        row.has_canyon = p.canyon;
        row.has_lake = p.has_lake();
        row.has_stream = p.stream_count > 0;
        isa_cuda::cell_row(*p.tables, l.cell_row(y, x), 1, l.cell_m, row);
        for (int i = 0; i < 4; ++i)
            if (surface[i].origin != nullptr) surface[i](left + x, top + y) = ticks_of_metres(out[i] * stretch);
        constexpr NodeField k_weight[4] = {NodeField::mountain, NodeField::dune, NodeField::canyon, NodeField::wetness};
        for (int i = 0; i < 4; ++i)
            if (weight[i].origin != nullptr) weight[i](left + x, top + y) = node[static_cast<int>(k_weight[i])];
    }
};

template <class T> Result<Buffer> uploaded(const T* from, size_t count, MemoryPool& pool) {
    SAHEL_ASSIGN(Buffer buffer, Buffer::allocate(pool, std::max<uint64_t>(count, 1) * sizeof(T)));
    if (count > 0) SAHEL_TRY(cuda::copy_to_device(buffer.data(), from, count * sizeof(T)));
    return Result<Buffer>(std::move(buffer));
}

Result<Buffer> fields(int count, int64_t elements, MemoryPool& pool) {
    return Buffer::allocate(pool, static_cast<uint64_t>(std::max<int64_t>(elements, 1)) * static_cast<uint64_t>(count) *
                                      sizeof(float));
}

Status zero_other_layers(LayerBlock& block) {
    cudaError_t error = cudaSuccess;
    const auto zero = [&](auto view) { // elements of all kinds have four bytes
        if (error != cudaSuccess) return;
        error = cudaMemset2D(view.row(view.y0) + view.x0, static_cast<size_t>(view.stride) * 4, 0,
                             static_cast<size_t>(view.width()) * 4, static_cast<size_t>(view.height()));
    };
    block.layers().for_each([&](Layer layer) {
        if (k_surface_layers.contains(layer) || k_weight_layers.contains(layer)) return;
        if (info_of(layer).type == LayerType::real)
            zero(block.reals(layer));
        else
            zero(block.ints(layer));
    });
    return cuda::check_call(error, "cudaMemset2D");
}

} // namespace

Status read_terrain_cuda(const TerrainTables& t, int32_t level, float stretch, LayerBlock& block) {
    if (!cuda::available())
        return Error{ErrorKind::unsupported, "base terrain: no CUDA device: " + cuda::status().why_not};
    SAHEL_TRY(zero_other_layers(block));
    MemoryPool pool("base terrain, one piece", MemoryKind::cuda, uint64_t{256} << 20);
    SAHEL_ASSIGN(const Buffer tables, uploaded(&t, 1, pool));
    const CellRect all = block.rect();
    std::vector<LakeSite> sites;
    find_lakes_near(t, SAHEL_ISA_CALL(terrain_kernels), level, all, sites);
    SAHEL_ASSIGN(const Buffer lakes, uploaded(sites.data(), sites.size(), pool));
    std::vector<StreamPiece> pieces;
    find_streams_near(t, SAHEL_ISA_CALL(terrain_kernels), level, all, sites, pieces);
    SAHEL_ASSIGN(const Buffer streams, uploaded(pieces.data(), pieces.size(), pool));

    for (int64_t y0 = all.y0; y0 < all.y1; y0 += k_piece_side)
        for (int64_t x0 = all.x0; x0 < all.x1; x0 += k_piece_side) {
            const CellRect rect{x0, y0, std::min(x0 + k_piece_side, all.x1), std::min(y0 + k_piece_side, all.y1)};
            DevicePiece p{};
            p.tables = static_cast<const TerrainTables*>(tables.data());
            p.lakes = static_cast<const LakeSite*>(lakes.data());
            p.lake_count = static_cast<int32_t>(sites.size());
            p.streams = static_cast<const StreamPiece*>(streams.data());
            p.stream_count = static_cast<int32_t>(pieces.size());
            p.dune = t.p.dune_m > 0.0f;
            p.canyon = t.p.canyon_m > 0.0f && t.p.sea == 0;
            p.l = make_terrain_layout(rect, level);
            const int32_t columns = p.l.node_x.count, rows = p.l.node_y.count;
            const int64_t nodes = static_cast<int64_t>(columns) * rows;
            const int64_t mids = static_cast<int64_t>(p.l.mid_x.count) * p.l.mid_y.count;
            const int64_t sums = static_cast<int64_t>(p.l.sum_x.count) * p.l.sum_y.count;
            SAHEL_ASSIGN(const Buffer coarse, fields(k_sum_fields, sums, pool));
            SAHEL_ASSIGN(const Buffer sharp_coarse, fields(k_sum_fields, sums, pool));
            SAHEL_ASSIGN(const Buffer sum, fields(k_sum_fields, nodes, pool));
            SAHEL_ASSIGN(const Buffer land, fields(1, nodes, pool));
            SAHEL_ASSIGN(const Buffer node, fields(k_node_fields, nodes, pool));
            SAHEL_ASSIGN(const Buffer sharp, fields(1, nodes, pool));
            SAHEL_ASSIGN(const Buffer mid, fields(k_mid_fields, mids, pool));
            SAHEL_ASSIGN(const Buffer sharp_mid, fields(1, mids, pool));
            p.coarse = {static_cast<float*>(coarse.data()), sums, p.l.sum_x.count};
            p.sharp_coarse = {static_cast<float*>(sharp_coarse.data()), sums, p.l.sum_x.count};
            p.sum = {static_cast<float*>(sum.data()), nodes, columns};
            p.land = {static_cast<float*>(land.data()), nodes, columns};
            p.node = {static_cast<float*>(node.data()), nodes, columns};
            p.sharp = {static_cast<float*>(sharp.data()), nodes, columns};
            p.mid = {static_cast<float*>(mid.data()), mids, p.l.mid_x.count};
            p.sharp_mid = {static_cast<float*>(sharp_mid.data()), mids, p.l.mid_x.count};

            const int32_t sum_columns = p.l.sum_x.count, sum_rows = p.l.sum_y.count;
            SAHEL_TRY(cuda::for_each_cell("world/terrain_sums", {0, 0, sum_columns, sum_rows},
                                          CoarseSumKernel{p, coarse_range(p.l)}));
            SAHEL_TRY(cuda::for_each_cell("world/terrain_sharpen_sums", {1, 1, sum_columns - 1, sum_rows - 1},
                                          SharpenSumKernel{p}));
            SAHEL_TRY(cuda::for_each_cell("world/terrain_base", {0, 0, columns, rows}, BaseKernel{p, node_range(p.l)}));
            SAHEL_TRY(cuda::for_each_cell("world/terrain_detail", {1, 1, columns - 1, rows - 1}, DetailKernel{p}));
            if (p.l.has_spline())
                SAHEL_TRY(
                    cuda::for_each_cell("world/terrain_sharpen", {2, 2, columns - 2, rows - 2}, SharpenKernel{p}));
            if (p.l.has_mid_spline()) {
                const int32_t mid_columns = p.l.mid_x.count, mid_rows = p.l.mid_y.count;
                SAHEL_TRY(cuda::for_each_cell("world/terrain_middle", {0, 0, mid_columns, mid_rows}, MidKernel{p}));
                SAHEL_TRY(cuda::for_each_cell("world/terrain_sharpen_middle", {1, 1, mid_columns - 1, mid_rows - 1},
                                              SharpenMidKernel{p}));
            }
            CellKernel cells{};
            cells.p = p;
            cells.stretch = stretch;
            cells.left = static_cast<int32_t>(x0 - block.owned().x0);
            cells.top = static_cast<int32_t>(y0 - block.owned().y0);
            constexpr Layer k_surface[4] = {Layer::bedrock, Layer::soil, Layer::sand, Layer::water};
            constexpr Layer k_weight[4] = {Layer::mountain, Layer::dune, Layer::canyon, Layer::wetness};
            for (int i = 0; i < 4; ++i) {
                if (block.layers().contains(k_surface[i])) cells.surface[i] = block.ints(k_surface[i]);
                if (block.layers().contains(k_weight[i])) cells.weight[i] = block.reals(k_weight[i]);
            }
            SAHEL_TRY(cuda::for_each_cell(
                "world/terrain_cells", {0, 0, static_cast<int32_t>(rect.width()), static_cast<int32_t>(rect.height())},
                cells));
            SAHEL_TRY(cuda::synchronize()); // the piece's memory is given back
        }
    return {};
}

} // namespace sahel
