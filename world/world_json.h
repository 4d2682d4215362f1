#pragma once

#include "world/world.h"

#include <string>
#include <string_view>

/// world.json: what a person may read and edit.
namespace sahel {

std::string world_json(const WorldDesc& desc);
/// Strict: an unknown key, a wrong type or a value out of range names `where`, the key and the range; a newer
/// format_version is refused (unsupported).
Result<WorldDesc> parse_world_json(std::string_view text, std::string_view where);
/// Errors: usage (what a new world cannot be).
Status check_world_desc(const WorldDesc& desc, std::string_view where);

} // namespace sahel
