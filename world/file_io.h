#pragma once

#include "world/result.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Whole files. A file is written aside, synced, renamed, and its folder synced: after a kill or a power cut at any
/// instant the old file or the new one is there, whole.
namespace sahel {

/// Errors: not_found (names the file), io, budget (larger than `max_bytes`).
Result<std::vector<uint8_t>> read_file(const std::filesystem::path& path, uint64_t max_bytes = uint64_t{1} << 32);
Result<std::string> read_text_file(const std::filesystem::path& path, uint64_t max_bytes = uint64_t{1} << 28);

/// Replaces or creates the file; missing parent folders are made. After an error nothing has changed. Errors: io.
Status write_file(const std::filesystem::path& path, std::span<const uint8_t> bytes);
Status write_file(const std::filesystem::path& path, std::string_view text);

/// The name under which `path` is written before it is renamed: in the same folder, one for each process.
std::filesystem::path aside_path(const std::filesystem::path& path);
/// Syncs a finished file written at `aside`, renames it to `path`, syncs the folder. The aside file is removed on
/// error.
Status commit_aside_file(const std::filesystem::path& aside, const std::filesystem::path& path);
/// Makes a folder and its parents. Errors: io.
Status make_folder(const std::filesystem::path& folder);
/// Makes names created, renamed or removed in a folder durable. Errors: io.
Status sync_folder(const std::filesystem::path& folder);

} // namespace sahel
