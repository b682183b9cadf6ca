// A surface that deforms: its forms at even times of the shutter. In between, its control points go along lines.
#pragma once

#include "geometry/shape.h"
#include "splines/bezier_patch.h"

#include <memory>
#include <vector>

namespace rayleaf {

class Moments {
  public:
    Moments() = default;
    /// Shapes of one kind, in one frame, with the same elements; at least two.
    explicit Moments(std::vector<std::unique_ptr<const Shape>> shapes) : shapes_(std::move(shapes)) {}

    size_t steps() const { return shapes_.size(); }
    const Shape& operator[](size_t step) const { return *shapes_[step]; }
    /// Local space, at all times.
    Box3f bounds() const;
    /// Of shapes whose content is known.
    void add_to(ContentHasher& hasher) const;
    size_t bytes() const;

  private:
    std::vector<std::unique_ptr<const Shape>> shapes_;
};

/// Control points between two moments.
void mix_points(const Vec4d* from, const Vec4d* to, double share, size_t count, Vec4d* result);
/// The same for a point whose parameters are given: where weights do not change, it goes along a line as well.
PatchPoint mixed(const PatchPoint& from, const PatchPoint& to, double share);

}  // namespace rayleaf
