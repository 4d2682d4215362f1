#pragma once

#include "streaming/scene_file.h"
#include "world/file_io.h"
#include "world/params_json.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

namespace sahel::test {

inline std::filesystem::path scene_data(const std::string& name) {
    return std::filesystem::path(SAHEL_SOURCE_DIR) / "tests" / "data" / name;
}

/// A test scene as JSON, to be changed and parsed.
inline Json scene_json(const std::string& name) {
    const auto text = read_text_file(scene_data(name));
    SAHEL_CHECK(text.ok());
    const auto json = parse_json(*text, name);
    SAHEL_CHECK(json.ok());
    return *json;
}

/// The folder of the published scenes, or empty: a copy of the data beside the sources.
inline std::filesystem::path published_scenes(const char* folder) {
    const std::filesystem::path path =
        std::filesystem::path(SAHEL_SOURCE_DIR).parent_path() / "shared" / "data" / folder;
    return std::filesystem::is_directory(path) ? path : std::filesystem::path();
}

/// A folder that goes with the test.
class TemporaryFolder {
  public:
    TemporaryFolder() {
        std::string pattern = (std::filesystem::temp_directory_path() / "sahel-scene-XXXXXX").string();
        SAHEL_CHECK(mkdtemp(pattern.data()) != nullptr);
        path_ = pattern;
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    ~TemporaryFolder() { std::filesystem::remove_all(path_); }
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
};

} // namespace sahel::test
