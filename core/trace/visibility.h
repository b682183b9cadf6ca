// Which rays see an instance, and which instances cast the shadows of a light: one test of bits for both.
#pragma once

#include <cstdint>

namespace rayleaf {

/// Lights have so many different sets of objects that cast their shadows, beside all objects.
inline constexpr int kBlockerSets = 24;

/// Which rays see an instance (Blender's ray visibility); also the kind of a ray.
enum Visibility : uint64_t {
    kVisibleCamera = 1,
    kVisibleDiffuse = 2,
    kVisibleGlossy = 4,
    kVisibleTransmission = 8,
    kVisibleShadow = 16,
    kVisibleVolume = 32,  ///< rays that a medium has scattered
    kVisibleAll = 63,
    kOfFootage = 64  ///< no kind of ray: the object stands in the footage, as shadow catchers and their lamps do
};

/// The kind of a ray that meets what stands in the footage alone.
inline constexpr int kFootageShift = 7;
/// Behind these kinds: rays to the lights of each set of blockers, and the same in the footage.
inline constexpr int kBlockerShift = 16, kFootageBlockerShift = kBlockerShift + kBlockerSets;
static_assert(kFootageShift + 6 <= kBlockerShift && kFootageBlockerShift + kBlockerSets <= 64);
inline constexpr uint32_t kAllBlockerSets = (uint32_t{1} << kBlockerSets) - 1;

constexpr Visibility in_footage(Visibility kind) {
    return static_cast<Visibility>(uint64_t{kind} << kFootageShift);
}
/// Whether rays of a kind meet what stands in the footage alone.
constexpr bool is_in_footage(Visibility kind) {
    constexpr uint64_t kKinds = uint64_t{kVisibleAll} << kFootageShift | uint64_t{kAllBlockerSets}
                                                                             << kFootageBlockerShift;
    return (kind & kKinds) != 0;
}
/// A kind of ray that meets as much as one that is under way.
constexpr Visibility in_world_of(Visibility under_way, Visibility kind) {
    return is_in_footage(under_way) ? in_footage(kind) : kind;
}
/// The kind of a shadow ray to a light with a set of blockers; below 0: any object blocks it.
constexpr Visibility to_light(Visibility shadow, int blockers) {
    if (blockers < 0) return shadow;
    return static_cast<Visibility>(uint64_t{1}
                                   << (blockers + (is_in_footage(shadow) ? kFootageBlockerShift : kBlockerShift)));
}
constexpr bool is_shadow_ray(Visibility kind) {
    constexpr uint64_t kOthers = kVisibleAll & ~uint64_t{kVisibleShadow};
    return (kind & (kOthers | kOthers << kFootageShift)) == 0;
}

/// The kinds of rays that see an object, those in the footage included. `blocks`: the sets of blockers that it is in.
constexpr uint64_t seen_by(uint8_t visibility, uint32_t blocks = kAllBlockerSets) {
    const bool shadows = (visibility & kVisibleShadow) != 0;
    const uint64_t kinds = visibility & kVisibleAll, sets = shadows ? blocks & kAllBlockerSets : 0;
    const uint64_t seen = kinds | sets << kBlockerShift;
    return (visibility & kOfFootage) == 0 ? seen : seen | kinds << kFootageShift | sets << kFootageBlockerShift;
}

}  // namespace rayleaf
