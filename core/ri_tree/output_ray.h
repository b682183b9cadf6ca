// What an object makes of a line (RI, section 1.3): the attributes of a sample, by the kind of the object.
//
// An object stores only what its kind needs. Mirrors store point and normal, from which the reflected ray follows.
// Glass stores them too, so that an object can both reflect and refract (in the paper it could not).
#pragma once

#include "base/vector.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace rayleaf {

enum class OutputKind : uint8_t {
    Simple,  ///< first hit: point, normal, texture coordinates
    Mirror,  ///< first hit: point, normal; from them the reflected ray
    Glass,   ///< first hit: point, normal; the ray that leaves after all refractions and total internal reflections
    Volume   ///< the length of the line inside the object
};

/// The most hits from inside of a path in glass, or of a line through a volume.
inline constexpr int kMostInteriorHits = 64;

/// How the path inside glass, or through a volume, ended.
enum class PathEnding : uint8_t {
    FirstHit,  ///< not followed: Simple and Mirror
    Left,
    CutOff,  ///< too many hits from inside: no ray leaves, and in its place are position and normal of the first hit
    Escaped  ///< nothing more was hit from inside: the surface has a gap
};

inline constexpr uint32_t kMissedClass = 0;            ///< of lines that hit nothing
inline constexpr uint32_t kFacetedClass = 0xffffffff;  ///< each facet is a class of its own: never interpolated

/// Samples are blended only if all of this is equal. The paper compares the class of the first hit only; here the path
/// inside counts too, so that no blend crosses a border of total internal reflection. All paths cut off are alike.
struct SampleClass {
    uint32_t first_hit = kMissedClass;  ///< class of the patch hit first (ri_tree/patch_classes.h)
    uint32_t exit = kMissedClass;       ///< class of the patch where the path left
    uint8_t interior_hits = 0;          ///< hits after the first one
    uint8_t total_reflections = 0;
    PathEnding ending = PathEnding::FirstHit;

    bool operator==(const SampleClass&) const = default;
    bool is_miss() const { return first_hit == kMissedClass; }
    bool is_faceted() const { return first_hit == kFacetedClass || exit == kFacetedClass; }
};

/// Local space; attributes that a kind does not have stay zero.
struct OutputRay {
    SampleClass sample_class;
    Vec3d position{0, 0, 0};  ///< first hit
    Vec3d normal{0, 0, 0};    ///< unit, there, on the side of the winding
    Vec2d uv{0, 0};           ///< there
    /// The paper's output ray. Simple: position and normal. Mirror: position and reflected direction. Unit direction.
    Vec3d exit_position{0, 0, 0}, exit_direction{0, 0, 0};
    double length = 0;  ///< inside the object
};

inline constexpr int kMostAttributes = 12;
/// How many numbers a sample stores.
int attribute_count(OutputKind kind);
/// `out` receives attribute_count numbers.
void store_attributes(OutputKind kind, const OutputRay& ray, std::span<float> out);
/// The output ray of stored or interpolated attributes, for a line with the unit `direction`. Normals and directions
/// are normalized again.
OutputRay from_attributes(OutputKind kind, const SampleClass& sample_class, std::span<const double> attributes,
                          const Vec3d& direction);

/// How far apart two output rays of one class are: the distance threshold's measure (RI, section 2.3).
///
/// The paper takes the distance of the rays' four coordinates, which is defined only for rays of one dominant
/// direction. Here: the root of the sum of squares of two distances, of the rays' starts and of their points a length
/// `reach` further on. Simple adds the texture coordinates, as if [0,1] were spread over `reach`. Glass takes the
/// larger of this for the exit rays and for position and normal, because both are answered. Volume: the difference of
/// the lengths.
double distance(OutputKind kind, const OutputRay& a, const OutputRay& b, double reach);

Vec3d mirrored(const Vec3d& direction, const Vec3d& normal);
/// Snell's law; `normal` faces the incoming side, `eta` is the incoming side's index over the other's. Empty: all is
/// reflected.
std::optional<Vec3d> refracted_direction(const Vec3d& direction, const Vec3d& normal, double eta);

}  // namespace rayleaf
