#include "tessellation/level.h"

#include "base/hash64.h"

#include <bit>
#include <cmath>

namespace rayleaf {
namespace {

/// Facets nearer to the surface than the first differ by rounding only; quads shorter than the second have no shape.
constexpr float kSmallestDistance = 0x1p-22f, kSmallestQuad = 0x1p-18f;

/// A border is never assumed nearer than this share of its half length: for a ray that starts within it, its distance
/// says little (trace/dicing.cpp does the same for patches).
constexpr float kNearestShare = 0.05f;

/// Codes of lengths are eighths of powers of two above 2^-28.
constexpr int kSteps = 8, kLowestExponent = -28;

struct CodedLengths {
    float value[256];

    CodedLengths() {
        value[0] = 0.0f;
        for (int code = 1; code < 256; ++code)
            value[code] = static_cast<float>(std::exp2(static_cast<double>(code) / kSteps + kLowestExponent));
    }
};
const CodedLengths kCoded;

/// The smallest k with 16^k >= `quads_squared`, at most the finest level. NaN gives the coarsest.
int level_for(float quads_squared) {
    int level = 0;
    for (int k = 0; k < kFinestLevel; ++k)
        level += quads_squared > static_cast<float>(quads_along(k) * quads_along(k)) ? 1 : 0;
    return level;
}

Vec3d at(const GridRows& rows, int index) {
    return {rows.vertices[0][index], rows.vertices[1][index], rows.vertices[2][index]};
}

/// A line of vertices of a grid.
struct Line {
    int first, stride;

