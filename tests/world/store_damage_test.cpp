#include "tests/world/store_support.h"
#include "world/exr_tile.h"
#include "world/sqlite.h"

#include <cstdlib>
#include <fstream>
#include <sched.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <sys/wait.h>

/// What disks, people and strangers do to a world: every change is found, nothing is made worse.
namespace sahel::store_test {
namespace {

bool long_tests() {
    return std::getenv("SAHEL_LONG_TESTS") != nullptr;
}

/// What a reader of the world gets to see.
std::string seen(const World& world) {
    const auto info = world.info();
    const auto hash = world.hash();
    if (!info.ok() || !hash.ok()) return "an error";
    const auto ledger = world.ledger();
    const auto resume = world.resume();
    if (!ledger.ok() || !resume.ok()) return "an error";
    return *hash + ' ' + std::to_string(ledger->size()) + ' ' + std::to_string(resume->size()) + ' ' +
           std::to_string(info->step) + ' ' + std::to_string(info->tile_count) + ' ' +
           std::to_string(info->parent_count) + ' ' + std::to_string(info->min_surface_m) + ' ' +
           std::to_string(info->max_surface_m);
}

/// Opening fails, verify reports it, or what is seen is what it was.
testing::AssertionResult found_or_harmless(const fs::path& folder, const std::string& before, int& found) {
    auto world = World::open(folder, OpenMode::read);
    if (world.ok()) {
        const auto report = world->verify();
        if (report.ok() && report->issues.empty()) {
            if (const std::string now = seen(*world); now != before)
                return testing::AssertionFailure() << "unnoticed: " << before << " became " << now;
            return testing::AssertionSuccess();
        }
    }
    ++found;
    return testing::AssertionSuccess();
}

TEST_F(Store, AFlippedBitOfTheIndexIsFoundOrMeansNothing) {
    std::string before;
    {
        World world = create(desc());
        ASSERT_TRUE(commit_tiles(world, 1, {{0, 0, 0}}).ok());
        ASSERT_TRUE(commit_whole_step(world, 2, {{0, -3, 0}, {0, 0, 0}}).ok());
        before = seen(world);
    }
    const fs::path path = folder() / "index.sqlite";
    const auto whole = read_file(path).value();
    int found = 0, flips = 0;
    for (size_t at = 0; at < whole.size(); at += long_tests() ? 1 : 41) {
        auto bytes = whole;
        bytes[at] ^= static_cast<uint8_t>(1u << (at % 8));
        ASSERT_TRUE(write_file(path, std::span<const uint8_t>(bytes)).ok());
        ASSERT_TRUE(found_or_harmless(folder(), before, found)) << "byte " << at;
        ++flips;
    }
    EXPECT_GT(found, flips / 20) << "most of a small index is free space; the rest must be found";
    for (size_t n = 0; n < whole.size(); n += long_tests() ? 64 : 997) {
        ASSERT_TRUE(write_file(path, std::span(whole).first(n)).ok());
        int refused = 0;
        ASSERT_TRUE(found_or_harmless(folder(), before, refused)) << "cut to " << n;
        ASSERT_EQ(refused, 1) << "cut to " << n;
    }
    ASSERT_TRUE(write_file(path, std::span<const uint8_t>(whole)).ok());
    EXPECT_TRUE(World::open(folder(), OpenMode::read)->verify()->issues.empty());
}

TEST_F(Store, EveryFlippedBitOfTheDescriptionIsFound) {
    { World world = create(desc(128, "oasis")); }
    const fs::path path = folder() / "world.json";
    const auto whole = read_file(path).value();
    for (size_t at = 0; at < whole.size(); at += long_tests() ? 1 : 7) {
        auto bytes = whole;
        bytes[at] ^= static_cast<uint8_t>(1u << (at % 8));
        ASSERT_TRUE(write_file(path, std::span<const uint8_t>(bytes)).ok());
        int found = 0;
        (void)found_or_harmless(folder(), "", found);
        ASSERT_EQ(found, 1) << "byte " << at;
    }
}

TEST_F(Store, AnEditOfTheDescriptionIsToldUntilItIsAccepted) {
    { World world = create(desc(128, "oasis")); }
    std::string text = read_text_file(folder() / "world.json").value();
    text.replace(text.find("\"seed\": 1"), 9, "\"seed\": 2");
    ASSERT_TRUE(write_file(folder() / "world.json", text).ok());
    auto reader = World::open(folder(), OpenMode::read);
    ASSERT_TRUE(reader.ok());
    EXPECT_EQ(reader->desc().seed, 2u);
    ASSERT_EQ(reader->verify()->issues.size(), 1u);
    EXPECT_EQ(reader->verify()->issues[0].path, "world.json");
    EXPECT_EQ(reader->accept_description().error().kind, ErrorKind::usage);
    auto writer = World::open(folder(), OpenMode::write);
    ASSERT_TRUE(writer->accept_description().ok());
    EXPECT_TRUE(writer->verify()->issues.empty());
}

TEST_F(Store, ATileThatTheBaseTerrainStillGivesCanBeMadeAgain) {
    std::vector<std::string> files;
    {
        World world = create(desc(128, "oasis"));
        auto block = LayerBlock::allocate(0, tile_rect({0, 0, 0}, 128), 0, k_state_layers);
        ASSERT_TRUE(world.surface().read(*block).ok());
        const LayerBlock other = make_tile({0, 1, 0}, 128);
        const std::vector<TileUpdate> updates = {{{0, 0, 0}, &*block}, {{0, 1, 0}, &other}};
        ASSERT_TRUE(world.commit(1, updates).ok());
    }
    for (const fs::path& file : tile_files()) fs::remove(file);
    const auto report = World::open(folder(), OpenMode::read)->verify();
    int yes = 0, no = 0;
    for (const VerifyIssue& issue : report->issues) {
        EXPECT_EQ(issue.what, "missing");
        if (issue.path.find("/L00/") == std::string::npos) continue;
        (issue.can_regenerate ? yes : no) += 1;
        EXPECT_EQ(issue.can_regenerate, issue.path.find("/0_0.") != std::string::npos) << issue.path;
    }
    EXPECT_EQ(yes, 1);
    EXPECT_EQ(no, 1);
}

TEST_F(Store, OpeningForWritingDeletesNoTileThatAnIndexLost) {
    {
        World world = create(desc());
        ASSERT_TRUE(commit_tiles(world, 1, {{0, 0, 0}}).ok());
        ASSERT_TRUE(commit_tiles(world, 2, {{0, 1, 0}}).ok());
    }
    const auto before = tile_files();
    {
        auto db = sqlite::Database::open(folder() / "index.sqlite", sqlite::Database::Mode::write);
        ASSERT_TRUE(db->run("DELETE FROM tiles WHERE level = 0 AND x = 0").ok());
    }
    std::ofstream(folder() / "tiles" / ".0_0.g3.exr.77.aside") << "on its way when the writer was killed";
    ASSERT_TRUE(World::open(folder(), OpenMode::write).ok());
    EXPECT_EQ(tile_files(), before) << "the lost tile is there, what was on its way is gone";
    const auto report = World::open(folder(), OpenMode::read)->verify();
    ASSERT_EQ(report->issues.size(), 1u);
    EXPECT_NE(report->issues[0].path.find("/0_0.g1.exr"), std::string::npos) << report->issues[0].path;
}

TEST_F(Store, AnIndexThatNamesForeignFilesIsRefused) {
    {
        World world = create(desc());
        ASSERT_TRUE(commit_tiles(world, 1, {{0, 0, 0}}).ok());
    }
    const fs::path bystander = base_ / "bystander.txt";
    std::ofstream(bystander) << "mine";
    {
        auto db = sqlite::Database::open(folder() / "index.sqlite", sqlite::Database::Mode::write);
        ASSERT_TRUE(db->run("UPDATE tiles SET file = '../bystander.txt' WHERE level = 0").ok());
    }
    const auto world = World::open(folder(), OpenMode::write);
    ASSERT_FALSE(world.ok());
    EXPECT_EQ(world.error().kind, ErrorKind::corrupt) << world.error().message;
    EXPECT_TRUE(fs::exists(bystander));
}

/// Runs in a child as a user for whom the folder is read-only.
int as_nobody(const std::function<int()>& body) {
    const pid_t child = fork();
    if (child == 0) {
        if (geteuid() == 0 && (setegid(65534) != 0 || seteuid(65534) != 0)) _exit(77);
        _exit(body());
    }
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST_F(Store, AReadOnlyFolderIsReadAndRefusedToWriters) {
    std::string before;
    {
        World world = create(desc());
        ASSERT_TRUE(commit_tiles(world, 1, {{0, 0, 0}}).ok());
        before = seen(world);
    }
    fs::permissions(base_, fs::perms(0755));
    const auto set = [&](mode_t folders, mode_t files) {
        for (const auto& e : fs::recursive_directory_iterator(folder()))
            ASSERT_EQ(chmod(e.path().c_str(), e.is_directory() ? folders : files), 0);
        ASSERT_EQ(chmod(folder().c_str(), folders), 0);
    };
    set(0555, 0444);
    const int code = as_nobody([&] {
        auto reader = World::open(folder(), OpenMode::read);
        if (!reader.ok() || seen(*reader) != before || !reader->verify()->issues.empty()) return 1;
        const auto writer = World::open(folder(), OpenMode::write);
        if (writer.ok() || writer.error().kind != ErrorKind::io) return 2;
        if (writer.error().message.find(folder().string()) == std::string::npos) return 3;
        const auto made = World::create(folder() / "inside", desc());
        return made.ok() || made.error().kind != ErrorKind::io ? 4 : 0;
    });
    // A log that a killed writer left, without the shared memory file that would let a reader play it back.
    set(0755, 0644);
    std::ofstream(folder() / "index.sqlite-wal") << std::string(8192, 'x');
    set(0555, 0444);
    const int with_log = as_nobody([&] {
        const auto reader = World::open(folder(), OpenMode::read);
        return reader.ok() || reader.error().kind != ErrorKind::io ? 1 : 0;
    });
    set(0755, 0644);
    if (code == 77) GTEST_SKIP() << "no right to become another user";
    EXPECT_EQ(code, 0);
    EXPECT_EQ(with_log, 0);
}

/// A disk that really runs full: a small memory disk of the child's own.
TEST_F(Store, ADiskThatRunsFullLeavesTheLastCommit) {
    constexpr int k_no_disk = 77;
    fs::create_directories(folder());
    const pid_t child = fork();
    if (child == 0) {
        if (unshare(CLONE_NEWNS) != 0 && unshare(CLONE_NEWUSER | CLONE_NEWNS) != 0) _exit(k_no_disk);
        (void)mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr);
        if (mount("none", folder().c_str(), "tmpfs", 0, "size=1200k") != 0) _exit(k_no_disk);
        std::string before;
        {
            auto world = World::create(folder(), desc());
            if (!world.ok()) _exit(1);
            bool full = false;
            for (int64_t step = 1; step < 100 && !full; ++step) {
                before = seen(*world);
                const Status s = commit_tiles(*world, step, {{0, step, 0}, {0, -step, 2}}, static_cast<int>(step));
                if (!s.ok() && s.error().kind != ErrorKind::io) _exit(2);
                full = !s.ok();
                if (full && step < 3) _exit(3);
            }
            if (!full || seen(*world) != before) _exit(4);
        }
        auto world = World::open(folder(), OpenMode::read);
        if (!world.ok() || seen(*world) != before) _exit(5);
        _exit(world->verify()->issues.empty() ? 0 : 6);
    }
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFEXITED(status));
    if (WEXITSTATUS(status) == k_no_disk) GTEST_SKIP() << "no right to mount a memory disk";
    EXPECT_EQ(WEXITSTATUS(status), 0);
}

TEST_F(Store, TilesThatCannotBeAreRefused) {
    World world = create(desc());
    const LayerBlock block = make_tile({0, 0, 0}, 128);
    const TileUpdate beyond{{0, int64_t{1} << 60, 0}, &block};
    EXPECT_EQ(world.commit(1, std::span(&beyond, 1)).error().kind, ErrorKind::usage);
    // A tile whose header asks for far more than its bytes can hold.
    auto flat = LayerBlock::allocate(0, tile_rect({0, 0, 0}, 128), 0, k_surface_layers);
    flat->clear();
    flat->ints(Layer::sand)(3, 4) = 1;
    const auto bytes = encode_tile(*make_stored_tile({0, 0, 0}, 128, *flat)).value();
    auto text = std::string(bytes.begin(), bytes.end());
    const size_t at = text.find(std::string("dataWindow\0box2i\0\x10\0\0\0", 21));
    ASSERT_NE(at, std::string::npos);
    for (const size_t coordinate : {8u, 12u}) {
        text[at + 21 + coordinate] = '\xFF';
        text[at + 21 + coordinate + 1] = '\x1F'; // 8191
    }
    const std::vector<uint8_t> huge(text.begin(), text.end());
    const auto decoded = decode_tile(huge, "huge");
    ASSERT_FALSE(decoded.ok());
    EXPECT_EQ(decoded.error().kind, ErrorKind::corrupt) << decoded.error().message;
}

TEST_F(Store, NumbersThatDoNotFitAreRefusedAndNotWrapped) {
    { World world = create(desc()); }
    const std::string json = read_text_file(folder() / "world.json").value();
    for (const auto& [from, to] :
         {std::pair<std::string, std::string>{"\"seed\": 1", "\"seed\": -1"},
          {"\"tile_cells\": 128", "\"tile_cells\": 4294967424"},
          {"\"format_version\": 2", "\"format_version\": 4294967298"},
          {"\"outside_m\": 0.0", "\"outside_m\": 1e300"},
          {"\"outside_m\": 0.0", "\"outside_m\": 1e400"},
          {"\"outside_m\": 0.0", "\"outside_m\": 0.0, \"sea_m\": 1e9"},
          {"\"outside_m\": 0.0", "\"outside_m\": 0.0, \"georeference\": {\"cell_x\": 1e300}"}}) {
        std::string changed = json;
        ASSERT_NE(changed.find(from), std::string::npos) << from;
        changed.replace(changed.find(from), from.size(), to);
        ASSERT_TRUE(write_file(folder() / "world.json", changed).ok());
        const auto opened = World::open(folder(), OpenMode::read);
        ASSERT_FALSE(opened.ok()) << to;
        EXPECT_NE(opened.error().message.find("world.json"), std::string::npos) << opened.error().message;
    }
}

} // namespace
} // namespace sahel::store_test
