#include "sim/wind_schedule.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace sahel::test {
namespace {

using testing::HasSubstr;

WindParams two_winds() {
    WindParams p;
    p.speed_m_per_s = 5.0f;
    p.angle_deg = 10.0f;
    p.bidirectional = true;
    p.second_angle_deg = 80.0f;
    p.ratio = 2.0f;
    p.period_s = 10.0f;
    return p;
}

TEST(WindSchedule, OneWindBlowsForEver) {
    WindParams p = two_winds();
    p.bidirectional = false;
    for (const double t : {0.0, 7.0, 1.0e9}) EXPECT_EQ(WindSchedule(p).at(t), (WindNow{5.0f, 10.0f}));
}

TEST(WindSchedule, TheSecondWindBeginsAtAShareOfTheSpeed) {
    const WindSchedule s(two_winds());
    for (int64_t step = 0; step < 200; ++step) {
        const bool second = step % 20 < 10;
        EXPECT_EQ(s.at(WindSchedule::time_of(step, 1.0f)), second ? (WindNow{2.5f, 80.0f}) : (WindNow{5.0f, 10.0f}))
            << step;
    }
}

TEST(WindSchedule, DurationBasedTheFirstWindLastsLonger) {
    WindParams p = two_winds();
    p.strength_based = false;
    const WindSchedule s(p);
    for (int64_t step = 0; step < 300; ++step)
        EXPECT_EQ(s.at(WindSchedule::time_of(step, 1.0f)), (WindNow{5.0f, step % 30 < 10 ? 80.0f : 10.0f})) << step;
}

TEST(WindSchedule, ChangesFallOnTheirStepForAnyLengthOfStep) {
    // As decimal fractions the period is a whole number of steps; as sums of floats it is not.
    for (const auto& [step_s, period_s, steps] :
         std::vector<std::tuple<float, float, int64_t>>{{0.7f, 3.5f, 5}, {0.1f, 0.7f, 7}, {0.3f, 90.0f, 300}}) {
        WindParams p = two_winds();
        p.period_s = period_s;
        const WindSchedule s(p);
        for (int64_t turn = 0; turn < 100'000; turn += turn < 50 ? 1 : 997)
            for (const int64_t step : {turn * steps, turn * steps + steps - 1})
                EXPECT_EQ(s.at(WindSchedule::time_of(step, step_s)).angle_deg, turn % 2 == 0 ? 80.0f : 10.0f)
                    << "steps of " << step_s << " s, turns of " << period_s << " s, step " << step;
    }
}

TEST(WindSchedule, VectorsOfAxesAreExactAndQuarterTurnsExchangeComponents) {
    EXPECT_EQ(vector_of({7.3f, 0.0f}), (WindVector{7.3f, 0.0f}));
    EXPECT_EQ(vector_of({7.3f, 90.0f}), (WindVector{0.0f, 7.3f}));
    EXPECT_EQ(vector_of({7.3f, 180.0f}), (WindVector{-7.3f, 0.0f}));
    EXPECT_EQ(vector_of({7.3f, -90.0f}), (WindVector{0.0f, -7.3f}));
    EXPECT_EQ(vector_of({7.3f, 360.0f}), (WindVector{7.3f, 0.0f}));
    for (float a = -270.0f; a <= 270.0f; a += 7.25f) {
        const WindVector v = vector_of({4.0f, a});
        const WindVector turned = vector_of({4.0f, a + 90.0f});
        EXPECT_EQ(turned, (WindVector{-v.y_m_per_s, v.x_m_per_s})) << a;
        EXPECT_NEAR(v.x_m_per_s, 4.0 * std::cos(a * M_PI / 180.0), 2e-6) << a;
        EXPECT_NEAR(v.y_m_per_s, 4.0 * std::sin(a * M_PI / 180.0), 2e-6) << a;
    }
}

constexpr const char* k_rose = "# measured at the mast\n"
                               "speed_m_per_s,time_s,angle_deg\r\n"
                               "4.5, 0,  90\n"
                               "\n"
                               "6,   60, -45\n"
                               "2,  150,   0\n";

TEST(WindSchedule, AWindRoseFromCsvRepeats) {
    const auto s = WindSchedule::from_csv(k_rose, "rose.csv");
    ASSERT_TRUE(s.ok()) << s.error().message;
    ASSERT_EQ(s->rows().size(), 3u);
    EXPECT_EQ(s->length_s(), 240.0); // the last row lasts as long as the one before it
    for (const double turn : {0.0, 240.0, 2.4e9}) {
        EXPECT_EQ(s->at(turn), (WindNow{4.5f, 90.0f}));
        EXPECT_EQ(s->at(turn + 59.9), (WindNow{4.5f, 90.0f}));
        EXPECT_EQ(s->at(turn + 60.0), (WindNow{6.0f, -45.0f}));
        EXPECT_EQ(s->at(turn + 239.0), (WindNow{2.0f, 0.0f}));
    }
    const auto ended = WindSchedule::from_csv(std::string(k_rose) + ",200,\n", "rose.csv");
    ASSERT_TRUE(ended.ok()) << ended.error().message;
    EXPECT_EQ(ended->length_s(), 200.0);
    const auto calm = WindSchedule::from_csv("time_s,speed_m_per_s,angle_deg\n0,3,20\n", "one.csv");
    ASSERT_TRUE(calm.ok());
    EXPECT_EQ(calm->at(12345.6), (WindNow{3.0f, 20.0f}));
}

TEST(WindSchedule, AWindRoseFromJson) {
    const char* rows = R"([{"time_s": 0, "speed_m_per_s": 4.5, "angle_deg": 90},
                           {"angle_deg": -45, "time_s": 60, "speed_m_per_s": 6}])";
    const auto s = WindSchedule::from_json(rows, "rose.json");
    ASSERT_TRUE(s.ok()) << s.error().message;
    EXPECT_EQ(s->length_s(), 120.0);
    EXPECT_EQ(s->at(180.0), (WindNow{6.0f, -45.0f}));
    const auto long_one =
        WindSchedule::from_json(std::string(R"({"length_s": 100, "rows": )") + rows + "}", "rose.json");
    ASSERT_TRUE(long_one.ok()) << long_one.error().message;
    EXPECT_EQ(long_one->length_s(), 100.0);
    EXPECT_EQ(long_one->at(100.0), (WindNow{4.5f, 90.0f}));
}

