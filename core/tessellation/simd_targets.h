// The instruction sets that the kernels have versions for, and a way to choose among them: for tests.
#pragma once

#include <string>
#include <vector>

namespace rayleaf {

/// Names of those this machine can run, the best one first.
std::vector<std::string> simd_targets();
/// From now on new scenes use this one; an empty name: the best. Not while others trace. False for an unknown name.
bool use_simd_target(const std::string& name);

}  // namespace rayleaf
