// The instruction sets of the kernels that meet grids: those of all kernels.
#pragma once

#include "base/simd.h"
