#include "world/executor.h"

#include "stencil_pass.h"
#include "world/cpu_features.h"
#include "world/cuda_runtime.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <utility>
#include <vector>

namespace sahel {

namespace test {
namespace {
void run_best(const LocalRect& rect, const StencilPass& pass) {
    SAHEL_ISA_CALL(run_stencil, rect, pass);
}
void run_best_tiles(int32_t slots, const LocalRect& rect, const TilesStencilPass& pass) {
    SAHEL_ISA_CALL(run_stencil_tiles, slots, rect, pass);
}
} // namespace
} // namespace test

namespace {

using test::StencilPass;
using test::TilesStencilPass;

constexpr int32_t k_width = 701; // odd, so that rows end in the middle of a vector
constexpr int32_t k_height = 203;
constexpr CellRect k_area{-123456, 4'000'000'000'000, -123456 + k_width, 4'000'000'000'000 + k_height};
const LayerSet k_layers_used{Layer::bedrock, Layer::sand, Layer::dune};

// Restores the number of threads and the instruction set.
class ExecutorTest : public testing::Test {
  protected:
    void TearDown() override {
        set_thread_count(0);
        set_isa(best_isa());
        record_launches(false);
        clear_launch_records();
    }
};

LayerBlock make_block(MemoryPool& pool = MemoryPool::host()) {
    return LayerBlock::allocate(0, k_area, 1, k_layers_used, pool).value();
}

void fill_heights(LayerBlock& block) {
    block.clear();
    const RandomStream random(11, 0, Purpose::test);
    auto height = block.ints(Layer::bedrock);
    for (int32_t y = height.y0; y < height.y1; ++y)
        for (int32_t x = height.x0; x < height.x1; ++x)
            height(x, y) = static_cast<int32_t>(random.at(x, y).v[0] >> 14) - 4'000'000;
}

StencilPass pass_over(LayerBlock& block) {
    return {std::as_const(block).ints(Layer::bedrock),
            block.ints(Layer::sand),
            block.reals(Layer::dune),
            RandomStream(5, 17, Purpose::test),
            k_area.x0,
            k_area.y0};
}

// Bits of both results, row by row.
std::vector<uint32_t> bits_of(const LayerBlock& block) {
    std::vector<uint32_t> bits;
    const auto moved = block.ints(Layer::sand);
    const auto steepness = block.reals(Layer::dune);
    for (int32_t y = 0; y < k_height; ++y)
        for (int32_t x = 0; x < k_width; ++x) {
            bits.push_back(static_cast<uint32_t>(moved(x, y)));
            bits.push_back(det::bits_of(steepness(x, y)));
        }
    return bits;
}

// The plainest loop there is.
const std::vector<uint32_t>& reference() {
    static const std::vector<uint32_t> made = [] {
        LayerBlock block = make_block();
        fill_heights(block);
        const StencilPass pass = pass_over(block);
        for (int32_t y = 0; y < k_height; ++y)
            for (int32_t x = 0; x < k_width; ++x) pass(x, y);
        return bits_of(block);
    }();
    return made;
}

std::vector<uint32_t> run(const std::vector<LocalRect>& rects) {
    LayerBlock block = make_block();
    fill_heights(block);
    for (const LocalRect& rect : rects) test::run_best(rect, pass_over(block));
    return bits_of(block);
}

TEST_F(ExecutorTest, SameBitsForAnyThreadsRectanglesAndInstructionSet) {
    const LocalRect whole{0, 0, k_width, k_height};
    const std::vector<LocalRect> halves{{0, 100, k_width, k_height}, {0, 0, k_width, 100}};
    std::vector<LocalRect> scraps; // columns and rows of every small size, backwards
    for (int32_t y = k_height; y > 0; y -= 37)
        for (int32_t x = k_width; x > 0; x -= 53) scraps.push_back({std::max(0, x - 53), std::max(0, y - 37), x, y});
    for (const Isa wanted : {Isa::baseline, Isa::v3}) {
        if (set_isa(wanted) != wanted) continue; // the v3 test below says so
        for (const int threads : {1, 2, 5}) {
            set_thread_count(threads);
            EXPECT_EQ(thread_count(), threads);
            EXPECT_EQ(run({whole}), reference()) << name_of(wanted) << ' ' << threads;
            EXPECT_EQ(run(halves), reference()) << name_of(wanted) << ' ' << threads;
            EXPECT_EQ(run(scraps), reference()) << name_of(wanted) << ' ' << threads;
        }
    }
}

TEST_F(ExecutorTest, V3KernelsRunHere) {
    if (best_isa() != Isa::v3) GTEST_SKIP() << "this machine has no x86-64-v3; only baseline kernels were tested";
    EXPECT_EQ(set_isa(Isa::v3), Isa::v3);
    EXPECT_EQ(run({{0, 0, k_width, k_height}}), reference());
}

// A whole pass, with stencil, random numbers and deterministic functions, becomes packed code.
TEST_F(ExecutorTest, AWholePassVectorises) {
#if defined(SAHEL_STENCIL_V3_OBJECT)
    if (std::system("objdump --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "objdump is not installed (binutils)";
    FILE* pipe = popen("objdump -d --no-show-raw-insn '" SAHEL_STENCIL_V3_OBJECT "'", "r");
    ASSERT_NE(pipe, nullptr);
    std::array<char, 4096> line{};
    int packed = 0;
    while (std::fgets(line.data(), line.size(), pipe))
        if (std::strstr(line.data(), "vmulps") && std::strstr(line.data(), "%ymm")) ++packed;
    pclose(pipe);
    EXPECT_GE(packed, 100);
#else
    GTEST_SKIP() << "debug or sanitizer build, another compiler than g++, or not an x86-64 machine";
#endif
}

TEST_F(ExecutorTest, ManyTilesAreTheSameAsOne) {
    LayerBlock block = make_block();
    fill_heights(block);
    constexpr int32_t rows = 29;
    static_assert(k_height % rows == 0);
    for (const int threads : {1, 3}) {
        set_thread_count(threads);
        test::run_best_tiles(k_height / rows, LocalRect{0, 0, k_width, rows}, TilesStencilPass{pass_over(block), rows});
        EXPECT_EQ(bits_of(block), reference()) << threads;
    }
}

TEST_F(ExecutorTest, EveryCellRunsExactlyOnce) {
    for (const int threads : {1, 4})
        for (const LocalRect rect : {LocalRect{-3, -5, 1000, 77}, LocalRect{0, 0, 1, 20000}, LocalRect{5, 5, 6, 6},
                                     LocalRect{-20000, 0, 20000, 3}}) {
            set_thread_count(threads);
            const int32_t width = rect.x1 - rect.x0;
            std::vector<int32_t> count(static_cast<size_t>(rect.area() * 3));
            int32_t* const cells = count.data();
            for_each_cell("test/count", 3, rect, [=](int32_t slot, int32_t x, int32_t y) {
                cells[slot * rect.area() + static_cast<int64_t>(y - rect.y0) * width + (x - rect.x0)] += 1;
            });
            for (const int32_t c : count) ASSERT_EQ(c, 1);
        }
    for_each_cell("test/none", LocalRect{3, 0, 3, 9}, [](int32_t, int32_t) { FAIL(); });
    for_each_cell("test/none", 0, LocalRect{0, 0, 3, 9}, [](int32_t, int32_t, int32_t) { FAIL(); });
}

TEST_F(ExecutorTest, SeveralThreadsMayCallAtOnce) {
    set_thread_count(2);
    std::vector<std::thread> callers;
    std::atomic<int> wrong{0};
    (void)reference();
    for (int t = 0; t < 4; ++t)
        callers.emplace_back([&] {
            for (int i = 0; i < 3; ++i)
                if (run({{0, 0, k_width, k_height}}) != reference()) ++wrong;
        });
    for (std::thread& caller : callers) caller.join();
    EXPECT_EQ(wrong.load(), 0);
}

TEST_F(ExecutorTest, LaunchesAreRecordedByName) {
    for_each_cell("test/unseen", LocalRect{0, 0, 10, 10}, [](int32_t, int32_t) {});
    record_launches(true);
    for (int i = 0; i < 3; ++i) for_each_cell("test/a", LocalRect{0, 0, 10, 10}, [](int32_t, int32_t) {});
    for_each_cell("test/b", 4, LocalRect{0, 0, 10, 10}, [](int32_t, int32_t, int32_t) {});
    record_launches(false);
    for_each_cell("test/unseen", LocalRect{0, 0, 10, 10}, [](int32_t, int32_t) {});
    const auto records = launch_records();
    ASSERT_EQ(records.size(), 2u);
    for (const LaunchRecord& r : records) {
        EXPECT_EQ(r.launches, r.name == "test/a" ? 3 : 1) << r.name;
        EXPECT_EQ(r.cells, r.name == "test/a" ? 300 : 400) << r.name;
        EXPECT_GE(r.ms, 0.0);
    }
    const std::string table = launch_table(records);
    EXPECT_NE(table.find("test/b"), std::string::npos);
    EXPECT_NE(table.find("total"), std::string::npos);
    EXPECT_NE(table.find("700"), std::string::npos);
    clear_launch_records();
    EXPECT_TRUE(launch_records().empty());
}

TEST_F(ExecutorTest, CudaGivesTheSameBits) {
#if SAHEL_HAS_CUDA
    if (!cuda::available()) GTEST_SKIP() << "no CUDA device: " << cuda::status().why_not;
    LayerBlock host = make_block();
    fill_heights(host);
    MemoryPool pool("test device", MemoryKind::cuda, 1u << 30);
    LayerBlock device = make_block(pool);
    const auto upload = [&] {
        // The columns lie in one buffer in both memories, in the same layout.
        const void* from = host.ints(Layer::bedrock).row(-1) - 1;
        void* to = device.ints(Layer::bedrock).row(-1) - 1;
        ASSERT_TRUE(cuda::copy_to_device(to, from, host.bytes()).ok());
    };
    const auto download = [&] {
        void* to = host.ints(Layer::bedrock).row(-1) - 1;
        const void* from = device.ints(Layer::bedrock).row(-1) - 1;
        const Status copied = cuda::copy_to_host(to, from, host.bytes());
        ASSERT_TRUE(copied.ok()) << copied.error().message;
    };
    upload();
    record_launches(true);
    ASSERT_TRUE(test::run_stencil_cuda({0, 0, k_width, k_height}, pass_over(device)).ok());
    record_launches(false);
    ASSERT_EQ(launch_records().size(), 1u);
    download();
    EXPECT_EQ(bits_of(host), reference());

    fill_heights(host);
    upload();
    constexpr int32_t rows = 29;
    const TilesStencilPass tiles{pass_over(device), rows};
    ASSERT_TRUE(test::run_stencil_tiles_cuda(k_height / rows, {0, 0, k_width, rows}, tiles).ok());
    download();
    EXPECT_EQ(bits_of(host), reference());
#else
    GTEST_SKIP() << "built without a CUDA compiler";
#endif
}

// --- instruction sets
// ----------------------------------------------------------------------------------------------------

TEST(CpuFeatures, AgreeWithTheCompilersOwnAnswer) {
#if defined(__x86_64__)
    const bool v3 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi2") && __builtin_cpu_supports("fma");
    EXPECT_EQ(best_isa() == Isa::v3, v3);
#else
    EXPECT_EQ(best_isa(), Isa::baseline);
#endif
    EXPECT_EQ(set_isa(Isa::baseline), Isa::baseline);
    EXPECT_EQ(isa(), Isa::baseline);
    EXPECT_EQ(set_isa(Isa::v3), best_isa());
}

// A process started with SAHEL_ISA=value exits with 0 if it runs what was expected.
TEST(CpuFeatures, EnvironmentChoosesAtTheFirstQuestion) {
    const char* asked = std::getenv("SAHEL_ISA_CHILD");
    if (asked) { // the child: report through the exit status
        std::exit(name_of(isa()) == asked ? 0 : 9);
    }
    const auto child = [](const std::string& value, std::string_view expected) {
        const std::string command =
            "SAHEL_ISA=" + value + " SAHEL_ISA_CHILD=" + std::string(expected) + " /proc/" + std::to_string(getpid()) +
            "/exe --gtest_filter=CpuFeatures.EnvironmentChoosesAtTheFirstQuestion > /dev/null 2>&1";
        return WEXITSTATUS(std::system(command.c_str()));
    };
    EXPECT_EQ(child("baseline", "baseline"), 0);
    EXPECT_EQ(child("baseline", "v3"), 9); // the child does look
    EXPECT_EQ(child("v3", name_of(best_isa())), 0);
    EXPECT_EQ(child("abacus", name_of(best_isa())), 0);
    EXPECT_EQ(child("", name_of(best_isa())), 0);
}

// Of a function that several objects define the linker keeps one. What an AVX2 object shares with the rest of
// the program would then run, or not run, on a machine without AVX2.
TEST(CpuFeatures, KernelObjectsShareNothingWithTheRestOfTheProgram) {
#if defined(SAHEL_ISA_OBJECT_LIST)
    if (std::system("nm --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "nm is not installed (binutils)";
    FILE* list = std::fopen(SAHEL_ISA_OBJECT_LIST, "r");
    ASSERT_NE(list, nullptr) << SAHEL_ISA_OBJECT_LIST;
    std::array<char, 4096> line{};
    int checked = 0;
    while (std::fgets(line.data(), line.size(), list)) {
        std::string object(line.data(), std::strcspn(line.data(), "\n"));
        if (object.empty() || access(object.c_str(), R_OK) != 0) continue; // of a target that is not built
        FILE* pipe = popen(("nm -C --defined-only '" + object + "'").c_str(), "r");
        ASSERT_NE(pipe, nullptr);
        ++checked;
        while (std::fgets(line.data(), line.size(), pipe)) {
            const std::string symbol = line.data();
            if (symbol.size() < 20) continue;
            const char kind = symbol[17];                            // address, blank, kind, blank, name
            if (kind != 'W' && kind != 'T' && kind != 'i') continue; // not code; constants are the same anyway
            EXPECT_NE(symbol.find("isa_v3"), std::string::npos) << object << " shares " << symbol.substr(19);
        }
        pclose(pipe);
    }
    std::fclose(list);
    EXPECT_GE(checked, 1);
#else
    GTEST_SKIP() << "sanitizer build or not an x86-64 machine";
#endif
}

} // namespace
} // namespace sahel
