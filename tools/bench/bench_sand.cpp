#include "sim/aeolian.h"
#include "sim/sand_passes.h"
#include "sim/step_plan.h"
#include "tools/bench/bench_cases.h"
#include "world/cuda_runtime.h"
#include "world/executor.h"
#include "world/field.h"
#include "world/random.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace sahel::tools {

namespace {

// Scenes A (barchans) and B (transverse dunes) of the Desertscape paper, 1024 m wide, as the paper ran them: forward
// saltation, no projection, so many sweeps of avalanching at each resolution.
struct Scene {
    const char* name;
    float thin_m, more_m; ///< sand: thin + more * uniform
    float wind_m_per_s;
};
constexpr Scene k_scenes[] = {{"A", 0.5f, 1.5f, 5.0f}, {"B", 3.0f, 2.0f, 3.0f}};
constexpr int k_warm_steps = 4;
constexpr int k_steps = 6;

Aeolian::Desc desc_of(const Scene& scene, int32_t n) {
    Aeolian::Desc d;
    d.cell_m = 1024.0 / n;
    d.wind.speed_m_per_s = scene.wind_m_per_s;
    d.wind.venturi_radius_m = 0.0f;
    d.wind.project = false;
    const bool a = scene.name[0] == 'A';
    d.sand.avalanche_sweeps = n <= 512 ? (a ? 13 : 15) : n <= 1024 ? (a ? 25 : 31) : (a ? 50 : 62);
    d.sand.reptation_smooth = a && n <= 512 ? 0.0f : 1.0f;
    d.sand.soil_sweeps = 0; // there is no soil
    return d;
}

Result<TileDomain> make(const Scene& scene, const Aeolian::Desc& desc, int32_t n, MemoryPool& pool) {
    const int32_t halo = std::max(16, Aeolian::least_halo(desc));
    SAHEL_ASSIGN(TileDomain domain, TileDomain::create(TileLayout::rectangle(n, halo, 1, 1, Border::periodic),
                                                       Aeolian::layers(desc), pool));
    for (const SimLayer l : {SimLayer::bedrock, SimLayer::soil, SimLayer::water, SimLayer::moisture,
                             SimLayer::airborne_sand, SimLayer::object})
        SAHEL_TRY(domain.fill(l, [](int64_t, int64_t) { return 0; }));
    for (const SimLayer l : {SimLayer::vegetation, SimLayer::resistance})
        SAHEL_TRY(domain.fill(l, [](int64_t, int64_t) { return 0.0f; }));
    const RandomStream random(1, 0, Purpose::test);
    SAHEL_TRY(domain.fill(SimLayer::sand, [&](int64_t x, int64_t y) {
        return ticks_of_metres(scene.thin_m + scene.more_m * uniform(random.at(x, y).v[0]));
    }));
    return domain;
}

// What one run of a scene gives; its cases share it.
struct Profile {
    std::string error;
    std::string hash;
    double step_ms = 1e30;
    double swept = 1.0; ///< share of the cells that the avalanches of the last step worked out
    std::map<std::string, std::pair<double, double>> passes; ///< fastest ms of one launch; launches in a step
};

Profile profile(const Scene& scene, int32_t n, MemoryPool& pool) {
    Profile p;
    const auto failed = [&](const Error& error) {
        p.error = error.message;
        return p;
    };
    const Aeolian::Desc desc = desc_of(scene, n);
    const bool device = pool.kind() == MemoryKind::cuda;
    auto domain = make(scene, desc, n, pool);
    if (!domain.ok()) return failed(domain.error());
    auto aeolian = Aeolian::create(desc, *domain);
    if (!aeolian.ok()) return failed(aeolian.error());
    for (int64_t step = 0; step < k_warm_steps + k_steps; ++step) {
        record_launches(step >= k_warm_steps && !device);
        clear_launch_records();
        const auto start = std::chrono::steady_clock::now();
        Status ran = aeolian->step(*domain, step);
        if (ran.ok() && device) ran = cuda::synchronize();
        const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
        record_launches(false);
        if (!ran.ok()) return failed(ran.error());
        if (step < k_warm_steps) continue;
        p.step_ms = std::min(p.step_ms, took.count());
        p.swept = aeolian->stats().sand.swept();
        for (const LaunchRecord& r : launch_records()) {
            auto& [ms, launches] = p.passes.try_emplace(r.name, 1e30, 0.0).first->second;
            ms = std::min(ms, r.ms / static_cast<double>(r.launches));
            launches = std::max(launches, static_cast<double>(r.launches));
        }
    }
    const auto hash = domain->hash({SimLayer::bedrock, SimLayer::sand, SimLayer::airborne_sand});
    if (!hash.ok()) return failed(hash.error());
    p.hash = hash->substr(0, 12);
    return p;
}

using Shared = std::shared_ptr<Profile>;

const Profile& shared(const Shared& kept, const Scene& scene, int32_t n) {
    if (kept->hash.empty() && kept->error.empty()) *kept = profile(scene, n, MemoryPool::host());
    return *kept;
}

void report(benchmark::State& state, const Profile& p, double ms, double cells, double bytes, double gb_per_s,
            const std::string& label) {
    if (!p.error.empty()) return state.SkipWithError(p.error.c_str());
    if (!(ms < 1e30)) return state.SkipWithError("did not run");
    for (auto _ : state) state.SetIterationTime(ms * 1e-3);
    set_rates(state, cells, bytes, gb_per_s);
    state.SetLabel(label);
}

void add(const std::string& name, const std::function<void(benchmark::State&)>& f) {
    benchmark::RegisterBenchmark(name.c_str(), f)->Unit(benchmark::kMillisecond)->UseManualTime()->Iterations(1);
}

} // namespace

