#pragma once

#include "sim/wind_params.h"
#include "world/result.h"

#include <filesystem>
#include <vector>

/// Which wind blows when. Either the parameters say so (one wind, or two in turn: Desertscape method 3.2, where the
/// second, weaker one begins), or a wind rose does: a series of (time, speed, direction) that repeats.
namespace sahel {

struct WindNow {
    float speed_m_per_s = 0.0f;
    float angle_deg = 0.0f; ///< towards; from +x towards +y
    friend bool operator==(const WindNow&, const WindNow&) = default;
};

class WindSchedule {
  public:
    explicit WindSchedule(const WindParams& params) : params_(params) {}

    /// One row of a series: from `start_s` on, until the next row.
    struct Row {
        double start_s = 0.0;
        WindNow wind;
    };
    /// A series with its length; rows sorted by time, the first at 0. Errors: usage.
    static Result<WindSchedule> from_rows(std::vector<Row> rows, double length_s);
    /// CSV (columns time_s, speed_m_per_s, angle_deg; a header line) or JSON (an array of objects with those keys, and
    /// optionally {"length_s", "rows"}), by the file's ending. Errors: not_found, usage (file, line or key, range).
    static Result<WindSchedule> from_file(const std::filesystem::path& file);

    /// The wind during the step that begins at `time_s`.
    [[nodiscard]] WindNow at(double time_s) const;
    [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }
    [[nodiscard]] double length_s() const { return length_s_; }

  private:
    WindParams params_;
    std::vector<Row> rows_; ///< empty: the parameters
    double length_s_ = 0.0;
};

} // namespace sahel
