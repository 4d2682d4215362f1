#include "world/dem_mosaic.h"

#include "world/dem_gdal.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace sahel {

namespace fs = std::filesystem;

namespace {

constexpr size_t k_open_files = 64;     // handles kept; more files are opened and closed as needed
constexpr int64_t k_node_cells = 8;     // spacing of exact projections; between them bilinear (error below cell / 1000)
constexpr double k_same_lattice = 1e-3; // samples
constexpr double k_max_span_degrees = 9; // beyond it a UTM zone stretches lengths by more than 0.2 %

using Transform = std::array<double, 6>;
using CrsTransform = std::unique_ptr<OGRCoordinateTransformation>;

Transform inverse(const Transform& t) {
    const double det = t[1] * t[5] - t[2] * t[4];
    const double a = t[5] / det, b = -t[2] / det, c = -t[4] / det, d = t[1] / det;
    return {-(a * t[0] + b * t[3]), a, b, -(c * t[0] + d * t[3]), c, d};
}

bool same_crs(const std::string& a, const std::string& b) {
    if (a == b) return true;
    OGRSpatialReference crs_a, crs_b;
    return gdal_crs(a, crs_a) && gdal_crs(b, crs_b) && crs_a.IsSame(&crs_b);
}

/// Two decimal places of the leading digits that people would choose.
double round_cell(double cell) {
    const double decade = std::pow(10.0, std::floor(std::log10(cell)));
    double best = decade;
    for (const double digit : {1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0})
        if (std::abs(digit * decade - cell) < std::abs(best - cell)) best = digit * decade;
    return best;
}

struct Bounds {
    double x0 = 1e300, y0 = 1e300, x1 = -1e300, y1 = -1e300;
    void add(double x, double y) {
        x0 = std::min(x0, x);
        y0 = std::min(y0, y);
        x1 = std::max(x1, x);
        y1 = std::max(y1, y);
    }
};

} // namespace

struct DemMosaic::Sheet {
    struct Member {
        size_t file;
        CellRect place; ///< samples of the sheet
    };
    std::string wkt;
    Transform transform{};
    Transform to_sample{};
    int64_t width = 0, height = 0;
    std::vector<Member> members;
    CrsTransform from_target; ///< null: the same coordinate system
    double filter_x = 1.0, filter_y = 1.0;

    [[nodiscard]] double cell_area() const {
        return std::abs(transform[1] * transform[5] - transform[2] * transform[4]);
    }

    /// Points all along the edge, in the sheet's own coordinates.
    void edge(std::vector<double>& x, std::vector<double>& y) const {
        constexpr int k_steps = 32;
        const auto add = [&](double col, double row) {
            x.push_back(transform[0] + col * transform[1] + row * transform[2]);
            y.push_back(transform[3] + col * transform[4] + row * transform[5]);
        };
        for (int i = 0; i <= k_steps; ++i) {
            const double f = static_cast<double>(i) / k_steps;
            const auto w = static_cast<double>(width), h = static_cast<double>(height);
            add(f * w, 0);
            add(f * w, h);
            add(0, f * h);
            add(w, f * h);
        }
    }
};

DemMosaic::DemMosaic() = default;
DemMosaic::DemMosaic(DemMosaic&&) noexcept = default;
DemMosaic& DemMosaic::operator=(DemMosaic&&) noexcept = default;
DemMosaic::~DemMosaic() = default;

size_t DemMosaic::sheet_count() const {
    return sheets_.size();
}
int64_t DemMosaic::sheet_width(size_t sheet) const {
    return sheets_[sheet].width;
}
int64_t DemMosaic::sheet_height(size_t sheet) const {
    return sheets_[sheet].height;
}
double DemMosaic::filter_x(size_t sheet) const {
    return sheets_[sheet].filter_x;
}
double DemMosaic::filter_y(size_t sheet) const {
    return sheets_[sheet].filter_y;
}