    int operator()(int k) const { return first + k * stride; }
};
constexpr int kLast = kGridVertices - 1;
constexpr Line kBorderLines[kBorders] = {
    {0, 1}, {kLast, kGridVertices}, {kLast * kGridVertices, 1}, {0, kGridVertices}};
constexpr Line kMiddleLines[2] = {{kLast / 2 * kGridVertices, 1}, {kLast / 2, kGridVertices}};

/// The length of two chords: their sum does not depend on the direction.
double length(const GridRows& rows, const Line& line) {
    const Vec3d begin = at(rows, line(0)), middle = at(rows, line(kLast / 2)), end = at(rows, line(kLast));
    return (middle - begin).length() + (end - middle).length();
}

/// From the largest squared second difference, less that of a straight line by rounding: three sums of coordinates up
/// to 1.
double second_difference(float squared) {
    return std::max(0.0, std::sqrt(double{squared}) - 0x1p-22);
}

/// A parabola is an eighth of its second difference away from its chord; the factor 16² refers it to one segment.
constexpr double kBendPerDifference = 256.0 / 8.0;

/// Whether two borders have the same ends, in either direction, and the same lengths: then they are given the same
/// levels.
bool same_border(const SubpatchDetail& a, int i, const SubpatchDetail& b, int j) {
    if (a.length[i] != b.length[j] || a.bend[i] != b.bend[j]) return false;
    const auto same_end = [&](int end, int other) {
        const int at = kBorderEnds[static_cast<size_t>(i)][static_cast<size_t>(end)];
        const int there = kBorderEnds[static_cast<size_t>(j)][static_cast<size_t>(other)];
        return a.corners[0][at] == b.corners[0][there] && a.corners[1][at] == b.corners[1][there] &&
               a.corners[2][at] == b.corners[2][there];
    };
    return (same_end(0, 0) && same_end(1, 1)) || (same_end(0, 1) && same_end(1, 0));
}

/// Gives the borders that a subpatch shares with an anchored one the anchored levels.
void take_shared(const SubpatchDetail& detail, const SubpatchDetail& anchored, const SubpatchLevels& anchored_levels,
                 SubpatchLevels& levels) {
    for (int i = 0; i < kBorders; ++i)
        for (int j = 0; j < kBorders; ++j)
            if (same_border(detail, i, anchored, j)) levels.border[i] = anchored_levels.border[j];
}

/// Squared distances from a place to the middles between the ends of the borders.
Float4 squared_distances(const SubpatchDetail& detail, const float (&place)[3]) {
    Float4 from[3];
    for (int axis = 0; axis < 3; ++axis) {
        const Float4 corners = load4(detail.corners[axis]);
        const Float4 ends = shuffled<0, 1, 2, 0>(corners) + shuffled<1, 3, 3, 2>(corners);  // as kBorderEnds has them
        from[axis] = 0.5f * ends - place[axis];
    }
    return from[0] * from[0] + from[1] * from[1] + from[2] * from[2];
}

/// A number in [0,1) that depends on the ray only, for stochastic rounding.
float ray_random(const Vec3d& origin, const Vec3d& direction) {
    uint64_t state = 0;
    for (const Vec3d& v : {origin, direction}) {
        for (int axis = 0; axis < 3; ++axis) state = hash64(state + std::bit_cast<uint64_t>(v[axis]) + kHashStep);
    }
    return static_cast<float>(state >> 40) * 0x1p-24f;
}

}  // namespace

uint8_t DetailCode::of(double length) {
    const auto value = static_cast<float>(length);
    if (!(value > 0.0f)) return 0;
    const auto bits = std::bit_cast<uint32_t>(value);
    const int exponent = static_cast<int>(bits >> 23) - 127;
    const float mantissa = std::bit_cast<float>((bits & 0x007fffffu) | 0x3f800000u);  // in [1,2)
    // 2^(k/8), rounded up.
    constexpr float kEighths[kSteps] = {1.0f,        1.09050775f, 1.18920720f, 1.29683964f,
                                        1.41421366f, 1.54221094f, 1.68179297f, 1.83400810f};
    int beyond = 0;
    for (const float eighth : kEighths) beyond += mantissa > eighth ? 1 : 0;
    return static_cast<uint8_t>(std::clamp(kSteps * (exponent - kLowestExponent) + beyond, 1, 255));
}

float DetailCode::length(uint8_t code) {
    return kCoded.value[code];
}

SubpatchDetail detail_of(const GridRows& rows, const GridMeasure& measure) {
    SubpatchDetail detail{};
    for (int axis = 0; axis < 3; ++axis)
        for (int k = 0; k < kCorners; ++k)
            detail.corners[axis][k] = rows.vertices[axis][(k / 2 * kGridVertices + k % 2) * kLast];
    double longest = 0.0;
    for (int i = 0; i < kBorders; ++i) {
        const double here = length(rows, kBorderLines[i]);
        longest = std::max(longest, here);
        detail.length[i] = DetailCode::of(here);
        detail.bend[i] = DetailCode::of(second_difference(measure.border[i]) * kBendPerDifference);
    }
    for (const Line& line : kMiddleLines) longest = std::max(longest, length(rows, line));
    detail.inner_length = DetailCode::of(longest);
    // The distance of facets by second derivatives, as in splines/bounds.h: (uu + 2 uv + vv) / 8.
    const double inner =
        second_difference(measure.uu) + 2.0 * second_difference(measure.uv) + second_difference(measure.vv);
    detail.inner_bend = DetailCode::of(inner * kBendPerDifference);
    return detail;
}

float fine_facet_distance(const SubpatchDetail& detail) {
    return DetailCode::length(detail.inner_bend) / static_cast<float>(kGridCells * kGridCells);
}

float longest_line(const SubpatchDetail& detail) {
    return DetailCode::length(detail.inner_length);
}

LevelSight::LevelSight(const LevelRule& rule, const Vec3d& origin, const Vec3d& direction, const RayBeam& beam,
                       float stretch)
    : fixed_(rule.resolution == LevelRule::Resolution::Single || !beam.has_width()),
      distance_(rule.distance),
      stretch_(stretch) {
    for (int axis = 0; axis < 3; ++axis) origin_[axis] = static_cast<float>(origin[axis]);
    // One level is a factor of sixteen in quads, so a random fraction of it rounds down with the right probability.
    if (rule.rounding == LevelRule::Rounding::Stochastic) rounding_ = std::exp2(-4.0f * ray_random(origin, direction));
    const float squared = rule.factor * rule.factor;
    for (int i = 0; i < 2; ++i) {
        const RayBeam::Side& side = beam.sides[i];
        beam_.sides[i] = {side.a * squared, side.b * squared, side.c * squared};
        narrowest_[i] = side.b < 0.0f && side.c > 0.0f ? -0.5f * side.b / side.c : 0.0f;
    }
    same_sides_ =
        beam.sides[0].a == beam.sides[1].a && beam.sides[0].b == beam.sides[1].b && beam.sides[0].c == beam.sides[1].c;
}

/// The least widths between two distances: the geometric mean of the two sides, since neither suits the facets of a
/// beam that is wide one way and narrow the other.
Float4 LevelSight::widths(Float4 near, Float4 far) const {
    const auto squared = [&](int i) {
        const Float4 t = min4(max4(all4(narrowest_[i]), near), far);
        const RayBeam::Side& side = beam_.sides[i];
        return max4(side.a + t * (side.b + t * side.c), Float4{});
    };
    const Float4 first = squared(0);
    return same_sides_ ? sqrt4(first) : sqrt4(sqrt4(first * squared(1)));
}

void LevelChooser::anchor(const SubpatchDetail& detail, uint32_t subpatch, uint32_t packed_levels) {
    SubpatchLevels levels = SubpatchLevels::unpacked(packed_levels);
    for (int i = 0; i < anchors_; ++i) {
        if (anchor_[i].subpatch == subpatch) return;  // the first one counts
        take_shared(detail, *anchor_[i].detail, anchor_[i].levels, levels);
    }
    levels.raise_own();
    anchor_[anchors_++] = {&detail, subpatch, levels};
}

/// All four borders at once. Each point of a border is within half its length of the middle between its ends.
SubpatchLevels LevelSight::by_width(const SubpatchDetail& detail) const {
    const Float4 away = sqrt4(squared_distances(detail, origin_));
    const auto coded = [](const uint8_t* codes) {
        return Float4{kCoded.value[codes[0]], kCoded.value[codes[1]], kCoded.value[codes[2]], kCoded.value[codes[3]]};
    };
    const Float4 border = coded(detail.length), half = 0.5f * border;
    const Float4 wide = widths(max4(away - half, kNearestShare * half), (away + half) * stretch_);
    const Float4 quads = border / max4(wide, all4(kSmallestQuad));
    const Float4 bent = coded(detail.bend) / max4(distance_ * wide, all4(kSmallestDistance));
    const Float4 wanted = min4(quads * quads, bent) * rounding_;
    const float finest_width = least_of(wide);
    const float inner_quads = kCoded.value[detail.inner_length] / std::max(finest_width, kSmallestQuad);
    const float inner_bent = kCoded.value[detail.inner_bend] / std::max(distance_ * finest_width, kSmallestDistance);
    const float inner = std::min(inner_quads * inner_quads, inner_bent) * rounding_;
    if (largest_of(wanted) <= 1.0f && inner <= 1.0f) return {{kCoarse, kCoarse, kCoarse, kCoarse}, kCoarse};
    SubpatchLevels levels;
    for (int i = 0; i < kBorders; ++i) levels.border[i] = static_cast<uint8_t>(level_for(wanted[i]));
    levels.own = static_cast<uint8_t>(level_for(inner));
    return levels;
}

void LevelChooser::see_nearby(const LevelSight& before, const Vec3d& place, float reach) {
    before_ = before;
    for (int axis = 0; axis < 3; ++axis) place_[axis] = static_cast<float>(place[axis]);
    reach_squared_ = reach * reach;
}

/// Borders near `place_`, one bit each.
uint32_t LevelChooser::nearby_borders(const SubpatchDetail& detail) const {
    return at_most(squared_distances(detail, place_), reach_squared_);
}

SubpatchLevels LevelChooser::seen_by_two(const SubpatchDetail& detail) const {
    const uint32_t nearby = nearby_borders(detail);
    if (nearby == 0) return own_.levels(detail);
    const SubpatchLevels before = before_.levels(detail);
    if (nearby == kAllBorders) return before;
    SubpatchLevels levels = own_.levels(detail);
    levels.own = std::max(levels.own, before.own);
    for (int i = 0; i < kBorders; ++i)
        if ((nearby >> i & 1u) != 0) levels.border[i] = before.border[i];
    return levels;
}

SubpatchLevels LevelChooser::with_anchors(const SubpatchDetail& detail, uint32_t subpatch) const {
    for (int i = 0; i < anchors_; ++i)
        if (anchor_[i].subpatch == subpatch) return anchor_[i].levels;
    SubpatchLevels levels = seen(detail);
    for (int i = 0; i < anchors_; ++i) take_shared(detail, *anchor_[i].detail, anchor_[i].levels, levels);
    levels.raise_own();
    return levels;
}

}  // namespace rayleaf
