// The levels of a mip map: each half as large as the one before.
#pragma once

#include "textures/picture.h"

namespace rayleaf {

/// The next coarser level of a prepared picture: half as many pixels a side, rounded down, at least one. A pixel is the
/// mean over its share of the finer level's area, so nothing is lost or counted twice where a side is odd. Rows in
/// parallel, the same bits for any number of threads. Throws Cancelled soon
/// after `cancel` says so.
Picture coarser_level(const Picture& level, const CancelToken& cancel);

}  // namespace rayleaf