void add_sand_benchmarks(const BenchOptions& o) {
    for (const Scene& scene : k_scenes)
        for (const int32_t n : {512, 1024, 2048}) {
            const std::string group = fmt::format("sand/{}/{}", scene.name, n);
            const double cells = static_cast<double>(n) * n;
            const double rate = o.machine.all_cores_gb_per_s;
            const Aeolian::Desc desc = desc_of(scene, n);
            const auto kept = std::make_shared<Profile>();
            const HopWay way = HopWay::of(desc.sand, desc.cell_m, scene.wind_m_per_s);
            std::vector<PassDecl> decls{ground_pass().decl, wind_shadow_pass(desc.sand, desc.cell_m).decl,
                                        lift_pass(desc.sand, {}).decl, hop_leg_pass(desc.sand, way, 0).decl,
                                        deposit_pass(desc.sand, desc.cell_m, {}, way.legs).decl};
            if (desc.sand.reptation_smooth > 0.0f) {
                decls.push_back(smooth_pass(desc.sand, desc.cell_m, 1.0f).decl);
                decls.push_back(apply_smooth_pass().decl);
            }
            decls.push_back(repose_pass(desc.sand).decl);
            for (const PassDecl& d : decls) {
                const std::string pass(d.name);
                const double bytes = cells * d.least_bytes;
                add(fmt::format("{}/{}", group, pass.substr(pass.find('/') + 1)), [=](benchmark::State& s) {
                    const Profile& p = shared(kept, scene, n);
                    const auto found = p.passes.find(pass);
                    const double ms = found == p.passes.end() ? 1e30 : found->second.first;
                    report(s, p, ms, cells, bytes, rate, p.hash);
                });
            }
            // All of these in one step, each as often as the step runs it, by their own fastest times.
            add(group + "/all_but_slides", [=](benchmark::State& s) {
                const Profile& p = shared(kept, scene, n);
                double ms = 0.0;
                double bytes = 0.0;
                for (const PassDecl& d : decls) {
                    const auto found = p.passes.find(std::string(d.name));
                    if (found == p.passes.end()) continue;
                    ms += found->second.first * found->second.second;
                    bytes += cells * d.least_bytes * found->second.second;
                }
                report(s, p, ms > 0.0 ? ms : 1e30, cells, bytes, rate, p.hash);
            });
            add(group + "/step", [=](benchmark::State& s) {
                const Profile& p = shared(kept, scene, n);
                report(s, p, p.step_ms, cells, 0.0, 0.0, p.hash);
                s.counters["swept"] = p.swept;
            });
            if (!cuda::available()) continue;
            add(fmt::format("sand_cuda/{}/{}/step", scene.name, n), [=](benchmark::State& s) {
                MemoryPool pool("bench", MemoryKind::cuda, uint64_t{4} << 30);
                const Profile p = profile(scene, n, pool);
                if (p.error.empty() && p.hash != shared(kept, scene, n).hash)
                    return s.SkipWithError("CPU and CUDA give different bits");
                report(s, p, p.step_ms, cells, 0.0, 0.0, p.hash + " = CPU");
            });
        }
}

} // namespace sahel::tools
