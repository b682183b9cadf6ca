// Light through media along a segment of a ray: what gets through, what they emit, and where they scatter it.
//
// Media that are the same everywhere are exact: distances are sampled by one channel's extinction, weighed by the mean
// of all channels' densities. Media that vary are tracked by null collisions (Woodcock et al. 1965) with weights by
// channel (Novak et al. 2018, sections 4 and 5); nowhere are they denser than their bound says.
#pragma once

#include "base/random_stream.h"
#include "integrators/medium_stack.h"
#include "shading/closures.h"

#include <optional>

namespace rayleaf {

/// From the origin of a ray, in media that are not empty.
struct MediumSegment {
    const Scene& scene;
    const MediumStack& media;
    const Ray& ray;
    double end = 0;  ///< world units; may be infinite
    PathState state;

    Vec3f outgoing() const { return -Vec3f(ray.direction); }
    /// All media together at a place of it: `medium` and `emission` of the result.
    Closures at(double t) const;
};

class SegmentBounds;

/// The share of light that gets through. Of media that vary an estimate.
Color transmittance(const MediumSegment& segment, RandomStream& random);
/// Of a segment that `bounds` are of, or of a part of it from its origin.
Color transmittance(const MediumSegment& segment, const SegmentBounds& bounds, RandomStream& random);

/// What becomes of light that goes along a segment.
struct MediumPassage {
    Color weight{1, 1, 1};    ///< of light at the end, or at the scattering but for the phase function
    Color emission{0, 0, 0};  ///< of all the segment, seen from its origin
    std::optional<double> t;  ///< where it is scattered
    MediumClosures medium;    ///< there
};

/// Of a path that carries `throughput`. `bounds`: of the segment.
MediumPassage pass(const MediumSegment& segment, const SegmentBounds& bounds, const Color& throughput,
                   const Vec2f& distance, RandomStream& random);

/// Of one that gets to the end, whatever is scattered. `first`: a random number for what is
/// emitted, spread evenly over the samples of a pixel.
MediumPassage pass_unscattered(const MediumSegment& segment, float first, RandomStream& random);

/// A place on the segment from which sampled light is to be looked for.
struct LitPlace {
    double t = 0;
    Color weight{0, 0, 0};  ///< transmittance up to there over the density of the choice, and of the technique
    MediumClosures medium;
};

/// By distance, and by the light that arrives, weighed by the balance heuristic. Empty where nothing scatters. `place`:
/// which technique, and where.
std::optional<LitPlace> place_of_light(const MediumSegment& segment, const SegmentBounds& bounds,
                                       const Color& throughput, const PassedLights& passed, const Vec2f& place,
                                       RandomStream& random);

/// How far along the segment scattering is likely, for the choice of a light.
double likely_distance(const MediumSegment& segment, const SegmentBounds& bounds, float random);

}  // namespace rayleaf
