#include "splines/outline_crossings.h"

#include <algorithm>
#include <vector>

namespace rayleaf {
namespace {

struct Edge {
    Vec2d a{0, 0}, b{0, 0};
    double low() const { return std::min(a.y, b.y); }
    double high() const { return std::max(a.y, b.y); }
};

double side(const Edge& edge, const Vec2d& point) {
    return (edge.b - edge.a).cross(point - edge.a);
}

bool cross(const Edge& one, const Edge& other) {
    return side(one, other.a) * side(one, other.b) < 0.0 && side(other, one.a) * side(other, one.b) < 0.0;
}

}  // namespace

/// A sweep line moves over the edges from left to right; each edge is compared with those that overlap it along x.
bool outlines_cross(std::span<const Vec2f> points, std::span<const uint32_t> begins) {
    std::vector<Edge> edges;
    edges.reserve(points.size());
    for (size_t k = 0; k + 1 < begins.size(); ++k) {
        for (uint32_t i = begins[k]; i < begins[k + 1]; ++i) {
            const Vec2d a(points[i]), b(points[i + 1 == begins[k + 1] ? begins[k] : i + 1]);
            edges.push_back(a.x <= b.x ? Edge{a, b} : Edge{b, a});
        }
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& e, const Edge& f) { return e.a.x < f.a.x; });
    std::vector<const Edge*> passed;
    for (const Edge& edge : edges) {
        std::erase_if(passed, [&](const Edge* other) { return other->b.x < edge.a.x; });
        for (const Edge* other : passed)
            if (other->low() <= edge.high() && other->high() >= edge.low() && cross(edge, *other)) return true;
        passed.push_back(&edge);
    }
    return false;
}

}  // namespace rayleaf
