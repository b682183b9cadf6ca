// Which instruction sets the SIMD kernels are compiled for; Highway picks the best one the machine has at run time.
// Results are the same bits on all of them: each lane does the same operations, and none is a fused multiply-add.
#pragma once

// Widths of 4, 8 and 16 lanes, and the baseline. Targets in between would only make the library larger.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
