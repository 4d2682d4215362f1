#include "world/terrain_streams.h"

#include "world/terrain_lakes.h"
#include "world/terrain_layout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <queue>
#include <tuple>

namespace sahel {

namespace {

/// Beyond this level valleys of streams are lost between cells.
constexpr int32_t k_last_stream_level = 5;

constexpr int k_side = 33; // lattice points around the site
constexpr int k_middle = k_side / 2;
constexpr float k_step_m = 128.0f;
constexpr size_t k_points = static_cast<size_t>(k_side) * k_side;

constexpr float k_seen_m = 64.0f; // as nodes of this spacing see the land: finer shapes turn no stream aside

constexpr float k_furthest_m = 1950.0f;  // from the site: meanders stay within k_stream_far_m
constexpr float k_apart_m = 500.0f;      // nearer to the own site than to another by this much
constexpr float k_lake_water = 1.9f;     // radii up to which a stream has the level of its lake: shores wind,
constexpr float k_lake_water_m = 110.0f; // and so much further: streams do, too
constexpr float k_least_fall = 0.0006f;  // m per m
constexpr float k_most_fall = 0.024f;    // steeper land has no stream
constexpr float k_below_banks_m = 1.2f;  // water under the land
constexpr float k_deepest_cut_m = 12.0f; // of the valley into the land
constexpr float k_highest_fill_m = 2.0f; // of its floor above the land
constexpr float k_shortest_m = 700.0f;   // a way scored lower is none: its length, less what it cuts and fills
constexpr float k_other_way_m = 450.0f;  // between the stream that comes and the one that leaves
constexpr float k_canyon = 0.3f;         // weight from which on a stream does not pass
constexpr float k_from_lake = 1.1f;      // radii from which on cuts and fills count
constexpr float k_flood_step_m = 0.05f;  // a place counts as higher than the one before by this at least
constexpr float k_cost_weight = 60.0f;   // m of length that 1 m of mean cut or fill costs
constexpr float k_rise_weight = 10.0f;   // m of length that 1 m of rise or fall is worth
constexpr float k_piece_m = 24.0f;
constexpr float k_narrowest_m = 2.8f;     // half of the width: nodes are 16 m apart
constexpr float k_dune_as_high_m = 14.0f; // by which dunes count as higher land
constexpr float k_seep_m = 260.0f;        // length of the end on which a stream narrows to nothing

struct Land {
    std::array<float, k_points> height, avoid; // m; avoid: m by which dunes count as higher
    std::array<bool, k_points> open;           // a stream may pass
};

float place_m(int i) {
    return static_cast<float>(i - k_middle) * k_step_m;
}
float from_site_m(int i, int j) {
    return std::sqrt(place_m(i) * place_m(i) + place_m(j) * place_m(j));
}

void read_land(const TerrainTables& t, const TerrainKernels& kernels, const LakeSite& lake, Land& land) {
    constexpr int k_row = (k_side + 7) / 8 * 8;
    std::vector<float> memory(static_cast<size_t>(k_base_rows) * k_row);
    const BaseRow row = base_row_in(memory.data(), k_row);
    constexpr auto k_step_half_m = static_cast<int64_t>(2.0f * k_step_m);
    for (int j = 0; j < k_side; ++j) {
        const SampleRow sample{lake.x_half_m - k_middle * k_step_half_m, lake.y_half_m + (j - k_middle) * k_step_half_m,
                               k_step_half_m, 0};
        kernels.sums(t, sample, k_side, k_seen_m, SumRange{}, row);
        kernels.base(t, sample, k_side, k_seen_m, row);
        const float* dune = row.field[static_cast<int>(NodeField::dune)];
        const float* canyon = row.field[static_cast<int>(NodeField::canyon)];
        for (int i = 0; i < k_side; ++i) {
            const auto at = static_cast<size_t>(j * k_side + i);
            land.height[at] = row.height[i];
            land.avoid[at] = k_dune_as_high_m * dune[i];
            land.open[at] = canyon[i] < k_canyon && from_site_m(i, j) < k_furthest_m;
        }
    }
    const int64_t lattice = 2 * k_lake_lattice_m;
    const int64_t li = floor_div(lake.x_half_m, lattice), lj = floor_div(lake.y_half_m, lattice);
    for (int dj = -1; dj <= 1; ++dj)
        for (int di = -1; di <= 1; ++di) {
            if (di == 0 && dj == 0) continue;
            const auto other = raw_lake_site(t, li + di, lj + dj);
            if (!other) continue;
            const float ox = static_cast<float>(other->x_half_m - lake.x_half_m) * 0.5f;
            const float oy = static_cast<float>(other->y_half_m - lake.y_half_m) * 0.5f;
            for (int j = 0; j < k_side; ++j)
                for (int i = 0; i < k_side; ++i) {
                    const float dx = place_m(i) - ox, dy = place_m(j) - oy;
                    if (std::sqrt(dx * dx + dy * dy) < from_site_m(i, j) + k_apart_m)
                        land.open[static_cast<size_t>(j * k_side + i)] = false;
                }
        }
}

struct Point {
    float x_m, y_m; // from the site
    float level_m;
};

/// Whether a place is less than 60 degrees away from another way as seen from the lake, or anywhere near it.
bool is_taken(const std::vector<Point>& way, const LakeSite& lake, float x, float y) {
    if (way.empty()) return false;
    const Point& end = way.back();
    if (x * end.x_m + y * end.y_m > 0.5f * std::sqrt((x * x + y * y) * (end.x_m * end.x_m + end.y_m * end.y_m)))
        return true;
    return std::any_of(way.begin(), way.end(), [&](const Point& p) {
        const float dx = p.x_m - x, dy = p.y_m - y;
        return p.x_m * p.x_m + p.y_m * p.y_m > lake.radius_m * lake.radius_m &&
               dx * dx + dy * dy < k_other_way_m * k_other_way_m;
    });
}

/// The best way of a stream from the lake (rise = 1: upstream, -1: downstream), or none. `taken`: another way.
std::vector<Point> find_way(const LakeSite& lake, const Land& land, float rise, const std::vector<Point>& taken) {
    struct Place {
        float level_m = 0.0f, length_m = 0.0f, cost = 0.0f;
        int from = -1;
        int di = 0, dj = 0; // the step that led here
        bool seen = false;
    };
    std::array<Place, k_points> places;
    using Entry = std::tuple<float, int>; // height of the way, place
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    constexpr int k_start = k_middle * k_side + k_middle;
    places[k_start].level_m = lake.level_m;
    places[k_start].seen = true;
    queue.emplace(lake.level_m, k_start);
    int best = -1;
    float best_score = k_shortest_m;
    while (!queue.empty()) {
        const auto [height, at] = queue.top();
        queue.pop();
        const int i0 = at % k_side, j0 = at / k_side;
        const Place from = places[static_cast<size_t>(at)];
        for (int dj = -1; dj <= 1; ++dj)
            for (int di = -1; di <= 1; ++di) {
                const int i = i0 + di, j = j0 + dj;
                if (i < 0 || j < 0 || i >= k_side || j >= k_side) continue;
                const int next = j * k_side + i;
                const auto n = static_cast<size_t>(next);
                Place& place = places[n];
                const float away = from_site_m(i, j);
                if (place.seen || !land.open[n] || away <= from_site_m(i0, j0)) continue;
                // Turns of at most 45 degrees at a place.
                const int dot = di * from.di + dj * from.dj;
                const int squares = (di * di + dj * dj) * (from.di * from.di + from.dj * from.dj);
                if (at != k_start && (dot <= 0 || 2 * dot * dot < squares)) continue;
                const float step = k_step_m * (di != 0 && dj != 0 ? 1.4142135f : 1.0f);
                float level = lake.level_m, cost = from.cost;
                if (away > k_lake_water * lake.radius_m + k_lake_water_m) {
                    const float rises = rise * (land.height[n] - k_below_banks_m - from.level_m) / step;
                    level = from.level_m + rise * step * std::clamp(rises, k_least_fall, k_most_fall);
                }
                if (away / lake.radius_m > k_from_lake) {
                    const float cut = land.height[n] - level;
                    if (cut > k_deepest_cut_m || cut < -k_highest_fill_m) continue;
                    if (is_taken(taken, lake, place_m(i), place_m(j))) continue;
                    cost += step * (std::abs(cut - k_below_banks_m) + land.avoid[n]);
                }
                place = {level, from.length_m + step, cost, at, di, dj, true};
                queue.emplace(std::max(height + k_flood_step_m, land.height[n] + land.avoid[n]), next);
                const float outside = place.length_m - k_lake_water * lake.radius_m;
                if (outside < 0.5f * k_shortest_m) continue;
                const float score = place.length_m - k_cost_weight * cost / place.length_m +
                                    k_rise_weight * std::abs(level - lake.level_m);
                if (score > best_score) {
                    best_score = score;
                    best = next;
                }
            }
    }
    std::vector<Point> way;
    for (int at = best; at >= 0; at = places[static_cast<size_t>(at)].from)
        way.push_back({place_m(at % k_side), place_m(at / k_side), places[static_cast<size_t>(at)].level_m});
    std::reverse(way.begin(), way.end());
    return way;
}

/// Points every k_piece_m.
std::vector<Point> resampled(const std::vector<Point>& line) {
    std::vector<Point> out{line.front()};
    float left = k_piece_m;
    for (size_t i = 0; i + 1 < line.size(); ++i) {
        const Point &a = line[i], &b = line[i + 1];
        const float length = std::sqrt((b.x_m - a.x_m) * (b.x_m - a.x_m) + (b.y_m - a.y_m) * (b.y_m - a.y_m));
        for (; left <= length; left += k_piece_m) {
            const float f = left / length;
            out.push_back({mix1(a.x_m, b.x_m, f), mix1(a.y_m, b.y_m, f), mix1(a.level_m, b.level_m, f)});
        }
        left -= length;
    }
    return out;
}

/// Bends of the way become wider than meanders are deep, so that those never cross themselves: a Gaussian of some 100 m
/// by repeated means. The ends stay, and every point its level.
void straighten(std::vector<Point>& line) {
    constexpr int k_times = 40;
    for (int k = 0; k < k_times; ++k) {
        Point before = line.front();
        for (size_t i = 1; i + 1 < line.size(); ++i) {
            const Point here = line[i];
            line[i].x_m = 0.25f * before.x_m + 0.5f * here.x_m + 0.25f * line[i + 1].x_m;
            line[i].y_m = 0.25f * before.y_m + 0.5f * here.y_m + 0.25f * line[i + 1].y_m;
            before = here;
        }
    }
}

/// Moves the line to its sides: bends of two lengths that wander in phase.
std::vector<Point> meandered(const std::vector<Point>& line, const LakeSite& lake, uint32_t hash) {
    const auto turns = [&](int shift) { return static_cast<float>(hash >> shift & 0xFFu) / 256.0f; };
    std::vector<Point> out = line;
    const auto n = static_cast<int>(line.size());
    for (int i = 0; i < n; ++i) {
        const Point& p = line[static_cast<size_t>(i)];
        const Point& a = line[static_cast<size_t>(std::max(i - 3, 0))];
        const Point& b = line[static_cast<size_t>(std::min(i + 3, n - 1))];
        const float tx = b.x_m - a.x_m, ty = b.y_m - a.y_m;
        const float inverse = 1.0f / std::max(std::sqrt(tx * tx + ty * ty), 1.0f);
        const float s = static_cast<float>(i) * k_piece_m;
        const float away = std::sqrt(p.x_m * p.x_m + p.y_m * p.y_m) / lake.radius_m;
        const float wander = 0.25f * sin_turns(s / 780.0f + turns(0));
        const float envelope = sstep(0.9f, 1.5f, away);
        const float side = envelope * (26.0f * sin_turns(s / 205.0f + turns(8) + wander) *
                                           (0.65f + 0.35f * sin_turns(s / 610.0f + turns(16))) +
                                       58.0f * sin_turns(s / 520.0f + turns(24) + wander));
        Point& q = out[static_cast<size_t>(i)];
        q.x_m -= ty * inverse * side;
        q.y_m += tx * inverse * side;
    }
    return out;
}

void append(const std::vector<Point>& line, const LakeSite& lake, float half_m, float narrows, uint32_t hash,
            std::vector<StreamPiece>& pieces) {
    const auto n = static_cast<int>(line.size());
    const float length = static_cast<float>(n - 1) * k_piece_m;
    const auto half_at = [&](int i) {
        const Point& p = line[static_cast<size_t>(i)];
        const float s = static_cast<float>(i) * k_piece_m;
        const float away = std::sqrt(p.x_m * p.x_m + p.y_m * p.y_m) / lake.radius_m;
        const float mouth = 1.0f + 0.8f * sstep(1.35f, 0.95f, away);
        const float pools = 1.0f + 0.32f * sin_turns(s / 370.0f + static_cast<float>(hash & 0xFFu) / 256.0f) +
                            0.2f * sin_turns(s / 149.0f + static_cast<float>(hash >> 8 & 0xFFu) / 256.0f);
        return std::max(half_m * mouth * pools * mix1(1.0f, narrows, s / length), k_narrowest_m) *
               clamp01((length - s) / k_seep_m);
    };
    for (int i = 0; i + 1 < n; ++i) {
        const Point &a = line[static_cast<size_t>(i)], &b = line[static_cast<size_t>(i + 1)];
        StreamPiece piece;
        piece.x_half_m = lake.x_half_m + static_cast<int64_t>(std::floor(2.0f * a.x_m));
        piece.y_half_m = lake.y_half_m + static_cast<int64_t>(std::floor(2.0f * a.y_m));
        piece.dx_m = 0.5f * (std::floor(2.0f * b.x_m) - std::floor(2.0f * a.x_m));
        piece.dy_m = 0.5f * (std::floor(2.0f * b.y_m) - std::floor(2.0f * a.y_m));
        piece.half_m = half_at(i);
        piece.half_end_m = half_at(i + 1);
        piece.level_m = a.level_m;
        piece.level_end_m = b.level_m;
        pieces.push_back(piece);
    }
}

} // namespace

bool has_streams(const TerrainTables& t, int32_t level) {
    return t.p.stream_m > 0.0f && t.p.sea == 0 && t.p.lake_probability > 0.0f && level <= k_last_stream_level;
}

void plan_streams(const TerrainTables& t, const TerrainKernels& kernels, const LakeSite& lake,
                  std::vector<StreamPiece>& pieces) {
    Land land;
    read_land(t, kernels, lake, land);
    const float half_m = 0.5f * t.p.stream_m * (0.55f + 0.45f * lake.radius_m / t.p.lake_radius_m);
    const uint32_t hash = node_hash(column_hash(static_cast<uint32_t>(lake.x_half_m), t.lake_salt + 1u),
                                    static_cast<uint32_t>(lake.y_half_m));
    const auto add = [&](const std::vector<Point>& way, float half, float narrows, uint32_t bends) {
        if (way.size() < 4) return;
        std::vector<Point> line = resampled(way);
        straighten(line);
        append(resampled(meandered(line, lake, bends)), lake, half, narrows, lowbias32(bends), pieces);
    };
    const std::vector<Point> inflow = find_way(lake, land, 1.0f, {});
    add(inflow, half_m, 0.55f, lowbias32(hash));
    // Some lakes have an outlet; the others lose their water to the air.
    if (inflow.empty() || (hash & 3u) == 0) return;
    add(find_way(lake, land, -1.0f, inflow), 0.85f * half_m, 0.7f, lowbias32(hash + 1u));
}

bool reaches(const StreamPiece& p, int64_t x0, int64_t y0, int64_t x1, int64_t y1) {
    constexpr auto k_reach = static_cast<int64_t>(2.0f * k_stream_reach_m) + 1;
    const auto dx = static_cast<int64_t>(2.0f * p.dx_m), dy = static_cast<int64_t>(2.0f * p.dy_m);
    return p.x_half_m + std::max<int64_t>(dx, 0) + k_reach >= x0 &&
           p.x_half_m + std::min<int64_t>(dx, 0) - k_reach <= x1 &&
           p.y_half_m + std::max<int64_t>(dy, 0) + k_reach >= y0 &&
           p.y_half_m + std::min<int64_t>(dy, 0) - k_reach <= y1;
}

void find_streams_near(const TerrainTables& t, const TerrainKernels& kernels, int32_t level, const CellRect& rect,
                       const std::vector<LakeSite>& lakes, std::vector<StreamPiece>& pieces) {
    pieces.clear();
    if (!has_streams(t, level)) return;
    const CellRect reach = node_reach_half_m(rect, level);
    std::vector<StreamPiece> planned;
    for (const LakeSite& lake : lakes) {
        if (!reach.grown(k_stream_site_half_m).contains(Cell{lake.x_half_m, lake.y_half_m})) continue;
        planned.clear();
        plan_streams(t, kernels, lake, planned);
        for (const StreamPiece& piece : planned)
            if (reaches(piece, reach.x0, reach.y0, reach.x1, reach.y1)) pieces.push_back(piece);
    }
}

} // namespace sahel
