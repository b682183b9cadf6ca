#include "tessellation/simd_targets.h"

#include "base/simd.h"

#include <hwy/highway.h>
#include <hwy/targets.h>

namespace rayleaf {
namespace {

/// Calls `visit` with each target that is compiled in and that the machine supports; best first.
template <typename Visit>
void for_each_target(const Visit& visit) {
    // Asked once, before a choice hides the others from Highway.
    static const int64_t usable = HWY_TARGETS & hwy::SupportedTargets();
    for (int64_t bits = usable; bits != 0; bits &= bits - 1) visit(bits & -bits);
}

}  // namespace

std::vector<std::string> simd_targets() {
    std::vector<std::string> names;
    for_each_target([&](int64_t target) { names.emplace_back(hwy::TargetName(target)); });
    return names;
}

bool use_simd_target(const std::string& name) {
    hwy::DisableTargets(0);
    int64_t chosen = 0;
    for_each_target([&](int64_t target) {
        if (name == hwy::TargetName(target)) chosen = target;
    });
    if (!name.empty() && chosen == 0) return false;
    if (!name.empty()) hwy::DisableTargets(~chosen);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());  // for kernels that are chosen at each call
    return true;
}

}  // namespace rayleaf