bool DemMosaic::straight(size_t sheet) const {
    const Sheet& s = sheets_[sheet];
    return !s.from_target && s.transform[2] == 0.0 && s.transform[4] == 0.0;
}

Result<DemMosaic> DemMosaic::open(std::span<const fs::path> files, const DemSourceOptions& options, double cell_m) {
    if (files.empty()) return Error{ErrorKind::usage, "no elevation file was named"};
    DemMosaic mosaic;
    for (const fs::path& file : files) {
        SAHEL_ASSIGN(auto source, open_dem(file, options));
        if (files.size() > k_open_files) source->close();
        const DemSourceInfo& info = source->info();
        if (files.size() > 1 && !info.placed)
            return Error{
                ErrorKind::usage,
                fmt::format("{} does not say where it lies, so it cannot be joined with other files", file.string())};
        mosaic.sources_.push_back(std::move(source));
    }
    SAHEL_TRY(mosaic.join_sheets());
    SAHEL_TRY(mosaic.choose_target(cell_m));
    return mosaic;
}

Status DemMosaic::join_sheets() {
    for (size_t i = 0; i < sources_.size(); ++i) {
        const DemSourceInfo& info = sources_[i]->info();
        if (info.projection_wkt.empty() != sources_[0]->info().projection_wkt.empty())
            return Error{
                ErrorKind::usage,
                fmt::format("{} names a coordinate system and {} does not: name the missing one (--crs EPSG:...)",
                            sources_[info.projection_wkt.empty() ? 0 : i]->info().path.string(),
                            sources_[info.projection_wkt.empty() ? i : 0]->info().path.string())};
        const Transform& t = info.transform;
        bool joined = false;
        for (Sheet& sheet : sheets_) {
            const Transform& s = sheet.transform;
            const double tolerance = k_same_lattice / static_cast<double>(std::max(info.width, info.height));
            bool same = true;
            for (const int k : {1, 2, 4, 5})
                same = same && std::abs(t[k] - s[k]) <= tolerance * std::sqrt(sheet.cell_area());
            if (!same) continue;
            const Transform inv = inverse(s);
            const double col = inv[0] + t[0] * inv[1] + t[3] * inv[2];
            const double row = inv[3] + t[0] * inv[4] + t[3] * inv[5];
            if (std::abs(col - std::round(col)) > k_same_lattice || std::abs(row - std::round(row)) > k_same_lattice)
                continue;
            if (!same_crs(sheet.wkt, info.projection_wkt)) continue;
            const auto c = static_cast<int64_t>(std::round(col)), r = static_cast<int64_t>(std::round(row));
            sheet.members.push_back({i, {c, r, c + info.width, r + info.height}});
            joined = true;
            break;
        }
        if (joined) continue;
        Sheet sheet;
        sheet.wkt = info.projection_wkt;
        sheet.transform = t;
        sheet.members.push_back({i, {0, 0, info.width, info.height}});
        sheets_.push_back(std::move(sheet));
    }
    for (Sheet& sheet : sheets_) { // shift each so that its north-west sample is (0, 0)
        CellRect all = sheet.members[0].place;
        for (const auto& m : sheet.members)
            all = {std::min(all.x0, m.place.x0), std::min(all.y0, m.place.y0), std::max(all.x1, m.place.x1),
                   std::max(all.y1, m.place.y1)};
        const auto c = static_cast<double>(all.x0), r = static_cast<double>(all.y0);
        Transform& t = sheet.transform;
        t[0] += c * t[1] + r * t[2];
        t[3] += c * t[4] + r * t[5];
        for (auto& m : sheet.members)
            m.place = {m.place.x0 - all.x0, m.place.y0 - all.y0, m.place.x1 - all.x0, m.place.y1 - all.y0};
        sheet.width = all.width();
        sheet.height = all.height();
        sheet.to_sample = inverse(t);
    }
    return {};
}

