#include "geometry/limit_quadtree.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace rayleaf {
namespace {

constexpr size_t kRegular = 4;  ///< faces at a vertex

/// The mean of a quad's corners.
Vec3d middle(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
    return (a + b + c + d) * 0.25;
}

/// A corner with the ends of its edges and the opposite corners of its quads, alternately, as CornerRing.
CornerRing ring_of_quads(const Vec3d& center, const std::vector<Vec3d>& around) {
    CornerRing ring;
    ring.center = center;
    const size_t count = around.size();
    for (size_t i = 0; i < count; i += 2) {
        ring.edges.push_back(around[i]);
        ring.face_middles.push_back(middle(center, around[i], around[i + 1], around[(i + 2) % count]));
    }
    return ring;
}

/// Weights of a uniform cubic B-spline and their derivatives.
struct SplineWeights {
    double value[4], first[4], second[4];

    explicit SplineWeights(double t) {
        const double s = 1.0 - t, tt = t * t, ss = s * s;
        constexpr double kSixth = 1.0 / 6.0;
        value[0] = ss * s * kSixth;
        value[3] = tt * t * kSixth;
        value[1] = 2.0 / 3.0 - tt * (1.0 - 0.5 * t);
        value[2] = 2.0 / 3.0 - ss * (1.0 - 0.5 * s);
        first[0] = -0.5 * ss;
        first[3] = 0.5 * tt;
        first[1] = t * (1.5 * t - 2.0);
        first[2] = s * (2.0 - 1.5 * s);
        second[0] = s;
        second[1] = 3.0 * t - 2.0;
        second[2] = 3.0 * s - 2.0;
        second[3] = t;
    }
};

inline Vec3d combined(const double* weights, const Vec3d* points, std::ptrdiff_t stride) {
    return (points[0] * weights[0] + points[stride] * weights[1]) +
           (points[2 * stride] * weights[2] + points[3 * stride] * weights[3]);
}

}  // namespace

/// A face after one step of subdivision, by Catmull and Clark's rules.
class LimitQuadtree::Refined {
  public:
    explicit Refined(const std::vector<CornerRing>& corners) : middle_(corners[0].face_middles[0]) {
        for (const CornerRing& ring : corners) corners_.emplace_back(ring);
    }

    size_t size() const { return corners_.size(); }
    bool is_regular(size_t corner) const { return corners_[corner].edges.size() == kRegular; }
    /// The rings of the part at a corner of a quad; the part has the direction of the quad.
    std::vector<CornerRing> part_of_quad(size_t corner) const;
    /// The same, beginning at the corner; of a face of any size.
    std::vector<CornerRing> part_from(size_t corner) const;
    /// A quad's 5 x 5 points.
    void fill(std::array<Vec3d, kSide * kSide>& points) const;

  private:
    /// New points at a corner, on its edges and in its faces; in the order of CornerRing.
    struct Corner {
        Vec3d vertex{0, 0, 0};
        std::vector<Vec3d> edges, faces;

        explicit Corner(const CornerRing& ring) : faces(ring.face_middles) {
            const size_t count = ring.edges.size();
            Vec3d ends(0.0), middles(0.0);
            for (size_t i = 0; i < count; ++i) {
                const Vec3d &before = faces[(i + count - 1) % count], &after = faces[i];
                edges.push_back((ring.center + ring.edges[i] + before + after) * 0.25);
                ends += ring.edges[i];
                middles += after;
            }
            const auto n = static_cast<double>(count);
            vertex = (ring.center * (n - 2.0) + (ends + middles) / n) / n;
        }
    };
    Vec3d middle_;
    std::vector<Corner> corners_;

    const Corner& at(size_t corner) const { return corners_[corner % corners_.size()]; }
    const Vec3d& edge(size_t corner) const { return at(corner).edges[0]; }

    CornerRing at_vertex(size_t corner) const {
        const Corner& c = at(corner);
        std::vector<Vec3d> around;
        for (size_t i = 0; i < c.edges.size(); ++i) {
            around.push_back(c.edges[i]);
            around.push_back(c.faces[i]);
        }
        return ring_of_quads(c.vertex, around);
    }
    enum class First { ToMiddle, ToNextCorner };
    /// Around the new point on the edge from a corner to the next one.
    CornerRing at_edge(size_t corner, First first) const {
        const Corner &here = at(corner), &next = at(corner + 1);
        const Vec3d &previous_edge = here.edges[1], &outside_edge = here.edges.back();
        std::vector<Vec3d> around{middle_,           previous_edge, here.vertex, outside_edge,
                                  here.faces.back(), next.edges[2], next.vertex, next.edges[0]};
        if (first == First::ToNextCorner) std::rotate(around.begin(), around.begin() + 6, around.end());
        return ring_of_quads(edge(corner), around);
    }
    /// Around the new point in the face, from the edge before a corner.
    CornerRing at_middle(size_t corner) const {
        std::vector<Vec3d> around;
        for (size_t i = 0; i < size(); ++i) {
            around.push_back(edge(corner + size() - 1 + i));
            around.push_back(at(corner + i).vertex);
        }
        return ring_of_quads(middle_, around);
    }
};

