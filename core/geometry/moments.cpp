#include "geometry/moments.h"

namespace rayleaf {

Box3f Moments::bounds() const {
    Box3f box;
    for (const std::unique_ptr<const Shape>& shape : shapes_) box.extendBy(shape->bounds());
    return box;
}

void Moments::add_to(ContentHasher& hasher) const {
    for (const std::unique_ptr<const Shape>& shape : shapes_)
        for (const uint64_t word : *shape->content_hash()) hasher.add(word);
}

size_t Moments::bytes() const {
    size_t total = 0;
    for (const std::unique_ptr<const Shape>& shape : shapes_) total += shape->bytes();
    return total;
}

void mix_points(const Vec4d* from, const Vec4d* to, double share, size_t count, Vec4d* result) {
    for (size_t i = 0; i < count; ++i) result[i] = from[i] + (to[i] - from[i]) * share;
}

PatchPoint mixed(const PatchPoint& from, const PatchPoint& to, double share) {
    const auto between = [share](const Vec3d& a, const Vec3d& b) { return a + (b - a) * share; };
    return {between(from.position, to.position), between(from.du, to.du),   between(from.dv, to.dv),
            between(from.duu, to.duu),           between(from.duv, to.duv), between(from.dvv, to.dvv)};
}

}  // namespace rayleaf
