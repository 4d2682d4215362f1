#include "world/params.h"
#include "world/params_cli.h"
#include "world/params_json.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace sahel {
namespace {

struct TalusParams {
    float repose_slope = 0.6f;
    int sweeps = 4;
    bool enabled = true;
    double far_m = 1e6;
    uint64_t seed = 7;
    std::string note = "dry";
};

struct OneParam {
    float only = 1.0f;
};

struct Wide { // as many members as the largest tables, of changing size and alignment
    float a0 = 0, a1 = 0, a2 = 0, a3 = 0, a4 = 0, a5 = 0, a6 = 0, a7 = 0, a8 = 0, a9 = 0;
    int b0 = 0, b1 = 0, b2 = 0, b3 = 0, b4 = 0, b5 = 0, b6 = 0, b7 = 0, b8 = 0, b9 = 0;
    bool c0 = false, c1 = false, c2 = false, c3 = false, c4 = false;
    double d0 = 0, d1 = 0, d2 = 0, d3 = 0, d4 = 0, d5 = 0, d6 = 0, d7 = 0, d8 = 0, d9 = 0;
    std::string e0, e1, e2, e3, e4;
    int64_t f0 = 0, f1 = 0;
};

struct Forgotten {
    float named = 0.0f;
    float not_named = 0.0f;
};

struct Doubled {
    float first = 0.0f;
    float second = 0.0f;
};

struct BadDefault {
    float value = 3.0f;
};

} // namespace

template <>
inline constexpr auto fields_of<TalusParams> = std::tuple{
    Field{&TalusParams::repose_slope, "repose_slope", "m/m", 0.1f, 2.0f, "Steepest slope that holds"},
    Field{&TalusParams::sweeps, "sweeps", "", 1, 16, "Sweeps per step"},
    Field{&TalusParams::enabled, "enabled", "", false, true, "Whether sand slides"},
    Field{&TalusParams::far_m, "far_m", "m", 0.0, 1e9, "Distance | of nothing"},
    Field{&TalusParams::seed, "seed", "", 0, std::numeric_limits<uint64_t>::max(), "Seed"},
    Field{&TalusParams::note, "note", "", 0, 8, "A note"},
};
template <>
inline constexpr auto fields_of<OneParam> = std::tuple{Field{&OneParam::only, "only", "", 0.0f, 1.0f, "The only one"}};
template <>
inline constexpr auto fields_of<Forgotten> = std::tuple{Field{&Forgotten::named, "named", "", 0.0f, 1.0f, "Named"}};
template <>
inline constexpr auto fields_of<Doubled> = std::tuple{
    Field{&Doubled::first, "first", "", 0.0f, 1.0f, "First"},
    Field{&Doubled::first, "second", "", 0.0f, 1.0f, "First again"},
};
template <>
inline constexpr auto fields_of<BadDefault> = std::tuple{Field{&BadDefault::value, "value", "", 0.0f, 1.0f, "Value"}};

static_assert(covers_every_member<TalusParams>);
static_assert(covers_every_member<OneParam> && defaults_in_range<OneParam>);
static_assert(!covers_every_member<Forgotten>, "a member without a row");
static_assert(!covers_every_member<Doubled>, "a member with two rows");
static_assert(!defaults_in_range<BadDefault>);
static_assert(detail::member_count<Wide>() == 42);
static_assert(has_fields<OneParam> && !has_fields<Wide>);

