#include "tessellation/swept_fill_cells.h"

#include "tessellation/filled_area.h"

#include <algorithm>
#include <optional>

namespace rayleaf {
namespace {

using Rung = FillCells::Rung;
using Triangle = std::array<uint32_t, 3>;

/// Finds triangles by their edges.
class Neighbours {
  public:
    explicit Neighbours(const std::vector<Triangle>& triangles) : triangles_(triangles), used_(triangles.size()) {
        edges_.reserve(3 * triangles.size());
        for (uint32_t t = 0; t < triangles.size(); ++t)
            for (size_t k = 0; k < 3; ++k) edges_.push_back({triangles[t][k], triangles[t][(k + 1) % 3], t});
        std::sort(edges_.begin(), edges_.end());
    }
    bool used(uint32_t triangle) const { return used_[triangle]; }
    void use(uint32_t triangle) { used_[triangle] = true; }
    /// An unused triangle with the edge from one corner to another.
    std::optional<uint32_t> unused(uint32_t from, uint32_t to) const {
        const std::array<uint32_t, 3> first{from, to, 0};
        for (auto edge = std::lower_bound(edges_.begin(), edges_.end(), first);
             edge != edges_.end() && (*edge)[0] == from && (*edge)[1] == to; ++edge)
            if (!used_[(*edge)[2]]) return (*edge)[2];
        return std::nullopt;
    }
    uint32_t third(uint32_t triangle, uint32_t from, uint32_t to) const {
        for (size_t k = 0; k < 3; ++k)
            if (triangles_[triangle][k] == from && triangles_[triangle][(k + 1) % 3] == to)
                return triangles_[triangle][(k + 2) % 3];
        return to;
    }

  private:
    const std::vector<Triangle>& triangles_;
    std::vector<bool> used_;
    std::vector<std::array<uint32_t, 3>> edges_;  ///< from, to, triangle
};

/// A strip that begins with a triangle, at a side without an unused neighbour if it has one. From rung to rung the
/// right end advances, or the left one, or first the right and then the left one: one or two triangles, as a cell is
/// divided.
std::vector<Rung> strip_from(uint32_t first, const Triangle& corners, Neighbours& neighbours) {
    size_t side = 0;
    while (side < 2 && neighbours.unused(corners[(side + 1) % 3], corners[side])) ++side;
    Rung rung{corners[(side + 1) % 3], corners[side]};
    std::vector<Rung> strip{rung};
    bool right_alone = false;
    for (std::optional<uint32_t> triangle = first; triangle;) {
        neighbours.use(*triangle);
        const uint32_t next = neighbours.third(*triangle, rung.right, rung.left);
        const std::optional<uint32_t> by_right = neighbours.unused(next, rung.left),
                                      by_left = neighbours.unused(rung.right, next);
        if (by_left && (right_alone || !by_right)) {
            rung.left = next;
            triangle = by_left;
            if (right_alone)
                strip.back() = rung;
            else
                strip.push_back(rung);
            right_alone = false;
        } else {
            rung.right = next;
            triangle = by_right;
            strip.push_back(rung);
            right_alone = true;
        }
    }
    return strip;
}

}  // namespace

FillCells::FillCells(std::vector<FixedVertex> vertices, const std::vector<uint32_t>& begins, FillFacing facing)
    : vertices_(std::move(vertices)) {
    std::vector<AreaPoint> points;
    points.reserve(vertices_.size());
    for (const FixedVertex& vertex : vertices_)
        points.push_back({static_cast<double>(vertex[0]), static_cast<double>(vertex[1])});
    std::vector<Triangle> triangles = triangles_of_area(points, begins);
    if (facing == FillFacing::Downwards)
        for (Triangle& triangle : triangles) std::swap(triangle[1], triangle[2]);
    Neighbours neighbours(triangles);
    for (uint32_t t = 0; t < triangles.size(); ++t)
        if (!neighbours.used(t)) add_strip(strip_from(t, triangles[t], neighbours));
    fill_up_grid();
    rungs_.shrink_to_fit();
}

/// Adds a strip; between two strips lie rungs without length.
void FillCells::add_strip(const std::vector<Rung>& strip) {
    constexpr size_t kLeast = 4;  // two in between, and a cell
    const size_t held = rungs_.size() % kGridVertices;
    if (held > 0 && held + kLeast > kGridVertices) fill_up_grid();
    if (rungs_.size() % kGridVertices > 0) {
        rungs_.push_back({rungs_.back().left, rungs_.back().left});
        rungs_.push_back({strip.front().left, strip.front().left});
    }
    for (const Rung& rung : strip) {
        if (!rungs_.empty() && rungs_.size() % kGridVertices == 0 && &rung != &strip.front())
            rungs_.push_back((&rung)[-1]);
        rungs_.push_back(rung);
    }
}

void FillCells::fill_up_grid() {
    while (rungs_.size() % kGridVertices > 0) rungs_.push_back({rungs_.back().left, rungs_.back().left});
}

void FillCells::place(uint32_t grid, Vec3d (&vertices)[kGridVertices][kGridVertices]) const {
    const auto vertex = [&](uint32_t number) {
        const FixedVertex& v = vertices_[number];
        return Vec3d(v[0], v[1], v[2]) * kFixedStep;
    };
    for (uint32_t j = 0; j < kGridVertices; ++j) {
        const Rung& rung = rungs_[grid * kGridVertices + j];
        vertices[j][0] = vertex(rung.left);
        for (int i = 1; i < kGridVertices; ++i) vertices[j][i] = vertex(rung.right);
    }
}

size_t FillCells::bytes() const {
    return sizeof(*this) + vertices_.capacity() * sizeof(FixedVertex) + rungs_.capacity() * sizeof(Rung);
}

}  // namespace rayleaf
