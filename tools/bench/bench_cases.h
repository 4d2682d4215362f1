#pragma once

/// What `sahel bench` measures. Every case reports the hash of what it made: a fast wrong answer must not look like
/// progress.
namespace sahel::tools {

/// `memory_gb_per_s`: measured bandwidth of the machine, for the share of it that a case reaches; 0: unknown.
void register_benchmarks(double memory_gb_per_s);

} // namespace sahel::tools
