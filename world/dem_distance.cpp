#include "world/dem_distance.h"

#include <cmath>
#include <limits>
#include <vector>

namespace sahel {

namespace {

/// d[x] = min over x' of sqrt((x - x')^2 + g[x']^2).
struct RowEnvelope {
    std::vector<int64_t> vertex;
    std::vector<double> from;

    void operator()(const std::vector<float>& g, std::vector<float>& d) {
        const auto n = static_cast<int64_t>(g.size());
        vertex.clear();
        from.clear();
        const auto value = [&](int64_t q) {
            const auto v = static_cast<double>(g[static_cast<size_t>(q)]);
            return v * v + static_cast<double>(q) * static_cast<double>(q);
        };
        for (int64_t q = 0; q < n; ++q) {
            if (std::isinf(g[static_cast<size_t>(q)])) continue;
            double s = -std::numeric_limits<double>::infinity();
            while (!vertex.empty()) {
                s = (value(q) - value(vertex.back())) / (2.0 * static_cast<double>(q - vertex.back()));
                if (s > from.back()) break;
                vertex.pop_back();
                from.pop_back();
            }
            if (vertex.empty()) s = -std::numeric_limits<double>::infinity();
            vertex.push_back(q);
            from.push_back(s);
        }
        if (vertex.empty()) {
            std::fill(d.begin(), d.end(), std::numeric_limits<float>::infinity());
            return;
        }
        size_t k = 0;
        for (int64_t x = 0; x < n; ++x) {
            while (k + 1 < vertex.size() && from[k + 1] < static_cast<double>(x)) ++k;
            const double dx = static_cast<double>(x - vertex[k]),
                         dy = static_cast<double>(g[static_cast<size_t>(vertex[k])]);
            d[static_cast<size_t>(x)] = static_cast<float>(std::sqrt(dx * dx + dy * dy));
        }
    }
};

} // namespace

Result<ScratchRaster<float>> distance_to(const ScratchRaster<DemMask>& mask,
                                         const std::function<bool(DemMask)>& is_target,
                                         const std::filesystem::path& scratch) {
    const int64_t width = mask.width(), height = mask.height();
    SAHEL_ASSIGN(auto distance, ScratchRaster<float>::create(scratch, width, height));
    const auto columns = static_cast<size_t>(width);
    std::vector<DemMask> bits(columns);
    std::vector<float> along(columns, std::numeric_limits<float>::infinity()), row(columns), out(columns);
    std::array<bool, 256> target{};
    for (size_t i = 0; i < target.size(); ++i) target[i] = is_target(static_cast<DemMask>(i));
    for (int64_t y = 0; y < height; ++y) {
        SAHEL_TRY(mask.read_row(y, bits.data()));
        for (size_t x = 0; x < columns; ++x) along[x] = target[bits[x]] ? 0.0f : along[x] + 1.0f;
        SAHEL_TRY(distance.write_row(y, along.data()));
    }
    std::fill(along.begin(), along.end(), std::numeric_limits<float>::infinity());
    RowEnvelope envelope;
    for (int64_t y = height - 1; y >= 0; --y) {
        SAHEL_TRY(distance.read_row(y, row.data()));
        for (size_t x = 0; x < columns; ++x) along[x] = std::min(row[x], along[x] + 1.0f);
        envelope(along, out);
        SAHEL_TRY(distance.write_row(y, out.data()));
    }
    return distance;
}

} // namespace sahel
