// A bevelled curve: profiles swept along splines, and the flat caps at their ends.
//
// An element is a piece of a spline (splines/sweep_path.h) with a whole profile around it, or a cap. Elements are
// numbered profile by profile, within one spline by spline along u; then come the caps, and last filled areas.
// Parameters of a hit: u along the piece, v around the profile (splines/sweep_profile.h), each in [0,1]; on a cap the
// place in the square around the profile.
//
// The texture coordinate is Blender's: u along the spline from 0 at the bevel's start to 1 at its end, v around the
// profile. Normals are those of the exact surface, which has corners where the profile or the spline has.
#pragma once

#include "geometry/shape.h"
#include "geometry/swept_curve.h"
#include "geometry/swept_fills.h"
#include "splines/curve_taper.h"
#include "splines/sweep_path.h"
#include "splines/sweep_profile.h"

#include <memory>
#include <string>
#include <vector>

namespace rayleaf {

enum class CapEnd : uint8_t { Begin, End };

enum class SweptPart : uint8_t { Wall, Cap, Fill };

/// What an element is.
struct SweptElement {
    SweptPart part = SweptPart::Wall;
    uint32_t profile = 0;
    uint32_t piece = 0;          ///< of a wall
    uint32_t spline = 0;         ///< of a cap
    CapEnd end = CapEnd::Begin;  ///< of a cap
    uint32_t fill = 0;           ///< of a fill
};

/// |P_u x P_v|² of less than this share of |P_u|² |P_v|² counts as degenerate, as on patches.
inline constexpr double kDegenerateWall = 1e-20;

/// A place on a wall, without its ring.
struct WallPlace {
    const SweepPiece* piece = nullptr;
    double u = 0;                       ///< along the piece
    ProfilePoint around;                ///< of the profile, by the part's own parameter
    Vec2f uv{0, 0};                     ///< the texture coordinate
    double length_u = 1, length_v = 1;  ///< of the piece and of the profile's part in it
    bool smooth = true;
};

class SweptSurface final : public Shape {
  public:
    /// Splines that Blender draws nothing for are left out. Invalid data throws InputError.
    explicit SweptSurface(const SweptCurveDescription& curve);

    uint32_t element_count() const override { return first_fill() + static_cast<uint32_t>(fills_.size()); }
    LocalSurface surface(const LocalHit& hit) const override { return surface(hit, SurfaceDetail::Curvature); }
    LocalSurface surface_without_curvature(const LocalHit& hit) const override {
        return surface(hit, SurfaceDetail::Normal);
    }
    std::optional<Vec4f> attribute(AttributeId, const LocalHit&) const override { return std::nullopt; }
    uint32_t material_slot(const LocalHit& hit) const override;
    uint32_t element_of(const LocalHit& hit) const override { return hit.primitive; }
    ElementPoint element_point(uint32_t element, const Vec2f& parameters) const override;
    size_t bytes() const override;

    /// Local space.
    const SweepPath& path() const { return path_; }
    const std::vector<SweepProfile>& profiles() const { return profiles_; }
    /// Whether the open ends of a spline are closed.
    bool has_caps() const { return caps_; }

    uint32_t wall_element(uint32_t profile, uint32_t piece) const {
        return profile * static_cast<uint32_t>(path_.pieces.size()) + piece;
    }
    uint32_t cap_element(uint32_t profile, uint32_t spline, CapEnd end) const {
        return first_cap() + 2 * (profile * static_cast<uint32_t>(path_.splines.size()) + spline) +
               (end == CapEnd::End ? 1 : 0);
    }
    const std::vector<SweptFill>& fills() const { return fills_; }
    uint32_t fill_element(uint32_t fill) const { return first_fill() + fill; }
    SweptElement element(uint32_t index) const;
    WallPlace wall_place(const LocalHit& hit, const SweptElement& wall) const;
    /// The ring at an end of a spline.
    SweepRing end_ring(const SweepSpline& spline, CapEnd end) const;
    /// A place of a profile's plane as parameters of a cap, and back.
    Vec2f cap_parameters(uint32_t profile, const Vec2d& place) const;
    Vec2d cap_place(uint32_t profile, const Vec2f& parameters) const;
    /// The outward direction of a cap, not unit; zero where the ring is a point.
    Vec3d cap_normal(const SweepRing& ring, CapEnd end) const;

  private:
    struct Group {
        uint32_t material_slot = 0;
        bool smooth = true;
    };
    SweepPath path_;
    std::vector<SweepProfile> profiles_;
    std::vector<double> extents_;                   ///< of the profiles
    std::vector<std::vector<Vec2d>> cap_outlines_;  ///< of the profiles, for points of caps
    std::unique_ptr<CurveTaper> taper_;
    std::vector<Group> groups_;
    std::vector<SweptFill> fills_;
    bool caps_ = false;
    ContentHash described_{};  ///< what it was made from

    std::optional<ContentHash> hash_of_content() const override;
    uint32_t first_cap() const { return static_cast<uint32_t>(profiles_.size() * path_.pieces.size()); }
    uint32_t cap_count() const {
        return caps_ ? static_cast<uint32_t>(2 * profiles_.size() * path_.splines.size()) : 0;
    }
    uint32_t first_fill() const { return first_cap() + cap_count(); }
    void build_path(const SweptCurveDescription& curve);
    void fit_frame(const Vec3d& center, double extent);
    const Group& group_of(const SweptElement& element) const;  ///< of no fill
    LocalSurface surface(const LocalHit& hit, SurfaceDetail detail) const;
    LocalSurface wall_surface(const LocalHit& hit, const SweptElement& element, SurfaceDetail detail) const;
    LocalSurface cap_surface(const LocalHit& hit, const SweptElement& element) const;
};

/// The profiles of a curve: those given, or the round one; offset included.
std::vector<SweepProfile> sweep_profiles(const SweptCurveDescription& curve);

}  // namespace rayleaf
