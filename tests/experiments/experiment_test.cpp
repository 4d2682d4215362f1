#include "tools/experiments/experiment.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <set>

namespace sahel::experiments {
namespace {

Report two_numbers(double measured) {
    Report report;
    report.tell("told", 12.25, "m");
    report.require("bounded", measured, "deg", 0.0, 15.0, "theory");
    report.tables.push_back({"a table", {"name", "x"}, {{"first", "1"}, {"second", "22"}}});
    return report;
}

TEST(Report, HoldsOnlyIfEveryBoundHolds) {
    EXPECT_TRUE(two_numbers(15.0).holds());
    EXPECT_FALSE(two_numbers(15.1).holds());
    EXPECT_FALSE(two_numbers(std::nan("")).holds());
    EXPECT_EQ(two_numbers(-1.0).failed(), 1);
    Report report;
    report.require_true("so", false);
    EXPECT_FALSE(report.holds());
    EXPECT_TRUE(Report{}.holds()) << "nothing is bounded";
}

TEST(Report, SaysItToPeopleAndPrograms) {
    const Experiment& e = experiments()[0];
    experiments::Setup setup;
    setup.quick = true;
    setup.extent = {64, 100};
    const std::string good = report_text(e, setup, two_numbers(3.0));
    EXPECT_NE(good.find("bounded"), std::string::npos);
    EXPECT_NE(good.find("0 to 15"), std::string::npos);
    EXPECT_NE(good.find("pass"), std::string::npos);
    EXPECT_NE(good.find("all 1 bounds hold"), std::string::npos);
    const std::string bad = report_text(e, setup, two_numbers(31.0));
    EXPECT_NE(bad.find("FAIL"), std::string::npos);
    EXPECT_NE(bad.find("1 of 1 bounds do not hold"), std::string::npos);
    const auto j = report_json(e, setup, two_numbers(31.0));
    EXPECT_EQ(j["holds"], false);
    EXPECT_EQ(j["size_cells"], 64);
    EXPECT_EQ(j["numbers"].size(), 2u);
    EXPECT_FALSE(j["numbers"][0].contains("holds"));
    EXPECT_EQ(j["numbers"][1]["high"], 15.0);
    EXPECT_EQ(j["numbers"][1]["holds"], false);
    EXPECT_TRUE(report_json(e, setup, two_numbers(std::nan("")))["numbers"][1]["value"].is_null());
    EXPECT_EQ(j["tables"][0]["rows"][1][1], "22");
}

TEST(Report, SheetHoldsEveryPicture) {
    Report report = two_numbers(3.0);
    report.columns = 2;
    report.picture_px = 100;
    EXPECT_FALSE(report_sheet(experiments()[0], report).ok());
    for (int i = 0; i < 3; ++i) report.pictures.push_back({Image(50, 50, 4), "a caption"});
    const auto sheet = report_sheet(experiments()[0], report);
    ASSERT_TRUE(sheet.ok());
    EXPECT_GT(sheet->width_px, 200);
    EXPECT_GT(sheet->height_px, 200); // two rows
}

TEST(Experiments, HaveNamesAndRefuseSizes) {
    std::set<std::string_view> names;
    for (const Experiment& e : experiments()) {
        EXPECT_TRUE(names.insert(e.name).second) << e.name;
        EXPECT_EQ(experiment_named(e.name), &e);
        EXPECT_LE(e.quick.size_cells, e.full.size_cells) << e.name;
        experiments::Setup setup;
        setup.quick = true;
        setup.extent = extent_of(e, true, 100);
        const auto refused = run_experiment(e, setup);
        ASSERT_FALSE(refused.ok()) << e.name;
        EXPECT_EQ(refused.error().exit_code(), 2);
    }
    EXPECT_EQ(experiment_named("nosuch"), nullptr);
    EXPECT_EQ(extent_of(experiments()[0], false, 0, 77).steps, 77);
}

/// Every experiment in its quick form: all bounds must hold.
class Quick : public testing::TestWithParam<const char*> {};

TEST_P(Quick, HoldsItsBounds) {
    const Experiment* e = experiment_named(GetParam());
    ASSERT_NE(e, nullptr);
    experiments::Setup setup;
    setup.quick = true;
    setup.extent = extent_of(*e, true);
    setup.pictures = false;
    const Result<Report> report = run_experiment(*e, setup);
    ASSERT_TRUE(report.ok()) << report.error().message;
    EXPECT_TRUE(report->holds()) << report_text(*e, setup, *report);
    int bounds = 0;
    for (const Number& n : report->numbers) bounds += n.bounded();
    EXPECT_GE(bounds, 2);
}

INSTANTIATE_TEST_SUITE_P(Experiments, Quick,
                         testing::Values("columns", "dunes", "bidirectional", "migration", "reptation", "bilinear",
                                         "shadow", "venturi", "abrasion", "vegetation", "timestep", "guides"),
                         [](const auto& test) { return std::string(test.param); });

} // namespace
} // namespace sahel::experiments
