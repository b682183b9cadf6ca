// The camera: from a point on the picture to a ray and its differential.
#pragma once

#include "base/vector.h"
#include "rays/ray.h"
#include "rays/ray_differential.h"
#include "scene/panorama.h"
#include "scene/shutter.h"
#include "shading/inputs.h"
#include "trace/tracer.h"

#include <array>
#include <optional>
#include <vector>

namespace rayleaf {

enum class CameraKind : uint8_t { Perspective, Orthographic, Panoramic };

/// A camera as the add-on describes it. It looks along the -z axis of its frame, y up, as Blender's.
struct CameraDescription {
    CameraKind kind = CameraKind::Perspective;
    Affine3d to_world;  ///< scale is removed
    /// The picture's window: perspective: on the plane at distance 1; orthographic: world units. Of the whole picture.
    Vec2d window_min{-1, -1}, window_max{1, 1};
    Panorama panorama;                         ///< in place of the window, of a panoramic camera
    double clip_start = 0.1, clip_end = 1000;  ///< along the view axis, world units; a panorama's along each ray
    double aperture_radius = 0;                ///< world units; 0: a pinhole
    double focus_distance = 10;                ///< along the view axis
    int blades = 0;                            ///< 0..2: a round aperture
    double blade_rotation = 0;                 ///< radians
    double aperture_ratio = 1;                 ///< anamorphic: width is radius / ratio

    /// While the shutter is open, at even steps of time: frames (rays/motion.h), and windows of a perspective camera,
    /// lower left then upper right corner. Empty: they stay as they are.
    std::vector<Affine3d> motion;
    std::vector<std::array<Vec2d, 2>> windows;
    ShutterDescription shutter;
};

/// Throws InputError for a window, clip range or matrix that shows nothing.
void validate(const CameraDescription& camera);

struct CameraRay {
    Ray ray;
    RayDifferential differential;
    bool exists = true;  ///< false: outside the circle of a panorama, where nothing is seen
};

/// Whether a ray needs to know how far apart those beside it are: its differential is zero otherwise.
enum class Footprint : bool { Unknown, Known };

class Camera {
  public:
    /// Throws InputError as `validate` does.
    Camera(const CameraDescription& description, int width, int height);

    /// `pixel` in pixels from the lower left corner of the whole picture; `lens` in [0,1)²; `time` of the shutter.
    CameraRay ray(const Vec2d& pixel, const Vec2f& lens, float time = kMiddleTime,
                  Footprint footprint = Footprint::Known) const;
    /// When a ray through the pixel is exposed; `random` in [0,1).
    float time(const Vec2d& pixel, float random) const { return shutter_.time(random, pixel.y / height_); }
    bool moves() const { return motion_.has_value() || !description_.windows.empty(); }
    /// Where a point is seen on the picture, pixels, without the lens; not finite where it is nowhere. Of eyes that
    /// turn, seen from between them.
    Vec2d seen_at(const Vec3d& world, float time) const;
    /// Distance of a point along the view axis, Blender's Depth; a panorama's from the eye.
    double depth(const Vec3d& world) const;
    /// From the eye; of an orthographic camera along the view axis.
    double distance(const Vec3d& world) const;
    const CameraInfo& info() const { return info_; }
    DicingView dicing_view() const;

  private:
    CameraDescription description_;
    Affine3d to_world_;
    CameraInfo info_;
    int width_, height_;
    std::optional<Motion> motion_;
    Shutter shutter_;

    /// What is seen at a time.
    struct Placement {
        Affine3d to_world;
        Vec2d window_min, step;  ///< the window's corner, and what a pixel spans of it
        Vec3d corner, dx, dy;    ///< the same in the world; the corner from the camera's location
    };
    Placement still_;  ///< where nothing moves
    Placement at(float time) const;
    Placement placed(const Affine3d& to_world, const Vec2d& window_min, const Vec2d& window_size) const;
    Vec2d lens_point(const Vec2f& random) const;
    bool is_panoramic() const { return description_.kind == CameraKind::Panoramic; }
    CameraRay ray(const Placement& now, const Vec2d& pixel, const Vec2f& lens, Footprint footprint) const;
    CameraRay panoramic_ray(const Affine3d& to_world, const Vec2d& pixel, const Vec2f& lens) const;
    CameraRay windowed_ray(const Placement& now, const Vec2d& pixel, const Vec2f& lens, Footprint footprint) const;
};

}  // namespace rayleaf
