#include "integrators/volumes.h"

#include "trace/local_ray.h"

#include <algorithm>

namespace rayleaf {
namespace {

struct Entry {
    double t;
    uint32_t instance;

    bool operator<(const Entry& other) const { return t != other.t ? t < other.t : instance < other.instance; }
};

Color to_the_power(const Color& color, float exponent) {
    if (exponent == 0.0f) return Color(1.0f);
    return {std::pow(color.x, exponent), std::pow(color.y, exponent), std::pow(color.z, exponent)};
}

void add(const VolumeVisualisation& volume, double length, VolumePassage& passage) {
    const float depth = volume.density * static_cast<float>(length);
    if (volume.kind == VolumeVisualisation::Kind::Emission)
        passage.emission += passage.transmittance * volume.color * depth;
    else
        passage.transmittance *= to_the_power(volume.color, depth);
}

int rank(RayAnswer answer) {
    constexpr int kRanks[] = {0, 4, 2, 3, 1};  // NotAsked, Traced, Interpolated, Followed, Missed
    return kRanks[static_cast<size_t>(answer)];
}

}  // namespace

RayAnswer more_telling(RayAnswer a, RayAnswer b) {
    return rank(a) >= rank(b) ? a : b;
}

VolumePassage through_volumes(const Scene& scene, const Ray& ray, Visibility kind) {
    VolumePassage passage;
    if (scene.volumes().empty()) return passage;
    std::vector<Entry> entries;
    for (const uint32_t instance : scene.volumes()) {
        if ((scene.volume_visibility(instance) & kind) == 0) continue;
        const std::optional<RayInterval> interval =
            inside_box(scene.tracer().bounds(instance), ray.origin, ray.direction);
        if (interval && interval->end >= ray.t_min && interval->begin <= ray.t_max)
            entries.push_back({interval->begin, instance});
    }
    std::sort(entries.begin(), entries.end());
    for (const Entry& entry : entries) {
        const LengthAnswer answer = scene.tracer().length_inside(entry.instance, ray);
        add(*scene.volume(entry.instance), answer.length, passage);
        passage.length += answer.length;
        passage.answer = more_telling(passage.answer, answer.answer);
        passage.error = std::max(passage.error, answer.error);
        const LocalRayCache* cache = scene.tracer().cache(entry.instance);
        if (cache && passage.tree == 0 && answer.length > 0.0) passage.tree = cache->number();
    }
    return passage;
}

}  // namespace rayleaf
