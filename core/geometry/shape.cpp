#include "geometry/shape.h"

namespace rayleaf {

LocalFrame LocalFrame::fitting(const Box3d& box) {
    LocalFrame frame;
    if (box.isEmpty()) return frame;
    frame.center = (box.min + box.max) * 0.5;
    const double half = max_component(box.max - box.min) * 0.5;
    if (half > 0.0) frame.scale = std::exp2(std::ceil(std::log2(half)));
    return frame;
}

}  // namespace rayleaf