Status DemMosaic::choose_target(double cell_m) {
    GdalScope scope;
    const std::string& first_wkt = sources_[0]->info().projection_wkt;
    OGRSpatialReference crs;
    const bool has_crs = !first_wkt.empty();
    if (has_crs && !gdal_crs(first_wkt, crs))
        return Error{ErrorKind::corrupt, fmt::format("{}: its coordinate system is not understood: {}",
                                                     sources_[0]->info().path.string(), scope.message("unknown"))};
    const bool degrees = has_crs && crs.IsGeographic();
    OGRSpatialReference target = crs;
    if (degrees) {
        Bounds b;
        for (const Sheet& sheet : sheets_) {
            std::vector<double> x, y;
            sheet.edge(x, y);
            OGRSpatialReference own;
            if (!gdal_crs(sheet.wkt, own)) continue;
            const CrsTransform to_degrees(OGRCreateCoordinateTransformation(&own, &crs));
            if (to_degrees) to_degrees->Transform(static_cast<int>(x.size()), x.data(), y.data());
            for (size_t i = 0; i < x.size(); ++i)
                if (std::isfinite(x[i]) && std::isfinite(y[i])) b.add(x[i], y[i]);
        }
        if (!(b.x0 >= -360.0 && b.x1 <= 360.0 && b.y0 >= -91.0 && b.y1 <= 91.0))
            return Error{ErrorKind::corrupt, fmt::format("{}: its degrees reach from ({}, {}) to ({}, {})",
                                                         sources_[0]->info().path.string(), b.x0, b.y0, b.x1, b.y1)};
        const double lon = 0.5 * (b.x0 + b.x1), lat = 0.5 * (b.y0 + b.y1);
        if (b.x1 - b.x0 > 60.0 || b.y1 - b.y0 > 60.0)
            return Error{ErrorKind::usage,
                         fmt::format("{:.0f} x {:.0f} degrees are too much for one flat map: import a part, "
                                     "or reproject it first",
                                     b.x1 - b.x0, b.y1 - b.y0)};
        target = OGRSpatialReference();
        target.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
        target.CopyGeogCSFrom(&crs);
        if (b.x1 - b.x0 <= k_max_span_degrees && std::abs(lat) <= 80.0) {
            const int zone =
                std::clamp(static_cast<int>(std::floor((std::remainder(lon, 360.0) + 180.0) / 6.0)) + 1, 1, 60);
            const char* datum = crs.GetName();
            target.SetProjCS(
                fmt::format("{} / UTM zone {}{}", datum ? datum : "unknown", zone, lat >= 0.0 ? 'N' : 'S').c_str());
            target.SetUTM(zone, lat >= 0.0);
        } else {
            target.SetProjCS(fmt::format("Lambert azimuthal equal area about {:.4f}, {:.4f}", lon, lat).c_str());
            target.SetLAEA(lat, lon, 0.0, 0.0);
        }
    }
    if (has_crs && !degrees) {
        const char* method = target.GetAttrValue("PROJECTION");
        if (method && std::string(method).find("Mercator_") == 0)
            notes_.emplace_back("the projection is a Mercator map: lengths are stretched away from the equator");
    }
    double unit_m = 1.0;
    if (has_crs) {
        unit_m = target.GetLinearUnits();
        target_.projection_name = target.GetName() ? target.GetName() : "";
        char* wkt = nullptr;
        const char* how[] = {"FORMAT=WKT2_2019", nullptr};
        if (target.exportToWkt(&wkt, how) == OGRERR_NONE && wkt) target_.projection_wkt = wkt;
        CPLFree(wkt);
        if (!(unit_m > 0.0) || target_.projection_wkt.empty())
            return Error{ErrorKind::corrupt, fmt::format("no flat map can be made of the coordinate system: {}",
                                                         scope.message("unknown reason"))};
    }

    Bounds bounds;
    double finest = 1e300;
    size_t finest_sheet = 0;
    std::vector<double> native(sheets_.size());
    for (size_t i = 0; i < sheets_.size(); ++i) {
        Sheet& sheet = sheets_[i];
        std::vector<double> x, y;
        sheet.edge(x, y);
        // The middle cell's corners, too: how large a sample is on the target map.
        const auto w = static_cast<double>(sheet.width / 2), h = static_cast<double>(sheet.height / 2);
        const Transform& t = sheet.transform;
        for (const auto& [c, r] : {std::pair{w, h}, std::pair{w + 1, h}, std::pair{w, h + 1}}) {
            x.push_back(t[0] + c * t[1] + r * t[2]);
            y.push_back(t[3] + c * t[4] + r * t[5]);
        }
        if (has_crs && (degrees || !same_crs(sheet.wkt, first_wkt))) {
            OGRSpatialReference own;
            if (gdal_crs(sheet.wkt, own)) {
                const CrsTransform to_target(OGRCreateCoordinateTransformation(&own, &target));
                if (to_target) to_target->Transform(static_cast<int>(x.size()), x.data(), y.data());
                sheet.from_target.reset(OGRCreateCoordinateTransformation(&target, &own));
            }
            if (!sheet.from_target)
                return Error{ErrorKind::usage, fmt::format("{}: no way from its coordinate system to '{}': {}",
                                                           sources_[sheet.members[0].file]->info().path.string(),
                                                           target_.projection_name, scope.message("unknown reason"))};
        }
        const size_t n = x.size() - 3;
        for (size_t k = 0; k < n; ++k)
            if (std::isfinite(x[k]) && std::isfinite(y[k])) bounds.add(x[k], y[k]);
        const double ax = x[n + 1] - x[n], ay = y[n + 1] - y[n], bx = x[n + 2] - x[n], by = y[n + 2] - y[n];
        native[i] = std::sqrt(std::abs(ax * by - ay * bx));
        if (native[i] < finest) {
            finest = native[i];
            finest_sheet = i;
        }
    }
    if (!(bounds.x0 < bounds.x1 && bounds.y0 < bounds.y1) || !(finest > 0.0 && finest < 1e12))
        return Error{ErrorKind::corrupt,
                     fmt::format("{}: its georeference gives no area", sources_[0]->info().path.string())};

    const Sheet& lead = sheets_[finest_sheet];
    const Transform& t = lead.transform;
    const bool upright =
        !lead.from_target && t[2] == 0.0 && t[4] == 0.0 && std::abs(std::abs(t[1]) - std::abs(t[5])) <= 1e-6 * finest;
    if (cell_m > 0.0)
        target_.step = cell_m / unit_m;
    else
        target_.step = upright ? std::abs(t[1]) : round_cell(finest * unit_m) / unit_m;
    const double step = target_.step;
    target_.cell_m = step * unit_m;
    target_.origin_x = bounds.x0;
    target_.origin_y = bounds.y1;
    if (lead.from_target) { // whole multiples, so that neighbouring imports fit together
        target_.origin_x = std::floor(bounds.x0 / step) * step;
        target_.origin_y = std::ceil(bounds.y1 / step) * step;
    } else if (upright && std::abs(step - std::abs(t[1])) <= 1e-9 * step) { // on the lattice of the file
        target_.origin_x = t[0] + std::floor((bounds.x0 - t[0]) / step + 1e-6) * step;
        target_.origin_y = t[3] + std::ceil((bounds.y1 - t[3]) / step - 1e-6) * step;
    }
    const double cells_x = (bounds.x1 - target_.origin_x) / step, cells_y = (target_.origin_y - bounds.y0) / step;
    if (!(cells_x < 1e12 && cells_y < 1e12))
        return Error{ErrorKind::usage, fmt::format("{:.3g} x {:.3g} cells of {} m are too many: give a larger --cell",
                                                   cells_x, cells_y, target_.cell_m)};
    target_.width = std::max<int64_t>(1, std::llround(cells_x));
    target_.height = std::max<int64_t>(1, std::llround(cells_y));

    for (Sheet& sheet : sheets_) {
        const double ratio_x = std::hypot(sheet.transform[1], sheet.transform[4]);
        const double ratio_y = std::hypot(sheet.transform[2], sheet.transform[5]);
        const size_t i = static_cast<size_t>(&sheet - sheets_.data());
        // Side of a sample along its column and row axes, in target units: the area is right, the shape as stored.
        double side_x = native[i] * std::sqrt(ratio_x / ratio_y), side_y = native[i] * std::sqrt(ratio_y / ratio_x);
        if (sheet.from_target) { // degrees: measure each axis at the middle
            std::vector<double> u(3), v(3);
            const CellRect middle{target_.width / 2, target_.height / 2, target_.width / 2 + 1, target_.height / 2 + 1};
            const auto at = [&](CellRect c, size_t k) { map(i, c, &u[k], &v[k]); };
            at(middle, 0);
            at({middle.x0 + 1, middle.y0, middle.x1 + 1, middle.y1}, 1);
            at({middle.x0, middle.y0 + 1, middle.x1, middle.y1 + 1}, 2);
            const double across = std::hypot(u[1] - u[0], u[2] - u[0]), down = std::hypot(v[1] - v[0], v[2] - v[0]);
            if (std::isfinite(across) && std::isfinite(down) && across > 0 && down > 0)
                side_x = step / across, side_y = step / down;
        }
        const auto filter = [&](double side) { return step / side > 1.0001 ? step / side : 1.0; };
        sheet.filter_x = filter(side_x);
        sheet.filter_y = filter(side_y);
        if (sheet.filter_x > 64.0 || sheet.filter_y > 64.0)
            return Error{ErrorKind::usage,
                         fmt::format("cells of {} m are more than 64 times the file's own ({:.3g} m): shrink the "
                                     "file first",
                                     target_.cell_m, std::min(side_x, side_y) * unit_m)};
    }
    std::vector<size_t> order(sheets_.size());
    for (size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return native[a] < native[b] * 0.999; });
    std::vector<Sheet> sorted;
    for (const size_t i : order) sorted.push_back(std::move(sheets_[i]));
    sheets_ = std::move(sorted);
    return {};
}

