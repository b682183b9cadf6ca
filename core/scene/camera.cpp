#include "scene/camera.h"

#include "base/circle.h"
#include "base/largest.h"

namespace rayleaf {
namespace {

constexpr const char* kCamera = "camera";

/// The axis as a unit vector; a camera's scale does not count, but an axis of no length shows nothing.
Vec3d unit_axis(const Vec3d& axis) {
    const Vec3d unit = normalized_or(axis, Vec3d(0.0));
    if (unit == Vec3d(0.0))
        throw InputError(kCamera, "matrix", "singular or not finite", "three axes with a direction");
    return unit;
}

Affine3d without_scale(const Affine3d& m) {
    if (!is_finite(m.translation)) throw InputError(kCamera, "matrix", "not finite", "a finite location");
    return {unit_axis(m.x), unit_axis(m.y), unit_axis(m.z), m.translation};
}

void require(bool condition, const char* argument, double got, const char* wanted) {
    if (!condition) throw InputError(kCamera, argument, number_text(got), wanted);
}

/// Change of the unit vector that is `scale` times another when that one changes by `dv`.
Vec3d change_of_unit(const Vec3d& unit, double scale, const Vec3d& dv) {
    return (dv - unit * unit.dot(dv)) * scale;
}

/// A uniform point of the unit disk (Shirley and Chiu 1997, concentric map).
Vec2d disk_point(const Vec2f& random) {
    const double a = 2.0 * random.x - 1.0, b = 2.0 * random.y - 1.0;
    if (a == 0.0 && b == 0.0) return {0.0, 0.0};
    constexpr double kEighth = 0.125;  // of a turn
    const bool wide = std::abs(a) > std::abs(b);
    const double r = wide ? a : b;
    return on_circle(wide ? kEighth * (b / a) : kEighth * (2.0 - a / b)) * r;
}

/// A uniform point of the regular polygon with `blades` corners on the unit circle: a triangle of it, then a point
/// inside.
Vec2d polygon_point(const Vec2f& random, int blades, double rotation) {
    const double scaled = random.x * blades;
    const double corner = std::floor(scaled);
    const double along = scaled - corner, out = std::sqrt(static_cast<double>(random.y));
    const double step = 2.0 * std::numbers::pi / blades, angle = corner * step + rotation;
    const Vec2d a(std::cos(angle), std::sin(angle)), b(std::cos(angle + step), std::sin(angle + step));
    return (a * (1.0 - along) + b * along) * out;
}

void check_place(const Affine3d& matrix) {
    const Affine3d to_world = without_scale(matrix);
    // Below this the axes lie in one plane within the precision of a double, and there is no inverse.
    constexpr double kFlat = 1e-12;
    if (!(std::abs(to_world.determinant()) > kFlat))
        throw InputError(kCamera, "matrix", "one whose axes lie in a plane", "three axes with a direction");
    if (!is_place(to_world.translation))
        throw InputError(kCamera, "location", place_text(to_world.translation), kCoordinatesWanted);
}

void check_window(const Vec2d& min, const Vec2d& max) {
    const Vec2d size = max - min;
    require(is_length(min.x), "window's left border", min.x, "a number up to 1e100");
    require(is_length(min.y), "window's lower border", min.y, "a number up to 1e100");
    require(is_length(size.x) && size.x > 0, "window width", size.x, "a positive number");
    require(is_length(size.y) && size.y > 0, "window height", size.y, "a positive number");
}

void validate_motion(const CameraDescription& camera) {
    require(camera.motion.size() != 1, "motion", 1.0, "none, or at least two matrices");
    require(camera.windows.size() != 1, "windows", 1.0, "none, or at least two");
    for (const Affine3d& place : camera.motion) check_place(place);
    for (const auto& [min, max] : camera.windows) check_window(min, max);
}

}  // namespace

void validate(const CameraDescription& camera) {
    if (camera.kind == CameraKind::Panoramic) validate(camera.panorama);
    check_place(camera.to_world);
    check_window(camera.window_min, camera.window_max);
    validate(camera.shutter);
    validate_motion(camera);
    require(camera.clip_start >= 0 && camera.clip_start < camera.clip_end, "clip start", camera.clip_start,
            "a number from 0 to less than the clip end");
    require(camera.aperture_radius >= 0 && is_length(camera.aperture_radius), "aperture radius", camera.aperture_radius,
            "0 or a positive number");
    if (camera.aperture_radius > 0) {
        require(camera.focus_distance > 0 && is_length(camera.focus_distance), "focus distance", camera.focus_distance,
                "a positive number where the aperture is open");
        require(camera.aperture_ratio > 0 && std::isfinite(camera.aperture_ratio), "aperture ratio",
                camera.aperture_ratio, "a positive number");
        require(std::isfinite(camera.blade_rotation), "blade rotation", camera.blade_rotation, "a finite number");
    }
}

Camera::Camera(const CameraDescription& description, int width, int height)
    : description_(description),
      to_world_(without_scale(description.to_world)),
      width_(width),
      height_(height),
      shutter_(description.shutter) {
    validate(description);
    if (description.kind != CameraKind::Perspective) description_.windows.clear();
    std::vector<Affine3d> places;
    for (const Affine3d& place : description.motion) places.push_back(without_scale(place));
    if (!places.empty()) motion_.emplace(places);
    info_.world_to_camera = to_world_.inverse();
    info_.window_min = description.window_min;
    info_.window_size = description.window_max - description.window_min;
    info_.perspective = description.kind != CameraKind::Orthographic;
    still_ = placed(to_world_, info_.window_min, info_.window_size);
}

Vec2d Camera::lens_point(const Vec2f& random) const {
    if (description_.aperture_radius <= 0) return {0.0, 0.0};
    const Vec2d unit = description_.blades >= 3
                           ? polygon_point(random, description_.blades, description_.blade_rotation)
                           : disk_point(random);
    return Vec2d(unit.x / description_.aperture_ratio, unit.y) * description_.aperture_radius;
}

Camera::Placement Camera::placed(const Affine3d& to_world, const Vec2d& window_min, const Vec2d& window_size) const {
    const Vec2d step(window_size.x / width_, window_size.y / height_);
    const double depth = info_.perspective ? 1.0 : 0.0;
    return {to_world,
            window_min,
            step,
            to_world.vector({window_min.x, window_min.y, -depth}),
            to_world.x * step.x,
            to_world.y * step.y};
}

Camera::Placement Camera::at(float time) const {
    const Affine3d to_world = motion_ ? motion_->at(time) : to_world_;
    const auto& windows = description_.windows;
    if (windows.empty()) return placed(to_world, info_.window_min, info_.window_size);
    const double place = static_cast<double>(time) * static_cast<double>(windows.size() - 1);
    const size_t first = std::min(static_cast<size_t>(place), windows.size() - 2);
    const double share = place - static_cast<double>(first);
    const auto mixed = [&](size_t corner) {
        return windows[first][corner] * (1.0 - share) + windows[first + 1][corner] * share;
    };
    const Vec2d window_min = mixed(0);
    return placed(to_world, window_min, mixed(1) - window_min);
}

CameraRay Camera::panoramic_ray(const Affine3d& to_world, const Vec2d& pixel, const Vec2f& lens) const {
    const auto direction_at = [&](double x, double y) {
        return panorama_direction(description_.panorama, Vec2d(x / width_, y / height_));
    };
    CameraRay result;
    const std::optional<Vec3d> seen = direction_at(pixel.x, pixel.y);
    result.exists = seen.has_value();
    if (!seen) return result;
    // At the border of the circle the next pixel may see nothing, but then the one before does.
    const auto change = [&](double dx, double dy) {
        if (const auto next = direction_at(pixel.x + dx, pixel.y + dy)) return *next - *seen;
        const auto before = direction_at(pixel.x - dx, pixel.y - dy);
        return before ? *seen - *before : Vec3d(0.0);
    };
    const Vec2d on_lens = lens_point(lens);
    Vec3d from(0.0), towards = *seen;
    if (description_.aperture_radius > 0) {  // across the ray
        const Vec3d aside = normalized_or(towards.cross(Vec3d(0, 1, 0)), Vec3d(1, 0, 0));
        from = aside * on_lens.x + aside.cross(towards) * on_lens.y;
        towards = (towards * description_.focus_distance - from).normalized();
    }
    const SphericalStereo& stereo = description_.panorama.stereo;
    if (stereo.offset != 0.0) {
        const Vec3d eye = eye_place(stereo, towards);
        from += eye;
        towards = eye_direction(stereo, eye, towards);
    }
    result.ray.origin = to_world.point(from);
    result.ray.direction = to_world.vector(towards).normalized();
    result.ray.t_min = description_.clip_start;
    result.ray.t_max = description_.clip_end;
    result.differential.dd_dx = Vec3f(to_world.vector(change(1.0, 0.0)));
    result.differential.dd_dy = Vec3f(to_world.vector(change(0.0, 1.0)));
    return result;
}

CameraRay Camera::ray(const Vec2d& pixel, const Vec2f& lens, float time, Footprint footprint) const {
    CameraRay result = moves() ? ray(at(time), pixel, lens, footprint) : ray(still_, pixel, lens, footprint);
    result.ray.time = time;
    return result;
}

CameraRay Camera::ray(const Placement& now, const Vec2d& pixel, const Vec2f& lens, Footprint footprint) const {
    return is_panoramic() ? panoramic_ray(now.to_world, pixel, lens) : windowed_ray(now, pixel, lens, footprint);
}

CameraRay Camera::windowed_ray(const Placement& now, const Vec2d& pixel, const Vec2f& lens, Footprint footprint) const {
    const Vec3d on_window = now.corner + now.dx * pixel.x + now.dy * pixel.y;
    Vec3d from = now.to_world.translation, along = info_.perspective ? on_window : -now.to_world.z;
    if (!info_.perspective) from += on_window;
    double depth = 1.0;  // of the point that it goes through
    if (description_.aperture_radius > 0) {
        const Vec2d on_lens = lens_point(lens);
        const Vec3d aside = now.to_world.x * on_lens.x + now.to_world.y * on_lens.y;
        depth = description_.focus_distance;
        from += aside;
        along = along * depth - aside;
    }

    CameraRay result;
    const double length = along.length(), inverse = 1.0 / length, per_depth = length / depth;
    result.ray.origin = from;
    result.ray.direction = along * inverse;
    result.ray.t_min = description_.clip_start * per_depth;
    result.ray.t_max = description_.clip_end * per_depth;
    if (footprint == Footprint::Unknown) return result;
    if (info_.perspective) {
        result.differential.dd_dx = Vec3f(change_of_unit(result.ray.direction, inverse * depth, now.dx));
        result.differential.dd_dy = Vec3f(change_of_unit(result.ray.direction, inverse * depth, now.dy));
    } else {
        result.differential.dp_dx = Vec3f(now.dx);
        result.differential.dp_dy = Vec3f(now.dy);
    }
    return result;
}

Vec2d Camera::seen_at(const Vec3d& world, float time) const {
    const Placement now = at(time);
    const Vec3d p = now.to_world.inverse().point(world);
    if (is_panoramic()) {
        const Vec2d place = panorama_place(description_.panorama, p);
        return {place.x * width_, place.y * height_};
    }
    const Vec2d window = info_.perspective ? Vec2d(p.x, p.y) / -p.z : Vec2d(p.x, p.y);
    return {(window.x - now.window_min.x) / now.step.x, (window.y - now.window_min.y) / now.step.y};
}

double Camera::depth(const Vec3d& world) const {
    return is_panoramic() ? distance(world) : -info_.world_to_camera.point(world).z;
}

double Camera::distance(const Vec3d& world) const {
    return info_.perspective ? (world - to_world_.translation).length() : depth(world);
}

DicingView Camera::dicing_view() const {
    DicingView view;
    view.eye = to_world_.translation;
    const double pixel = std::min(info_.window_size.x / width_, info_.window_size.y / height_);
    view.pixel_angle = info_.perspective ? pixel : 0.0;
    if (is_panoramic()) view.pixel_angle = panorama_pixel_angle(description_.panorama, width_, height_);
    view.pixel_width = info_.perspective ? 0.0 : pixel;
    return view;
}

}  // namespace rayleaf
