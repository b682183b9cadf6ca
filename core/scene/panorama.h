// Where panoramic cameras look: from a place on the picture to a direction, as Cycles 3.4 has it.
#pragma once

#include "base/vector.h"
#include "scene/spherical_stereo.h"

#include <cstdint>
#include <numbers>
#include <optional>

namespace rayleaf {

enum class PanoramaKind : uint8_t {
    Equirectangular,     ///< longitude across, latitude up
    FisheyeEquidistant,  ///< the angle to the axis grows with the distance from the middle
    FisheyeEquisolid,    ///< areas of the picture are as large as the solid angles that they show
    MirrorBall           ///< as a ball that mirrors, seen from far away
};

struct Panorama {
    PanoramaKind kind = PanoramaKind::Equirectangular;
    /// Radians; the view axis is at longitude and latitude 0, to its right longitudes grow.
    double longitude_min = -std::numbers::pi, longitude_max = std::numbers::pi;
    double latitude_min = -std::numbers::pi / 2, latitude_max = std::numbers::pi / 2;
    double field_of_view = std::numbers::pi;           ///< of a fisheye: full angle, radians
    double lens = 10.5;                                ///< of an equisolid fisheye: focal length, millimetres
    double sensor_width = 36.0, sensor_height = 24.0;  ///< of it
    SphericalStereo stereo;
};

/// Throws InputError for numbers that show nothing.
void validate(const Panorama& panorama);

/// The unit direction in camera space (-z forward, y up) of a place on the picture, each coordinate 0 to 1; empty
/// outside the circle that fisheyes and mirror balls fill.
std::optional<Vec3d> panorama_direction(const Panorama& panorama, const Vec2d& place);
/// Its inverse: where on the picture a direction of any length is seen; also beyond the picture's borders.
Vec2d panorama_place(const Panorama& panorama, const Vec3d& direction);
/// The angle between neighbouring pixels where it is smallest, radians.
double panorama_pixel_angle(const Panorama& panorama, int width, int height);

}  // namespace rayleaf