void DemMosaic::map(size_t sheet_index, const CellRect& cells, double* u, double* v) const {
    const Sheet& sheet = sheets_[sheet_index];
    const Transform& inv = sheet.to_sample;
    const int64_t width = cells.width(), height = cells.height();
    const auto to_sample = [&](double x, double y, double& a, double& b) {
        a = inv[0] + x * inv[1] + y * inv[2];
        b = inv[3] + x * inv[4] + y * inv[5];
    };
    if (!sheet.from_target) {
        for (int64_t j = 0; j < height; ++j) {
            const double y = target_.origin_y - (static_cast<double>(cells.y0 + j) + 0.5) * target_.step;
            for (int64_t i = 0; i < width; ++i) {
                const double x = target_.origin_x + (static_cast<double>(cells.x0 + i) + 0.5) * target_.step;
                // Relative to the sheet's corner: the difference of two large numbers is taken first, and exactly.
                const double dx = x - sheet.transform[0], dy = y - sheet.transform[3];
                u[j * width + i] = dx * inv[1] + dy * inv[2];
                v[j * width + i] = dx * inv[4] + dy * inv[5];
            }
        }
        return;
    }
    const int64_t n0 = floor_div(cells.x0, k_node_cells), n1 = floor_div(cells.x1 - 1, k_node_cells) + 1;
    const int64_t m0 = floor_div(cells.y0, k_node_cells), m1 = floor_div(cells.y1 - 1, k_node_cells) + 1;
    const int64_t columns = n1 - n0 + 1, rows = m1 - m0 + 1;
    std::vector<double> node_u(static_cast<size_t>(columns * rows)), node_v(node_u.size());
    std::vector<int> good(node_u.size());
    for (int64_t m = 0; m < rows; ++m)
        for (int64_t n = 0; n < columns; ++n) {
            const auto k = static_cast<size_t>(m * columns + n);
            node_u[k] = target_.origin_x + static_cast<double>((n0 + n) * k_node_cells) * target_.step;
            node_v[k] = target_.origin_y - static_cast<double>((m0 + m) * k_node_cells) * target_.step;
        }
    for (int64_t m = 0; m < rows; ++m) {
        const auto k = static_cast<size_t>(m * columns);
        sheet.from_target->Transform(static_cast<int>(columns), &node_u[k], &node_v[k], nullptr, &good[k]);
    }
    for (size_t k = 0; k < node_u.size(); ++k) {
        double a = std::numeric_limits<double>::quiet_NaN(), b = a;
        if (good[k] && std::isfinite(node_u[k]) && std::isfinite(node_v[k])) to_sample(node_u[k], node_v[k], a, b);
        node_u[k] = a;
        node_v[k] = b;
    }
    for (int64_t j = 0; j < height; ++j) {
        const int64_t y = cells.y0 + j, m = floor_div(y, k_node_cells);
        const double fy = (static_cast<double>(y - m * k_node_cells) + 0.5) / k_node_cells;
        for (int64_t i = 0; i < width; ++i) {
            const int64_t x = cells.x0 + i, n = floor_div(x, k_node_cells);
            const double fx = (static_cast<double>(x - n * k_node_cells) + 0.5) / k_node_cells;
            const auto k = static_cast<size_t>((m - m0) * columns + (n - n0)), below = k + static_cast<size_t>(columns);
            const auto blend = [&](const std::vector<double>& f) {
                const double top = f[k] + fx * (f[k + 1] - f[k]), bottom = f[below] + fx * (f[below + 1] - f[below]);
                return top + fy * (bottom - top);
            };
            u[j * width + i] = blend(node_u);
            v[j * width + i] = blend(node_v);
        }
    }
}

