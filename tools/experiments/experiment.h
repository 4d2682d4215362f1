#pragma once

#include "render/png_io.h"
#include "sim/sand_params.h"
#include "sim/wind_params.h"
#include "world/json_fwd.h"
#include "world/param_overrides.h"
#include "world/result.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Experiments: figures and tables of the papers as runs that anyone can repeat. Each gives a picture, numbers and a
/// verdict: whether every number that has bounds lies within them. The bounds stand beside the measurement in the
/// source, with where they come from; a number without bounds is told and decides nothing.
namespace sahel::experiments {

/// A measured number.
struct Number {
    std::string name;
    double value = 0.0;
    std::string unit;
    std::optional<double> low; ///< bounds, inclusive
    std::optional<double> high;
    std::string note; ///< where the bound comes from, or what to know about it

    [[nodiscard]] bool bounded() const { return low || high; }
    [[nodiscard]] bool holds() const;             ///< not-a-number holds no bound
    [[nodiscard]] std::string value_text() const; ///< "12.3 m"
    [[nodiscard]] std::string bound_text() const; ///< "10 to 15", ">= 3", "" without
};

struct Table {
    std::string title;
    std::vector<std::string> columns;
    std::vector<std::vector<std::string>> rows;
};

struct Picture {
    Image image;
    std::string caption; ///< one or more lines
};

/// What an experiment found.
struct Report {
    std::vector<Number> numbers;
    std::vector<Table> tables;
    std::vector<Picture> pictures;
    int columns = 2;      ///< of pictures on the sheet
    int picture_px = 640; ///< width of each

    /// Tells a number.
    void tell(std::string name, double value, std::string unit, std::string note = {});
    /// A number that must lie within bounds.
    void require(std::string name, double value, std::string unit, std::optional<double> low,
                 std::optional<double> high, std::string note = {});
    /// The one or the other: within bounds where they bind, else only told.
    void require_where(bool binds, std::string name, double value, std::string unit, std::optional<double> low,
                       std::optional<double> high, std::string note = {});
    /// Something that must be so.
    void require_true(std::string name, bool so, std::string note = {});
    [[nodiscard]] bool holds() const;
    [[nodiscard]] int failed() const;
};

/// How large and how long.
struct Extent {
    int32_t size_cells = 0; ///< side of the domain (the longer one, where it is not square)
    int64_t steps = 0;      ///< of one run
};

struct Setup {
    bool quick = false;
    Extent extent;
    bool pictures = true;
    std::string part;                ///< only parts whose names contain it (experiments of several parts)
    ParamOverrides<WindParams> wind; ///< on top of what every run says; verdicts then are for the changed model
    ParamOverrides<SandParams> sand;
    /// Told now and then: share of the work, 0 to 1, and what is done.
    std::function<void(double, const std::string&)> progress;

    [[nodiscard]] bool wants(std::string_view name) const { return name.find(part) != std::string_view::npos; }
    void tell(double share, const std::string& what) const {
        if (progress) progress(share, what);
    }
};

struct Experiment {
    std::string_view name;
    std::string_view shows;
    std::string_view source; ///< what it repeats
    Extent quick;
    Extent full;
    Result<Report> (*run)(const Setup&);
};

/// All of them, in the order of the list that is printed.
std::span<const Experiment> experiments();
/// Null: none of that name.
const Experiment* experiment_named(std::string_view name);

/// The extent of a form; `size_cells` and `steps` above 0 replace the experiment's own.
Extent extent_of(const Experiment& experiment, bool quick, int32_t size_cells = 0, int64_t steps = 0);
/// Runs one. Errors: usage (a size it cannot have), those of the run.
Result<Report> run_experiment(const Experiment& experiment, const Setup& setup);

/// The report for programs: name, what it shows, sizes, numbers with bounds and verdicts, tables, the verdict.
Json report_json(const Experiment& experiment, const Setup& setup, const Report& report);
/// The same for people.
std::string report_text(const Experiment& experiment, const Setup& setup, const Report& report);
/// All pictures on one sheet with captions and verdict. Errors: usage (no picture).
Result<Image> report_sheet(const Experiment& experiment, const Report& report);

// One file each.
Result<Report> run_columns(const Setup&);
Result<Report> run_dunes(const Setup&);
Result<Report> run_bidirectional(const Setup&);
Result<Report> run_migration(const Setup&);
Result<Report> run_reptation(const Setup&);
Result<Report> run_bilinear(const Setup&);
Result<Report> run_shadow(const Setup&);
Result<Report> run_venturi(const Setup&);
Result<Report> run_abrasion(const Setup&);
Result<Report> run_vegetation(const Setup&);
Result<Report> run_timestep(const Setup&);
Result<Report> run_guides(const Setup&);

} // namespace sahel::experiments
