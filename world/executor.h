#pragma once

#include "world/macros.h"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

/// Runs a functor on every cell of a rectangle, or of the same rectangle of many tiles.
///
/// A kernel is a small trivially copyable functor with `SAHEL_HD void operator()(int32_t x, int32_t y) const` (or
/// `(int32_t slot, int32_t x, int32_t y)`) that writes only its own cell. The rectangle is cut into blocks of whole
/// rows, which threads take in any order; the loop over a row is given to the vectoriser with the promise that cells do
/// not depend on each other. Hence neither the cut nor the threads can change a bit. The same functor runs on CUDA
/// through executor_cuda.cuh.
///
///     rows    0 ..  7   block 0        one block: at least k_cells_per_block cells, so that handing it over costs
///     rows    8 .. 15   block 1        nothing beside it, and few enough that its rows stay in a core's cache
///     ...
///
/// May be called from several threads at once (loader threads do); a call returns when its cells are done.
namespace sahel {

/// Cells [x0, x1) x [y0, y1) in local coordinates.
struct LocalRect {
    int32_t x0 = 0;
    int32_t y0 = 0;
    int32_t x1 = 0;
    int32_t y1 = 0;

    SAHEL_HD bool empty() const { return x1 <= x0 || y1 <= y0; }
    SAHEL_HD int64_t area() const { return empty() ? 0 : static_cast<int64_t>(x1 - x0) * (y1 - y0); }
};

/// Threads that kernels use, from now on: 0 (the start) means one per core that this process may run on. With 1
/// everything runs in the calling thread. Not while kernels run.
void set_thread_count(int threads);
int thread_count();

/// What ran, for profiles: off until enabled, then one row per name. Thread safe.
struct LaunchRecord {
    std::string name;
    int64_t launches = 0;
    int64_t cells = 0;
    double ms = 0.0;
};
void record_launches(bool on);
void clear_launch_records();
/// Longest total first.
std::vector<LaunchRecord> launch_records();
/// "name  launches  cells  ms  Mcells/s  share", one line each, total last.
std::string launch_table(const std::vector<LaunchRecord>& records);

namespace detail {

inline constexpr int64_t k_cells_per_block = 8192;

bool launches_recorded();
void add_launch(const char* name, int64_t cells, double ms);

/// Calls run(context, i) once for each i in [0, count), on the threads set; returns when all are done.
void run_blocks(const char* name, int64_t cells, int64_t count, void (*run)(const void*, int64_t), const void* context);

} // namespace detail

// The templates below are compiled into the caller's instruction set. In a namespace of its own, because of two copies
// with one name the linker would keep only one (cpu_features.h).
#if defined(SAHEL_ISA_NAMESPACE)
#define SAHEL_EXECUTOR_JOIN(a, b) a##b
#define SAHEL_EXECUTOR_NAME(isa) SAHEL_EXECUTOR_JOIN(executor_, isa)
#define SAHEL_EXECUTOR_NAMESPACE SAHEL_EXECUTOR_NAME(SAHEL_ISA_NAMESPACE)
#else
#define SAHEL_EXECUTOR_NAMESPACE executor_plain
#endif

inline namespace SAHEL_EXECUTOR_NAMESPACE {

namespace executor_detail {

struct Blocks {
    LocalRect rect;
    int32_t rows_per_block;
    int32_t blocks_per_tile;
};

inline __attribute__((always_inline)) Blocks blocks_of(const LocalRect& rect) {
    const int64_t width = rect.x1 - rect.x0;
    const int64_t height = rect.y1 - rect.y0;
    const int64_t wanted = (detail::k_cells_per_block + width - 1) / width;
    const int64_t rows = wanted < height ? wanted : height;
    return {rect, static_cast<int32_t>(rows), static_cast<int32_t>((height + rows - 1) / rows)};
}

template <class F> struct Work {
    const F* kernel;
    Blocks blocks;
};

template <class F, class Cell>
inline __attribute__((always_inline)) void run_rows(const Blocks& b, int32_t block, const F& kernel, const Cell& cell) {
    const F f = kernel; // a copy of its own: the compiler sees that no store of a cell changes it
    const int32_t y0 = b.rect.y0 + block * b.rows_per_block;
    const int32_t y1 = y0 + b.rows_per_block < b.rect.y1 ? y0 + b.rows_per_block : b.rect.y1;
    const int32_t x0 = b.rect.x0;
    const int32_t x1 = b.rect.x1;
    for (int32_t y = y0; y < y1; ++y) {
        SAHEL_VECTORIZE
        for (int32_t x = x0; x < x1; ++x) cell(f, x, y);
    }
}

template <class F> void run_one(const void* context, int64_t i) {
    const auto& work = *static_cast<const Work<F>*>(context);
    run_rows(
        work.blocks, static_cast<int32_t>(i), *work.kernel,
        [](const F& f, int32_t x, int32_t y) __attribute__((always_inline)) { f(x, y); });
}

template <class F> void run_tiles(const void* context, int64_t i) {
    const auto& work = *static_cast<const Work<F>*>(context);
    const auto slot = static_cast<int32_t>(i / work.blocks.blocks_per_tile);
    run_rows(
        work.blocks, static_cast<int32_t>(i % work.blocks.blocks_per_tile),
        *work.kernel, [slot](const F& f, int32_t x, int32_t y) __attribute__((always_inline)) { f(slot, x, y); });
}

} // namespace executor_detail

/// f(x, y) for every cell of the rectangle.
template <class F> void for_each_cell(const char* name, const LocalRect& rect, const F& f) {
    if (rect.empty()) return;
    const executor_detail::Work<F> work{&f, executor_detail::blocks_of(rect)};
    detail::run_blocks(name, rect.area(), work.blocks.blocks_per_tile, &executor_detail::run_one<F>, &work);
}

/// f(slot, x, y) for every cell of the rectangle in each of `slots` tiles.
template <class F> void for_each_cell(const char* name, int32_t slots, const LocalRect& rect, const F& f) {
    if (rect.empty() || slots <= 0) return;
    const executor_detail::Work<F> work{&f, executor_detail::blocks_of(rect)};
    detail::run_blocks(name, rect.area() * slots, static_cast<int64_t>(work.blocks.blocks_per_tile) * slots,
                       &executor_detail::run_tiles<F>, &work);
}

/// f(i) for every i in [0, count), one by one, on the threads set: for work that is coarse. `cells`: what it is
/// recorded as.
template <class F> void for_each_index(const char* name, int64_t cells, int64_t count, const F& f) {
    detail::run_blocks(
        name, cells, count, [](const void* context, int64_t i) { (*static_cast<const F*>(context))(i); }, &f);
}
template <class F> void for_each_index(const char* name, int64_t count, const F& f) {
    for_each_index(name, count, count, f);
}

} // namespace SAHEL_EXECUTOR_NAMESPACE
} // namespace sahel