std::vector<CellRect> DemMosaic::covered(size_t sheet, const CellRect& window) const {
    std::vector<CellRect> parts;
    for (const auto& m : sheets_[sheet].members)
        if (const CellRect part = m.place.intersected(window); !part.empty()) parts.push_back(part);
    return parts;
}

Status DemMosaic::read_file(size_t file, const CellRect& window, double* out) {
    if (sources_.size() > k_open_files) {
        const auto at = std::find(open_files_.begin(), open_files_.end(), file);
        if (at != open_files_.end()) open_files_.erase(at);
        if (open_files_.size() >= k_open_files) {
            sources_[open_files_.front()]->close();
            open_files_.erase(open_files_.begin());
        }
        open_files_.push_back(file);
    }
    return sources_[file]->read(window, out);
}

Status DemMosaic::read(size_t sheet_index, const CellRect& window, double* out) {
    const Sheet& sheet = sheets_[sheet_index];
    if (sheet.members.size() == 1) return read_file(sheet.members[0].file, window, out);
    std::fill(out, out + window.area(), std::numeric_limits<double>::quiet_NaN());
    for (const auto& m : sheet.members) {
        const CellRect part = m.place.intersected(window);
        if (part.empty()) continue;
        piece_.resize(static_cast<size_t>(part.area()));
        SAHEL_TRY(read_file(m.file,
                            {part.x0 - m.place.x0, part.y0 - m.place.y0, part.x1 - m.place.x0, part.y1 - m.place.y0},
                            piece_.data()));
        const double* from = piece_.data();
        for (int64_t y = part.y0; y < part.y1; ++y) {
            double* to = out + (y - window.y0) * window.width() + (part.x0 - window.x0);
            for (int64_t x = part.x0; x < part.x1; ++x, ++to, ++from)
                if (std::isnan(*to)) *to = *from;
        }
    }
    return {};
}

} // namespace sahel
