// The choice of the processor's kernels, for those that keep pointers to theirs.
#pragma once

#include "base/simd.h"

#include <hwy/targets.h>

namespace rayleaf {

/// Makes the choice, if nobody has: pointers to kernels must be taken after that. Asking the processor takes long.
inline void choose_kernels() {
    if (!hwy::GetChosenTarget().IsInitialized()) hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace rayleaf