namespace {

TEST(Params, ReportTheFirstValueOutOfRange) {
    EXPECT_TRUE(check_ranges(TalusParams{}, "world.json").ok());
    TalusParams p;
    p.repose_slope = 2.5f;
    EXPECT_EQ(check_ranges(p, "world.json", "talus").error().message,
              "world.json: 'talus.repose_slope' is 2.5, outside its range 0.1 to 2 m/m");
    EXPECT_EQ(check_ranges(p, "world.json").error().exit_code(), 2);
    p.repose_slope = std::numeric_limits<float>::quiet_NaN();
    EXPECT_FALSE(check_ranges(p, "world.json").ok());
    p = {};
    p.note = "nine char";
    EXPECT_EQ(check_ranges(p, "x").error().message, "x: 'note' is nine char, outside its range 0 to 8 characters");
}

TEST(Params, JsonRoundTripKeepsEveryBit) {
    TalusParams p{.repose_slope = 0.1f, .sweeps = 16, .enabled = false, .far_m = 0.1, .seed = ~0ull, .note = "\"q\""};
    const std::string text = params_to_json(p).dump();
    EXPECT_EQ(text, R"({"repose_slope":0.1,"sweeps":16,"enabled":false,"far_m":0.1,"seed":18446744073709551615,)"
                    R"("note":"\"q\""})");
    const auto read = params_from_json<TalusParams>(parse_json(text, "t").value(), "t");
    ASSERT_TRUE(read.ok());
    EXPECT_EQ(read->repose_slope, p.repose_slope);
    EXPECT_EQ(read->sweeps, p.sweeps);
    EXPECT_EQ(read->enabled, p.enabled);
    EXPECT_EQ(read->far_m, p.far_m);
    EXPECT_EQ(read->seed, p.seed);
    EXPECT_EQ(read->note, p.note);
    uint32_t bits = 1;
    for (int i = 0; i < 200000; ++i) { // floats of every size
        bits = bits * 1664525u + 1013904223u;
        float f;
        std::memcpy(&f, &bits, sizeof f);
        if (!std::isfinite(f)) continue;
        ASSERT_EQ(static_cast<float>(json_double(f)), f);
    }
}

TEST(Params, MissingKeysKeepTheGivenDefaults) {
    const auto read = params_from_json<TalusParams>(Json{{"sweeps", 2}}, "t", "", TalusParams{.note = "wet"});
    ASSERT_TRUE(read.ok());
    EXPECT_EQ(read->sweeps, 2);
    EXPECT_EQ(read->note, "wet");
    EXPECT_EQ(read->repose_slope, 0.6f);
}

std::string error_of(std::string_view text) {
    const auto parsed = parse_json(text, "w.json");
    if (!parsed.ok()) return parsed.error().message;
    const auto read = params_from_json<TalusParams>(*parsed, "w.json", "talus");
    return read.ok() ? "no error" : read.error().message;
}

TEST(Params, JsonErrorsNameFileKeyAndRange) {
    EXPECT_EQ(error_of(R"({"repose_slpoe": 1})"),
              "w.json: unknown key 'talus.repose_slpoe'; did you mean 'repose_slope'?");
    EXPECT_EQ(error_of(R"({"zzz": 1})"), "w.json: unknown key 'talus.zzz'; known keys: repose_slope, sweeps, enabled, "
                                         "far_m, seed, note");
    EXPECT_EQ(error_of(R"({"repose_slope": 5})"), "w.json: 'talus.repose_slope' is 5, outside its range 0.1 to 2 m/m");
    EXPECT_EQ(error_of(R"({"repose_slope": "steep"})"),
              "w.json: 'talus.repose_slope' must be a number, 0.1 to 2 m/m, not the text \"steep\"");
    EXPECT_EQ(error_of(R"({"sweeps": 2.5})"), "w.json: 'talus.sweeps' must be an integer, 1 to 16, not 2.5");
    EXPECT_EQ(error_of(R"({"sweeps": 4294967297})"), "w.json: 'talus.sweeps' is 4294967297, outside its range 1 to 16");
    EXPECT_EQ(error_of(R"({"sweeps": true})"), "w.json: 'talus.sweeps' must be an integer, 1 to 16, not true");
    EXPECT_EQ(error_of(R"({"seed": -1})"), "w.json: 'talus.seed' is -1, outside its range 0 to 18446744073709551615");
    EXPECT_EQ(error_of(R"({"repose_slope": 1e300})"),
              "w.json: 'talus.repose_slope' is 1e+300, outside its range 0.1 to 2 m/m");
    EXPECT_EQ(error_of(R"({"enabled": 1})"), "w.json: 'talus.enabled' must be true or false, not 1");
    EXPECT_EQ(error_of(R"({"note": null})"), "w.json: 'talus.note' must be text, 0 to 8 characters, not null");
    EXPECT_EQ(error_of(R"([1])"), "w.json: 'talus' must be an object, not an array");
    EXPECT_EQ(error_of(R"({"sweeps": 2, "sweeps": 3})"), "w.json: the key 'sweeps' is given twice in one object");
    const std::string broken = error_of("{\"sweeps\": 2,\n  oops}");
    EXPECT_EQ(broken.find("w.json: not valid JSON: parse error at line 2, column 3"), 0u) << broken;
    EXPECT_NE(error_of("{\"far_m\": 1e999}").find("w.json: not valid JSON"), std::string::npos);
    EXPECT_EQ(error_of("{}"), "no error");
}

