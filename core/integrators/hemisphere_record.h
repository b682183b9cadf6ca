// What a sampled hemisphere says of its surroundings: irradiance and occlusion at a point, how they change when the
// surface turns and when the point moves, and how far away what it saw is.
//
// Gradients of a stratified, cosine-weighted hemisphere: G. Ward, P. Heckbert, Irradiance Gradients (1992), section 2.
// Rotation: each cell's cosine changes. Translation: the walls between cells move, the nearer of the two surfaces
// deciding how fast.
#pragma once

#include "base/vector.h"

#include <array>
#include <vector>

namespace rayleaf {

/// Light over a hemisphere: irradiance, and for `free` that of a white sky. For a single ray: radiance.
struct HemisphereLight {
    Color direct{0, 0, 0};    ///< of the world, seen straight
    Color indirect{0, 0, 0};  ///< by way of other surfaces
    Color free{0, 0, 0};      ///< what is not hidden within the occlusion distance

    HemisphereLight& operator+=(const HemisphereLight& other);
    HemisphereLight operator*(float factor) const;
};

/// Change of each channel along three axes.
struct HemisphereGradient {
    std::array<HemisphereLight, 3> along;

    void add(const Vec3f& axis, const HemisphereLight& change);
    HemisphereLight dot(const Vec3f& step) const;
};

/// One ray of a hemisphere.
struct HemisphereRay {
    HemisphereLight light;
    float inverse_distance = 0;  ///< to what it met, per world unit; 0: nothing
};

/// How a hemisphere is cut: rings of equal weight in sin² of the angle to the pole, each into equal sectors.
struct HemisphereGrid {
    int rings = 0, sectors = 0;

    /// Cells about as wide as high (Ward and Heckbert: sectors = pi times rings).
    explicit HemisphereGrid(int rays);
    int size() const { return rings * sectors; }
    /// The direction of cell `index` (ring by ring) for `random` in [0,1)², about +z.
    Vec3f direction(int index, const Vec2f& random) const;
};

struct HemisphereRecord {
    Vec3d position{0, 0, 0};
    Vec3f normal{0, 0, 1};  ///< unit: the hemisphere's pole
    float radius = 0;       ///< world units: the distance at which its error reaches 1
    HemisphereLight light;
    HemisphereGradient turning;   ///< per radian about the axes
    HemisphereGradient moving;    ///< per world unit
    float harmonic_distance = 0;  ///< mean of the rays, world units; infinite where nothing was met
};

/// Smallest and largest radius a record may have, world units.
struct RadiusLimits {
    float least = 0, most = 0;
};

/// The record of a sampled hemisphere; `rays` cell by cell in the order of the grid. The radius is the harmonic mean
/// distance, less where the translation gradient foresees a full change sooner; where the limits make it larger, the
/// gradient is scaled down so as not to foresee less than nothing.
HemisphereRecord make_record(const Vec3d& position, const Vec3f& normal, const HemisphereGrid& grid,
                             const std::vector<HemisphereRay>& rays, const RadiusLimits& limits);

}  // namespace rayleaf
