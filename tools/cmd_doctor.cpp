#include "render/gl_context.h"
#include "render/video_writer.h"
#include "tools/command.h"
#include "world/bandwidth.h"
#include "world/cpu_features.h"
#include "world/cuda_runtime.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <gdal.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>
#include <meshoptimizer.h>
#include <oneapi/tbb/version.h>
#include <OpenEXRConfig.h>
#include <png.h>
#include <sqlite3.h>

#include <cstdlib>
#include <memory>

namespace sahel::tools {

namespace {

#if defined(__clang__)
constexpr const char* k_compiler = "clang";
#else
constexpr const char* k_compiler = "g++";
#endif

int run(bool json) {
    nlohmann::ordered_json report;
    std::vector<std::string> hints;
    const CpuInfo cpu = cpu_info();
    report["sahel"] = fmt::format("{}, {} build by {} {}", SAHEL_VERSION, SAHEL_BUILD_TYPE, k_compiler, __VERSION__);
    report["processor"] = fmt::format("{}, {} cores, {} memory", cpu.name, cpu.cores, human_bytes(cpu.memory_bytes));
    report["kernels"] = isa() == Isa::v3 ? "x86-64-v3 (AVX2)" : "baseline";
    if (isa() != Isa::v3) hints.emplace_back("a processor with AVX2 runs the kernels about twice as fast");
    if (const auto one = measure_memory_bandwidth(1); one.ok())
        report["bandwidth_1_core"] = fmt::format("{:.1f} GB/s", one->gb_per_s);
    if (const auto all = measure_memory_bandwidth(); all.ok())
        report["bandwidth_all_cores"] = fmt::format("{:.1f} GB/s on {} threads", all->gb_per_s, all->threads);

    const cuda::DeviceStatus& gpu = cuda::status();
    if (gpu.device_count > 0) {
        report["cuda"] = fmt::format("{}, {}, runtime {}.{}", gpu.name, human_bytes(gpu.memory_bytes),
                                     gpu.runtime_version / 1000, gpu.runtime_version % 1000 / 10);
        if (const auto b = measure_cuda_bandwidth(); b.ok())
            report["cuda_bandwidth"] = fmt::format("{:.0f} GB/s", b->gb_per_s);
    } else {
        report["cuda"] = fmt::format("runs on the CPU: {}", gpu.why_not);
        hints.emplace_back(gpu.built
                               ? "an NVIDIA driver and card would run the simulation on the GPU"
                               : "a CUDA toolkit at build time and an NVIDIA card would run the simulation on the GPU");
    }
    if (auto gl = GlContext::headless(); gl.ok()) {
        const GlInfo& info = (*gl)->info();
        report["opengl"] = fmt::format("{}, {} ({})", info.version, info.renderer, info.platform);
        if (info.software())
            hints.emplace_back("a GPU driver would draw some hundred times faster than this software renderer");
    } else {
        report["opengl"] = gl.error().message;
        hints.emplace_back(
            "OpenGL 4.5 (packages libegl-mesa0 and libgl1-mesa-dri at least) would let fly and demo draw");
    }
    const bool display = std::getenv("DISPLAY") || std::getenv("WAYLAND_DISPLAY");
    report["display"] = display ? "yes" : "none: fly --headless";
    if (!display) hints.emplace_back("a display would let fly open its window");
    const auto ffmpeg = find_program("ffmpeg");
    report["ffmpeg"] = ffmpeg.empty() ? "not found" : ffmpeg.string();
    if (ffmpeg.empty())
        hints.emplace_back("ffmpeg would let fly and demo write MP4 files instead of folders of pictures");
    report["libraries"] = fmt::format(
        "OpenEXR {}, GDAL {}, SQLite {}, oneTBB {}.{}, libpng {}, GLFW {}.{}, Dear ImGui {}, meshoptimizer {}.{}, "
        "nlohmann-json {}.{}.{}, CLI11 {}, fmt {}.{}",
        OPENEXR_VERSION_STRING, GDALVersionInfo("RELEASE_NAME"), sqlite3_libversion(), TBB_VERSION_MAJOR,
        TBB_VERSION_MINOR, png_get_libpng_ver(nullptr), GLFW_VERSION_MAJOR, GLFW_VERSION_MINOR, IMGUI_VERSION,
        MESHOPTIMIZER_VERSION / 1000, MESHOPTIMIZER_VERSION % 1000 / 10, NLOHMANN_JSON_VERSION_MAJOR,
        NLOHMANN_JSON_VERSION_MINOR, NLOHMANN_JSON_VERSION_PATCH, CLI11_VERSION, FMT_VERSION / 10000,
        FMT_VERSION % 10000 / 100);
    if (json) {
        report["hints"] = hints;
        print_report(report, true);
        return 0;
    }
    print_report(report, false);
    for (const std::string& hint : hints) fmt::print("- {}\n", hint);
    return 0;
}

} // namespace

void add_doctor_command(CommandLine& line) {
    auto json = std::make_shared<bool>(false);
    CLI::App& app = line.add("doctor", "What this machine has, and what each missing piece would enable",
                             [=] { return run(*json); });
    app.add_flag("--json", *json, "Report as JSON");
}

} // namespace sahel::tools
