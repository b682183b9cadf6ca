#include "tessellation/shared_sides.h"

#include <algorithm>
#include <map>
#include <vector>

namespace rayleaf {
namespace {

/// The coordinates of a border's control points, in the direction that makes them lexicographically less; empty for a
/// pole, which is a single point.
std::vector<double> border_key(const PatchView& patch, int across, bool at_end) {
    const int count = across == 0 ? patch.rows() : patch.columns();
    const Vec4d* const first =
        across == 0 ? patch.points + (at_end ? patch.degree_u : 0) : patch.row(at_end ? patch.degree_v : 0);
    const size_t stride = across == 0 ? patch.stride : 1;
    bool is_pole = true;
    std::vector<double> forward, backward;
    for (int i = 0; i < count; ++i) {
        const Vec4d &here = first[static_cast<size_t>(i) * stride],
                    &back = first[static_cast<size_t>(count - 1 - i) * stride];
        is_pole = is_pole && here == *first;
        for (int axis = 0; axis < 4; ++axis) {
            forward.push_back(here[axis]);
            backward.push_back(back[axis]);
        }
    }
    if (is_pole) return {};
    return std::min(forward, backward);
}

}  // namespace

SharedSides::SharedSides(const PatchSurface& surface) : groups_(2 * surface.splines().size()) {
    if (surface.splines().size() < 2) return;
    std::map<std::vector<double>, uint32_t> known;
    for (size_t s = 0; s < surface.splines().size(); ++s) {
        const SplinePatches& spline = surface.splines()[s];
        const auto columns = static_cast<uint32_t>(spline.spans_u.size());
        const auto rows = static_cast<uint32_t>(spline.spans_v.size());
        const auto add = [&](uint32_t column, uint32_t row, int across, bool at_end) {
            std::vector<double> key =
                border_key(surface.patch(spline.first_patch + row * columns + column), across, at_end);
            if (key.empty()) return;
            const uint32_t along = number(s, 1 - across);
            groups_.join(along, known.try_emplace(std::move(key), along).first->second);
        };
        for (uint32_t row = 0; row < rows; ++row) {
            add(0, row, 0, false);
            add(columns - 1, row, 0, true);
        }
        for (uint32_t column = 0; column < columns; ++column) {
            add(column, 0, 1, false);
            add(column, rows - 1, 1, true);
        }
    }
}

}  // namespace rayleaf
