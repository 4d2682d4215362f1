#pragma once

#include <nlohmann/json_fwd.hpp>

/// The name of JSON values for headers that only pass them on: the library itself costs a source about two seconds.
namespace sahel {

using Json = nlohmann::ordered_json;

} // namespace sahel
