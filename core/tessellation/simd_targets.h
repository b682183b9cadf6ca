// The instruction sets that the kernels have versions for, and a way to choose among them: for tests.
#pragma once

#include <string>
#include <vector>

namespace rayleaf {

/// Names of those this machine can run, the best one first.
std::vector<std::string> simd_targets();
/// New scenes use this target; an empty name: the best one. No other thread may trace. False for an unknown name.
bool use_simd_target(const std::string& name);

}  // namespace rayleaf
