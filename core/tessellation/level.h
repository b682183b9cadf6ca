// How finely a ray sees a subpatch: a level for each of its borders and one for its inside.
//
// Level k means 4^k quads along a side: coarse 1, medium 4, fine 16 as in Christensen et al. 2003, section 5.2; beyond
// that a subpatch is split on demand, 4 x 4 parts per level. A level suffices if its quads are no longer than the ray
// is wide, as in the paper, or if its facets are nearer to the surface than a small share of that width: flat surfaces
// need no small quads.
//
// No cracks: the level of a border is a function of the ray and of numbers that both its neighbours hold with the same
// bits. A subpatch is diced at the finest of its five levels, and its borders are snapped to coarser ones when a ray
// meets it (tessellation/snapped_grid.h).
#pragma once

#include "base/float4.h"
#include "base/vector.h"
#include "rays/hit.h"
#include "rays/ray.h"
#include "tessellation/grid.h"
#include "tessellation/grid_measure.h"

#include <array>
#include <cstdint>

namespace rayleaf {

inline constexpr int kCoarse = 0, kMedium = 1, kFine = 2;
inline constexpr int kStoredLevels = 3;
/// 1024 quads along a side of a subpatch: finer than single precision resolves.
inline constexpr int kFinestLevel = 5;

/// 4^level.
constexpr int quads_along(int level) {
    return 1 << (2 * level);
}

struct SubpatchLevels {
    std::array<uint8_t, kBorders> border{kFine, kFine, kFine, kFine};
    uint8_t own = kFine;  ///< of the dicing: no border's is higher

    uint32_t packed() const {
        uint32_t bits = own;
        for (int i = 0; i < kBorders; ++i) bits |= uint32_t{border[i]} << (4 * (i + 1));
        return bits;
    }
    static SubpatchLevels unpacked(uint32_t bits) {
        SubpatchLevels levels;
        levels.own = bits & 15u;
        for (int i = 0; i < kBorders; ++i) levels.border[i] = bits >> (4 * (i + 1)) & 15u;
        return levels;
    }
    /// Raises the own level to that of the finest border.
    void raise_own() {
        for (const uint8_t level : border) own = level > own ? level : own;
    }
    bool operator==(const SubpatchLevels&) const = default;
};

/// The level of a packed set at which the subpatch was diced.
inline int own_level(uint32_t packed) {
    return static_cast<int>(packed & 15u);
}

/// The data by which levels of a subpatch are chosen, and its coarse level: one cache line. Lengths are in local space,
/// rounded up to the next eighth of a power of two (DetailCode).
struct alignas(64) SubpatchDetail {
    float corners[3][kCorners];  ///< by axis, the corner (i, j) at j * 2 + i
    uint8_t length[kBorders];    ///< of a border
    /// 256 times the distance of a border from its 16 segments: n segments lie within this over n².
    uint8_t bend[kBorders];
    uint8_t inner_length, inner_bend;  ///< the same for the whole subpatch: its longest line, its facets
    uint8_t unused[6];
};

/// Positive lengths as bytes: 2^(code/8 - 28), code 0 is zero.
class DetailCode {
  public:
    static uint8_t of(double length);
    static float length(uint8_t code);
};

/// Longest line of a subpatch, local units.
float longest_line(const SubpatchDetail& detail);
/// The detail of a diced subpatch. The numbers of a border do not depend on its direction.
SubpatchDetail detail_of(const GridRows& rows, const GridMeasure& measure);
/// Bound on the distance of the surface from fine facets, local units.
float fine_facet_distance(const SubpatchDetail& detail);

/// How levels follow from a ray's width.
struct LevelRule {
    /// The wanted length of quads in ray widths.
    float factor = 1.0f;
    /// The distance that facets may have from the surface, in ray widths times `factor`.
    float distance = 0.1f;
    /// Levels are rounded up or down at random for each ray, with the probability of the share beyond (Christensen et
    /// al. 2003, section 7.1); else up.
    enum class Rounding : uint8_t { Up, Stochastic } rounding = Rounding::Up;
    /// All rays see fine grids: the single resolution that the paper compares with.
    enum class Resolution : uint8_t { Multiple, Single } resolution = Resolution::Multiple;
};

/// How finely one ray sees subpatches, in one shape's local space.
class LevelSight {
  public:
    /// Sees fine grids, like a ray without a width.
    LevelSight() = default;
    /// In local space. Places at a distance d from the origin are met at a `t` of the beam from d to `stretch` d.
    LevelSight(const LevelRule& rule, const Vec3d& origin, const Vec3d& direction, const RayBeam& beam, float stretch);

    /// The own level is that of the inside only.
    SubpatchLevels levels(const SubpatchDetail& detail) const { return fixed_ ? SubpatchLevels{} : by_width(detail); }

  private:
    bool fixed_ = true;  ///< the ray has no width: fine
    float distance_ = 0, origin_[3] = {0, 0, 0}, stretch_ = 1;
    RayBeam beam_;            ///< times the rule's factor
    float narrowest_[2]{};    ///< t at which a side of the beam is
    bool same_sides_ = true;  ///< of the beam
    float rounding_ = 1;      ///< the wanted number of quads is multiplied by this

    Float4 widths(Float4 near, Float4 far) const;
    SubpatchLevels by_width(const SubpatchDetail& detail) const;
};

/// Chooses levels for one ray in one shape's local space.
class LevelChooser {
  public:
    LevelChooser() = default;
    explicit LevelChooser(const LevelSight& own) : own_(own) {}

    /// The ray sees fine grids, as one without a width.
    void see_fine() {
        own_ = {};
        reach_squared_ = -1.0f;
    }
    /// Borders whose middles are within `reach` of a place are seen with another ray's width.
    void see_nearby(const LevelSight& before, const Vec3d& place, float reach);
    /// Adds a subpatch with fixed levels.
    void anchor(const SubpatchDetail& detail, uint32_t subpatch, uint32_t packed_levels);
    SubpatchLevels levels(const SubpatchDetail& detail, uint32_t subpatch) const {
        if (anchors_ != 0) return with_anchors(detail, subpatch);
        SubpatchLevels levels = seen(detail);
        levels.raise_own();
        return levels;
    }
    /// The ray whose width decided about the whole subpatch.
    SeenBy seen_by(const SubpatchDetail& detail) const {
        return reach_squared_ >= 0.0f && nearby_borders(detail) == kAllBorders ? SeenBy::RayBefore : SeenBy::Itself;
    }

  private:
    struct Anchor {
        const SubpatchDetail* detail;
        uint32_t subpatch;
        SubpatchLevels levels;
    };
    static constexpr uint32_t kAllBorders = (1u << kBorders) - 1;
    LevelSight own_, before_;
    float place_[3] = {0, 0, 0}, reach_squared_ = -1;  ///< where `before_` holds; nowhere if negative
    int anchors_ = 0;
    std::array<Anchor, 2> anchor_{};

    SubpatchLevels seen(const SubpatchDetail& detail) const {
        return reach_squared_ < 0.0f ? own_.levels(detail) : seen_by_two(detail);
    }
    SubpatchLevels seen_by_two(const SubpatchDetail& detail) const;
    uint32_t nearby_borders(const SubpatchDetail& detail) const;
    SubpatchLevels with_anchors(const SubpatchDetail& detail, uint32_t subpatch) const;
};

}  // namespace rayleaf
