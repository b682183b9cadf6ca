// What stands in the way of a light's rays, or of those of some lights close together: the planes of the surfaces that
// few rays meet, by direction. Lights are chosen by it (lights/light_tree.h). It is a guess, which costs noise where it
// is wrong: a light that does not seem to arrive is chosen less often, and never not at all.
//
// Directions are told apart by an octahedron whose faces are folded onto a square (Cigolle et al., "A Survey of
// Efficient Representations for Independent Unit Vectors", JCGT 2014).
#pragma once

#include "base/float4.h"
#include "base/vector.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rayleaf {

class LightView {
  public:
    /// Cells along each side of the square, and rays in each cell.
    static constexpr size_t kSide = 10, kCells = kSide * kSide, kRays = 4;

    /// The unit direction of a ray of a cell: they stand in even steps on the square.
    static Vec3d direction(size_t cell, size_t ray);
    /// That the ray has met a surface: its unit normal on the light's side, and where it is as seen from the light.
    void set(size_t cell, size_t ray, const Vec3d& normal, const Vec3d& offset);
    /// Whether nothing stands anywhere.
    bool is_open() const;

    /// About what share of the light gets to `offset` from its middle, which is not zero, past those planes; at least
    /// `kLeastShare`.
    float share(const Vec3f& offset) const {
        // A plane is lit itself, and so is what it is an estimate of.
        constexpr float kSlack = 1.25f;
        const Planes& planes = planes_[cell_of(offset)];
        const Float4 depth = planes.x * offset.x + planes.y * offset.y + planes.z * offset.z;
        const Float4 arrives = depth > kSlack ? Float4{} : all4(1.0f / kRays);
        return kLeastShare + (1.0f - kLeastShare) * sum_of(arrives);
    }

  private:
    static constexpr float kLeastShare = 0.15f;
    /// Of a cell's rays: vectors whose product with the offset of a point of the plane is 1, and with what is farther
    /// more; zero where nothing stands.
    struct Planes {
        Float4 x{}, y{}, z{};
    };
    std::array<Planes, kCells> planes_{};

    static size_t cell_of(const Vec3f& offset) {
        const float scale = 1.0f / (std::abs(offset.x) + std::abs(offset.y) + std::abs(offset.z));
        const float x = offset.x * scale, y = offset.y * scale;
        const bool folded = offset.z < 0.0f;
        const float u = folded ? std::copysign(1.0f - std::abs(y), x) : x;
        const float v = folded ? std::copysign(1.0f - std::abs(x), y) : y;
        return kSide * step_of(v) + step_of(u);
    }
    /// The place of a number of -1..1 among the cells of a side.
    static size_t step_of(float place) {
        constexpr float kHalf = 0.5f * float{kSide}, kMost = float{kSide - 1};
        return static_cast<size_t>(std::clamp((place + 1.0f) * kHalf, 0.0f, kMost));
    }
};

}  // namespace rayleaf
