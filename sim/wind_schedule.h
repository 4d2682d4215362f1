#pragma once

#include "sim/wind_params.h"
#include "world/result.h"

#include <cstdint>
#include <string_view>
#include <vector>

/// Which wind blows when. Either the parameters say so (one wind, or two in turn: Desertscape method 3.2, where the
/// second, weaker one begins), or a wind rose does: a series of (time, speed, direction) that repeats.
///
///     strength based    | second, U/R | first, U    | second, U/R | ...        each for T
///     duration based    | second, U   | first, U for R T     | second, U | ... the second for T
namespace sahel {

struct WindNow {
    float speed_m_per_s = 0.0f;
    float angle_deg = 0.0f; ///< towards; from +x towards +y
    friend bool operator==(const WindNow&, const WindNow&) = default;
};

/// The same as a vector. A turn by 90 degrees exchanges the components, bit by bit; along an axis the other one is 0.
struct WindVector {
    float x_m_per_s = 0.0f;
    float y_m_per_s = 0.0f;
    friend bool operator==(const WindVector&, const WindVector&) = default;
};
WindVector vector_of(const WindNow& now);

class WindSchedule {
  public:
    explicit WindSchedule(const WindParams& params) : params_(params) {}

    /// One row of a series: from `start_s` on, until the next row.
    struct Row {
        double start_s = 0.0;
        WindNow wind;
    };
    /// A series that repeats after `length_s`; rows sorted by time, the first at 0. Errors: usage.
    static Result<WindSchedule> from_rows(std::vector<Row> rows, double length_s);
    /// CSV with a header line that names the columns time_s, speed_m_per_s, angle_deg in any order. Empty lines and
    /// lines that start with '#' are passed over. A last line with a time alone ends the series; else its last row
    /// lasts as long as the one before it, and a single row for ever. `where` names the text. Errors: usage, with line
    /// and column.
    static Result<WindSchedule> from_csv(std::string_view text, std::string_view where);
    /// JSON: an array of objects with those keys, or {"length_s": ..., "rows": [...]}. Errors: corrupt (no JSON), usage
    /// (names the key and the range).
    static Result<WindSchedule> from_json(std::string_view text, std::string_view where);

    /// The time at which a step begins, from its number: never accumulated.
    static double time_of(int64_t step, float step_s);
    /// The wind during the step that begins at `time_s`. A change is due at its time or up to a few roundings before.
    [[nodiscard]] WindNow at(double time_s) const;
    [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }
    [[nodiscard]] double length_s() const { return length_s_; }

  private:
    WindParams params_;
    std::vector<Row> rows_; ///< empty: the parameters
    double length_s_ = 0.0;
};

} // namespace sahel
