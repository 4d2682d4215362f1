#include "tests/fuzz/fuzz_target.h"

#include <unistd.h>

namespace sahel::fuzz {

std::vector<Target>& targets() {
    static std::vector<Target> all;
    return all;
}

namespace {
struct Scratch {
    Scratch() {
        // Memory disk where there is one: targets write a file per input.
        const std::filesystem::path shm = "/dev/shm";
        std::error_code error;
        const auto base = std::filesystem::is_directory(shm, error) ? shm : std::filesystem::temp_directory_path();
        std::string pattern = (base / "sahel-fuzz-XXXXXX").string();
        expect(mkdtemp(pattern.data()) != nullptr, "a scratch folder can be made");
        path = pattern;
    }
    ~Scratch() {
        std::error_code ignored;
        std::filesystem::remove_all(path, ignored);
    }
    std::filesystem::path path;
};
} // namespace

const std::filesystem::path& scratch_folder() {
    static const Scratch scratch;
    return scratch.path;
}

} // namespace sahel::fuzz
