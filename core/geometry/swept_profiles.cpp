#include "geometry/swept_surface.h"
#include "splines/bernstein.h"
#include "splines/sweep_elements.h"

#include <numbers>

namespace rayleaf {
namespace {

constexpr double kQuarter = std::numbers::pi / 2;

ProfilePart arc(const Vec2d& center, double radius, double first, double angle, double pieces) {
    ProfilePart part;
    part.kind = ProfilePartKind::Arc;
    part.center = center;
    part.radius = radius;
    part.first_angle = first;
    part.angle = angle;
    part.pieces = pieces;
    return part;
}

ProfilePart line(const Vec2d& begin, const Vec2d& end) {
    ProfilePart part;
    part.begin = begin;
    part.end = end;
    return part;
}

/// The round profile, counter-clockwise from the lower end of the back, as in Blender.
SweepProfile round_profile(const SweptCurveDescription& curve) {
    const double depth = curve.bevel_depth, extrude = curve.extrude, x = curve.offset;
    const double pieces = curve.bevel_resolution + 1.0;
    const Vec2d low(x, -extrude), high(x, extrude);
    SweepProfile profile;
    std::vector<ProfilePart>& parts = profile.parts;
    profile.closed = curve.fill == BevelFill::Full && depth != 0.0;
    if (depth == 0.0) {
        if (extrude != 0.0) parts.push_back(line(low, high));
        return profile;
    }
    if (extrude == 0.0 && curve.fill == BevelFill::Full) {
        // Blender's first point is one step away from N.
        const double steps = 2 * pieces + 2;
        parts.push_back(arc(low, depth, 4 * kQuarter / steps, 4 * kQuarter, steps));
        return profile;
    }
    const Vec2d right(depth, 0), left(-depth, 0);
    const bool back = curve.fill != BevelFill::Front, front = curve.fill != BevelFill::Back;
    if (back) parts.push_back(arc(low, depth, -kQuarter, kQuarter, pieces));
    if (extrude != 0.0) parts.push_back(line(low + right, high + right));
    if (front) parts.push_back(arc(high, depth, 0.0, kQuarter, pieces));
    if (!profile.closed) return profile;
    parts.push_back(arc(high, depth, kQuarter, kQuarter, pieces));
    if (extrude != 0.0) parts.push_back(line(high + left, low + left));
    parts.push_back(arc(low, depth, 2 * kQuarter, kQuarter, pieces));
    return profile;
}

void add_profiles(const CurveSplines& splines, double offset, std::vector<SweepProfile>& profiles) {
    size_t first = 0;
    for (const uint32_t count : splines.counts) {
        std::vector<SweepControl> controls;
        const SweepElements elements = sweep_elements(splines, first, count, Vec3d(-offset, 0, 0), controls);
        first += count;
        SweepProfile profile;
        profile.closed = elements.closed;
        for (const SweepElement& element : elements.elements) {
            const SweepSegment& segment = element.segment;
            const SweepControl* control = &controls[segment.first_control];
            ProfilePart part;
            if (segment.degree == 1) {
                const Vec3d begin = project(control[0].point), end = project(control[1].point);
                part = line({begin.x, begin.y}, {end.x, end.y});
            } else {
                part.kind = ProfilePartKind::Bezier;
                part.curve = {segment.degree, segment.rational, {}};
                for (int i = 0; i <= segment.degree; ++i) part.curve.points.push_back(control[i].point);
            }
            part.pieces = segment.share_end - segment.share_begin;
            profile.parts.push_back(std::move(part));
        }
        if (!profile.parts.empty()) profiles.push_back(std::move(profile));
    }
}

}  // namespace

std::vector<SweepProfile> sweep_profiles(const SweptCurveDescription& curve) {
    std::vector<SweepProfile> profiles;
    if (curve.profile) {
        for (const CurveSplines& splines : *curve.profile) add_profiles(splines, curve.offset, profiles);
        return profiles;
    }
    SweepProfile round = round_profile(curve);
    if (!round.parts.empty()) profiles.push_back(std::move(round));
    return profiles;
}

}  // namespace rayleaf