TEST(Params, NearestNameIsNotAnyName) {
    const std::vector<std::string_view> names{"dune_m", "canyon_m", "mega_dune_m"};
    EXPECT_EQ(nearest_name("dunem", names), "dune_m");
    EXPECT_EQ(nearest_name("mega_dune", names), "mega_dune_m");
    EXPECT_EQ(nearest_name("cayon_m", names), "canyon_m");
    EXPECT_EQ(nearest_name("wind", names), "");
    EXPECT_EQ(nearest_name(std::string(10000, 'x'), names), "");
}

std::string parse(CLI::App& app, std::vector<std::string> arguments) {
    try {
        std::reverse(arguments.begin(), arguments.end());
        app.parse(arguments);
        return "";
    } catch (const CLI::ParseError& e) {
        return e.what();
    }
}

TEST(Params, CommandLineOverridesGoOnTopOfAPreset) {
    CLI::App app;
    ParamOverrides<TalusParams> overrides;
    add_params_options<TalusParams>(app, "talus", overrides);
    ASSERT_EQ(parse(app, {"--talus.repose_slope=0.75", "--talus.enabled=false", "--talus.note", "wet",
                          "--talus.far_m=+5e3", "--talus.seed=18446744073709551615"}),
              "");
    TalusParams p{.repose_slope = 1.0f, .sweeps = 9};
    overrides.apply(p);
    EXPECT_EQ(p.repose_slope, 0.75f);
    EXPECT_EQ(p.sweeps, 9);
    EXPECT_FALSE(p.enabled);
    EXPECT_EQ(p.note, "wet");
    EXPECT_EQ(p.far_m, 5000.0);
    EXPECT_EQ(p.seed, ~0ull);
}

TEST(Params, CommandLineErrorsNameOptionAndRange) {
    for (const auto& [argument, message] : std::vector<std::pair<std::string, std::string>>{
             {"--talus.sweeps=17", "command line: '--talus.sweeps' is 17, outside its range 1 to 16"},
             {"--talus.sweeps=4x", "command line: '--talus.sweeps' must be an integer, 1 to 16, not \"4x\""},
             {"--talus.repose_slope=nan",
              "command line: '--talus.repose_slope' is nan, outside its range 0.1 to 2 m/m"},
             {"--talus.enabled=maybe", "command line: '--talus.enabled' must be true or false, not \"maybe\""},
             {"--talus.seed=-1",
              "command line: '--talus.seed' must be an integer, 0 to 18446744073709551615, not \"-1\""}}) {
        CLI::App app;
        ParamOverrides<TalusParams> overrides;
        add_params_options<TalusParams>(app, "talus", overrides);
        EXPECT_EQ(parse(app, {argument}), message);
        EXPECT_TRUE(overrides.empty());
    }
}

TEST(Params, HelpAndReferencePageShowUnitRangeAndDefault) {
    CLI::App app;
    ParamOverrides<TalusParams> overrides;
    add_params_options<TalusParams>(app, "talus", overrides);
    const std::string help = app.help();
    EXPECT_NE(help.find("--talus.repose_slope NUMBER=0.6"), std::string::npos) << help;
    EXPECT_NE(help.find("Steepest slope that holds; 0.1 to 2 m/m"), std::string::npos) << help;
    EXPECT_EQ(params_markdown<OneParam>("one"), "| Name | Default | Unit | Range | Meaning |\n|---|---|---|---|---|\n"
                                                "| `one.only` | 1 |  | 0 to 1 | The only one |\n");
    EXPECT_NE(params_markdown<TalusParams>().find("| `enabled` | true |  | true or false | Whether sand slides |"),
              std::string::npos);
    EXPECT_NE(params_markdown<TalusParams>().find("Distance \\| of nothing"), std::string::npos);
}

} // namespace
} // namespace sahel