void expect_refused(const Result<WindSchedule>& result, const std::vector<std::string>& parts,
                    ErrorKind kind = ErrorKind::usage) {
    ASSERT_FALSE(result.ok()) << parts.front();
    EXPECT_EQ(result.error().kind, kind) << result.error().message;
    for (const std::string& part : parts) EXPECT_THAT(result.error().message, HasSubstr(part));
}

TEST(WindSchedule, RefusalsOfCsvNameTheLineAndTheColumn) {
    const auto csv = [](const std::string& rows) {
        return WindSchedule::from_csv("time_s,speed_m_per_s,angle_deg\n" + rows, "w.csv");
    };
    expect_refused(WindSchedule::from_csv("", "w.csv"), {"w.csv", "no rows"});
    expect_refused(csv(""), {"w.csv", "no rows"});
    expect_refused(WindSchedule::from_csv("time_s,speed,angle_deg\n0,1,2\n", "w.csv"), {"line 1", "speed_m_per_s"});
    expect_refused(csv("0,1\n"), {"line 2", "2 columns"});
    expect_refused(csv("0,fast,0\n"), {"line 2", "speed_m_per_s", "'fast'"});
    expect_refused(csv("0,1m,0\n"), {"line 2", "speed_m_per_s", "'1m'"});
    expect_refused(csv("0,61,0\n"), {"line 2", "speed_m_per_s", "61", "0 to 60"});
    expect_refused(csv("0,nan,0\n"), {"line 2", "speed_m_per_s"});
    expect_refused(csv("0,1,400\n"), {"line 2", "angle_deg", "-360 to 360"});
    expect_refused(csv("1,1,0\n"), {"line 2", "time_s", "not 0"});
    expect_refused(csv("0,1,0\n\n5,1,0\n5,2,0\n"), {"line 5", "time_s", "not after 5"});
    expect_refused(csv("0,1,0\n9,,\n10,1,0\n"), {"line 4", "after the one that ends"});
    expect_refused(csv("0,,\n"), {"line 2", "missing"});
}

TEST(WindSchedule, RefusalsOfJsonNameTheKey) {
    const auto json = [](const char* text) { return WindSchedule::from_json(text, "w.json"); };
    expect_refused(json("[{"), {"w.json"}, ErrorKind::corrupt);
    expect_refused(json("3"), {"w.json", "array"});
    expect_refused(json("[]"), {"w.json", "no rows"});
    expect_refused(json("[7]"), {"rows[0]", "object"});
    expect_refused(json(R"([{"time_s": 0, "speed_m_per_s": 1}])"), {"rows[0].angle_deg", "missing"});
    expect_refused(json(R"([{"time_s": 0, "speed_m_per_s": "1", "angle_deg": 0}])"),
                   {"rows[0].speed_m_per_s", "a number"});
    expect_refused(json(R"([{"time_s": 0, "speed_m_per_s": -1, "angle_deg": 0}])"),
                   {"rows[0].speed_m_per_s", "-1", "0 to 60"});
    expect_refused(json(R"([{"time_s": 0, "speed_m_per_s": 1, "angel_deg": 0}])"), {"angel_deg", "angle_deg"});
    expect_refused(json(R"({"rows": [], "lenght_s": 1})"), {"lenght_s", "length_s"});
    expect_refused(json(R"({"length_s": 1})"), {"rows is missing"});
    expect_refused(json(R"({"length_s": 0, "rows": [{"time_s": 0, "speed_m_per_s": 1, "angle_deg": 0}]})"),
                   {"length_s"});
    expect_refused(json(R"([{"time_s": 0, "speed_m_per_s": 1, "angle_deg": 0},
                            {"time_s": 0, "speed_m_per_s": 1, "angle_deg": 0}])"),
                   {"rows[1]", "not after"});
}

TEST(WindSchedule, RefusalsOfRows) {
    expect_refused(WindSchedule::from_rows({}, 1.0), {"no rows"});
    expect_refused(WindSchedule::from_rows({{0.0, {1.0f, 0.0f}}}, 0.0), {"ends before"});
    expect_refused(WindSchedule::from_rows({{0.0, {std::nanf(""), 0.0f}}}, 1.0), {"speed_m_per_s"});
    expect_refused(WindSchedule::from_rows({{0.0, {1.0f, 0.0f}}, {std::nan(""), {1.0f, 0.0f}}}, 1.0), {"row 1"});
}

} // namespace
} // namespace sahel::test