std::vector<CornerRing> LimitQuadtree::Refined::part_from(size_t corner) const {
    return {at_vertex(corner), at_edge(corner, First::ToMiddle), at_middle(corner),
            at_edge(corner + size() - 1, First::ToNextCorner)};
}

std::vector<CornerRing> LimitQuadtree::Refined::part_of_quad(size_t corner) const {
    std::vector<CornerRing> part = part_from(corner);
    std::rotate(part.begin(), part.end() - static_cast<std::ptrdiff_t>(corner), part.end());
    return part;
}

void LimitQuadtree::Refined::fill(std::array<Vec3d, kSide * kSide>& points) const {
    points[2 * kSide + 2] = middle_;
    for (size_t corner = 0; corner < 4; ++corner) {
        const Corner& c = corners_[corner];
        const auto set = [&](size_t i, size_t j, const Vec3d& point) {  // as of the first corner, turned by quarters
            for (size_t k = 0; k < corner; ++k) std::tie(i, j) = std::pair(kSide - 1 - j, i);
            points[j * kSide + i] = point;
        };
        set(1, 1, c.vertex);
        set(2, 1, c.edges[0]);
        set(0, 2, c.faces[1]);
        set(0, 1, c.edges[2]);
        set(1, 0, c.edges.back());
        set(0, 0, c.faces[2]);  // meaningless at irregular corners
    }
}

LimitQuadtree::LimitQuadtree(const std::vector<CornerRing>& corners) {
    const Refined face(corners);
    if (face.size() == 4) {
        quads_ = 1;
        nodes_.resize(1);
        fill(0, face, kQuadtreeSteps - 1);
    } else {
        quads_ = face.size();
        nodes_.resize(quads_);
        for (size_t i = 0; i < quads_; ++i) fill(i, Refined(face.part_from(i)), kQuadtreeSteps - 2);
    }
    nodes_.shrink_to_fit();
}

void LimitQuadtree::fill(size_t node, const Refined& quad, int steps_left) {
    quad.fill(nodes_[node].points);
    for (size_t part = 0; part < 4; ++part) {
        if (quad.is_regular(part)) continue;
        if (steps_left == 0) {
            nodes_[node].parts[part] = kNothing;
            continue;
        }
        const size_t child = nodes_.size();
        nodes_[node].parts[part] = static_cast<int32_t>(child);
        nodes_.emplace_back();
        fill(child, Refined(quad.part_of_quad(part)), steps_left - 1);
    }
}

std::optional<LimitQuadtree::InPatch> LimitQuadtree::find(size_t quad, Vec2d at) const {
    double per_quad = 1.0;
    for (const Node* node = &nodes_[quad];;) {
        const bool far_u = at.x >= 0.5, far_v = at.y >= 0.5;
        at = {at.x * 2.0 - (far_u ? 1.0 : 0.0), at.y * 2.0 - (far_v ? 1.0 : 0.0)};
        per_quad *= 2.0;
        const int32_t part = node->parts[far_v ? (far_u ? 2 : 3) : (far_u ? 1 : 0)];
        if (part == kPatch) return InPatch{&node->points[(far_v ? kSide : 0) + (far_u ? 1 : 0)], at, per_quad};
        if (part == kNothing) return std::nullopt;
        node = &nodes_[static_cast<size_t>(part)];
    }
}

std::optional<Vec3d> LimitQuadtree::position(size_t quad, const Vec2d& parameters) const {
    return Walk(*this).position(quad, parameters);
}

std::optional<Vec3d> LimitQuadtree::Walk::position(size_t quad, const Vec2d& parameters) {
    const std::optional<InPatch> in = tree_->find(quad, parameters);
    if (!in) return std::nullopt;
    if (points_ != in->points || v_ != in->at.y) {
        points_ = in->points;
        v_ = in->at.y;
        const SplineWeights weights(v_);
        for (int i = 0; i < 4; ++i) columns_[i] = combined(weights.value, points_ + i, kSide);
    }
    return combined(SplineWeights(in->at.x).value, columns_, 1);
}

std::optional<PatchPoint> LimitQuadtree::evaluate(size_t quad, const Vec2d& parameters) const {
    const std::optional<InPatch> in = find(quad, parameters);
    if (!in) return std::nullopt;
    const SplineWeights u(in->at.x), v(in->at.y);
    Vec3d value[4], first[4], second[4];
    for (int i = 0; i < 4; ++i) {
        const Vec3d* column = in->points + i;
        value[i] = combined(v.value, column, kSide);
        first[i] = combined(v.first, column, kSide);
        second[i] = combined(v.second, column, kSide);
    }
    const double k = in->per_quad, kk = k * k;
    return PatchPoint{combined(u.value, value, 1),      combined(u.first, value, 1) * k,
                      combined(u.value, first, 1) * k,  combined(u.second, value, 1) * kk,
                      combined(u.first, first, 1) * kk, combined(u.value, second, 1) * kk};
}

}  // namespace rayleaf
