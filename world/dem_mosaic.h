#pragma once

#include "world/dem_source.h"

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// Several elevation files as one: which grid the world gets, and where each file lies in it.
///
///     files   ->  sheets: files on one lattice (same coordinate system, cell size and alignment) joined sample by
///                 sample, so that two halves give exactly what the whole gives, also across the seam
///     sheets  ->  target: square cells of `cell_m` in a metric projection, north up, cell (0, 0) at the north-west
///
/// The target keeps the projection of the first file; geographic (degree) input goes to the UTM zone of its centre, on
/// its own datum, or to a Lambert azimuthal equal-area plane about its centre where it spans more than 9 degrees or
/// lies beyond 80 degrees of latitude. Where sheets overlap the finer one counts, then the one named first.
namespace sahel {

struct DemTarget {
    std::string projection_wkt;
    std::string projection_name; ///< empty: none
    double origin_x = 0.0;       ///< north-west corner of cell (0, 0), projected units
    double origin_y = 0.0;
    double step = 1.0; ///< projected units per cell
    double cell_m = 1.0;
    int64_t width = 0;
    int64_t height = 0;
};

class DemMosaic {
  public:
    /// `cell_m` 0: the finest file's own, or near it where it is not square or in degrees. Errors: those of open_dem,
    /// and usage (several files of which one does not say where it lies).
    static Result<DemMosaic> open(std::span<const std::filesystem::path> files, const DemSourceOptions& options,
                                  double cell_m);
    DemMosaic(DemMosaic&&) noexcept;
    DemMosaic& operator=(DemMosaic&&) noexcept;
    ~DemMosaic();

    [[nodiscard]] const DemTarget& target() const { return target_; }
    [[nodiscard]] size_t file_count() const { return sources_.size(); }
    [[nodiscard]] const DemSource& file(size_t i) const { return *sources_[i]; }
    [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }

    [[nodiscard]] size_t sheet_count() const;
    [[nodiscard]] int64_t sheet_width(size_t sheet) const;
    [[nodiscard]] int64_t sheet_height(size_t sheet) const;
    /// Sheet samples per target cell, at least 1: the width of the resampling filter.
    [[nodiscard]] double filter_x(size_t sheet) const;
    [[nodiscard]] double filter_y(size_t sheet) const;

    /// Rows of target cells lie along rows of samples: v does not change along a row of cells.
    [[nodiscard]] bool straight(size_t sheet) const;

    /// Where the centres of target cells lie in a sheet: (u, v) in samples, the first sample's centre at (0.5, 0.5);
    /// NaN where the projection has no answer. The value of a cell does not depend on the rectangle.
    void map(size_t sheet, const CellRect& cells, double* u, double* v) const;

    /// Samples of a sheet, NaN where no file has data. The window lies inside the sheet.
    Status read(size_t sheet, const CellRect& window, double* out);
    /// Parts of the window that some file covers.
    [[nodiscard]] std::vector<CellRect> covered(size_t sheet, const CellRect& window) const;

  private:
    struct Sheet;
    DemMosaic();
    Status join_sheets();
    Status choose_target(double cell_m);
    Status read_file(size_t file, const CellRect& window, double* out);

    std::vector<std::unique_ptr<DemSource>> sources_;
    std::vector<Sheet> sheets_;
    DemTarget target_;
    std::vector<std::string> notes_;
    std::vector<size_t> open_files_; ///< least recently used first
    std::vector<double> piece_;
};

} // namespace sahel
