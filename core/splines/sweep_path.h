// The rings of a swept curve: for every place along its splines, the centre and the two directions of the profile.
//
// A path consists of pieces. A curved piece is a part of a Bezier segment along which the tangent turns by less than
// about kMostTurn. Its frame is that at its start, carried to each point by the smallest rotation, plus a cubic for the
// additional angle of the twist method (for minimum twist: the difference between the smallest rotation and the
// rotation minimizing frame), plus the tilt. A ruled piece joins two rings linearly: Blender's straight segments, and
// the rings at one point where the direction jumps. Rings and derivatives are exact everywhere; nothing is sampled.
#pragma once

#include "base/vector.h"
#include "splines/stack_buffer.h"

#include <array>
#include <cstdint>
#include <vector>

namespace rayleaf {

/// The profile point (x, y) lies at center + x across + y up.
struct SweepRing {
    Vec3d center{0, 0, 0}, across{0, 0, 0}, up{0, 0, 0};

    Vec3d at(const Vec2d& p) const { return center + across * p.x + up * p.y; }
    Vec3d vector(const Vec2d& p) const { return across * p.x + up * p.y; }
};

/// A ring and how it changes with the piece's parameter.
struct SweepRingPoint {
    SweepRing ring, change;
};

/// A control point of a segment in homogeneous form: w times position, radius and tilt.
struct SweepControl {
    Vec4d point{0, 0, 0, 1};
    double radius = 1, tilt = 0;

    SweepControl operator-(const SweepControl& b) const { return {point - b.point, radius - b.radius, tilt - b.tilt}; }
    SweepControl operator*(double factor) const { return {point * factor, radius * factor, tilt * factor}; }
    SweepControl& operator+=(const SweepControl& b) {
        point += b.point;
        radius += b.radius;
        tilt += b.tilt;
        return *this;
    }
};

struct SweepSegment {
    uint32_t first_control = 0;
    uint8_t degree = 3;
    bool rational = false;
    double share_begin = 0, share_end = 1;  ///< of the whole spline, in Blender's pieces
    double size = 0;                        ///< the largest distance of neighbouring control points, times the degree
    float taper_begin = 0, taper_end = 1;   ///< of the taper
    float turn_begin = 0, turn_end = 0;     ///< closing twist of a cyclic spline, radians; linear in between
};

enum class SweepPieceKind : uint8_t { Curved, Ruled };

struct SweepPiece {
    double begin = 0, end = 1;  ///< curved: parameters of the segment. Ruled: shares of the spline
    uint32_t source = 0;        ///< curved: the segment. Ruled: the first of two rings
    SweepPieceKind kind = SweepPieceKind::Curved;
    Vec3f tangent{0, 0, 1}, normal{1, 0, 0};  ///< at the begin of a curved piece: the frame that is carried
    std::array<float, 3> twist{};             ///< angle s (a + s (b + s c)), s from 0 to 1 over the piece
};

/// The pieces of one spline.
struct SweepSpline {
    uint32_t first_piece = 0, piece_count = 0;
    uint32_t group = 0;                        ///< of the description's `splines`
    double share_begin = 0, share_length = 1;  ///< of the whole spline, what the pieces cover
    bool closed = false;
    bool capped = true;  ///< its ends are closed if the curve has caps
};

/// A factor along each spline that multiplies or replaces the points' radius.
class SweepTaper {
  public:
    virtual ~SweepTaper() = default;
    struct Factor {
        double value = 1, slope = 0;  ///< slope by share
    };
    /// The factor at a share of the spline.
    virtual Factor at(double share) const = 0;
};

/// Planar: the profile's y runs along z, and the tangent is taken without its z.
enum class SweepSpace : uint8_t { Planar, Spatial };

/// A point of a segment: position, unit direction, their derivatives by the segment's parameter, radius and tilt.
/// `second` is zero where the segment does not bend.
struct SegmentPoint {
    Vec3d position{0, 0, 0}, first{0, 0, 0}, second{0, 0, 0}, tangent{0, 0, 1}, tangent_change{0, 0, 0};
    double radius = 1, radius_change = 0, tilt = 0, tilt_change = 0;
};

/// The radius of a ring for that of the points: (factor * radius + added) / scale.
struct RadiusRule {
    double factor = 1, factor_change = 0, added = 0, added_change = 0;
};

/// A place on a curved piece, and what evaluating it takes beside the segment's control points.
struct CurvedPlace {
    const SweepSegment* segment = nullptr;
    const SweepControl* controls = nullptr;
    double t = 0, length = 1;                 ///< the segment's parameter, and how it changes with the piece's
    Vec3d tangent{0, 0, 1}, normal{1, 0, 0};  ///< the frame that is carried
    double turn = 0, turn_change = 0;         ///< of the frame, the tilt apart; its change by t
    RadiusRule radius;                        ///< changes by t
};

/// The derivative of a segment counts as zero below this share of its control points' distances.
inline constexpr double kStandstill = 1e-10;

struct SweepPath {
    SweepSpace space = SweepSpace::Spatial;
    std::vector<SweepControl> controls;
    std::vector<SweepSegment> segments;
    std::vector<SweepPiece> pieces;
    std::vector<SweepRing> rings;  ///< of ruled pieces
    std::vector<SweepSpline> splines;
    /// None: the points' radius is used. Else that of the taper, alone, times or plus the points'.
    enum class TaperUse : uint8_t { None, Override, Multiply, Add } taper_use = TaperUse::None;
    const SweepTaper* taper = nullptr;
    double scale = 1;  ///< of all lengths in rings: what the points were divided by

    /// The ring at parameter u in [0,1] of a piece, with derivatives by u.
    SweepRingPoint evaluate(const SweepPiece& piece, double u) const;
    SweepRing ring(const SweepPiece& piece, double u) const { return evaluate(piece, u).ring; }
    /// The piece's part of its spline's shares.
    double share(const SweepPiece& piece, double u) const;
    double share_length(const SweepPiece& piece) const;
    SegmentPoint point(const SweepSegment& segment, double t) const;
    CurvedPlace place(const SweepPiece& piece, double u) const;
    /// At a share of the taper, which changes so much.
    RadiusRule radius_rule(double taper_share, double share_change) const;
    const SweepSpline& spline_of(uint32_t piece) const;
    size_t bytes() const;

  private:
    /// `basis_at` makes the basis at a parameter of the segment.
    template <typename BasisAt>
    SweepRingPoint ring_at(const CurvedPlace& place, const BasisAt& basis_at) const;
};

}  // namespace rayleaf
