#include "integrators/ray_passes.h"

#include "tessellation/level.h"

namespace rayleaf {
namespace {

/// White shows what was traced, as in the paper's colour-coded pictures (RI, figures 8 to 11).
Color color_of(RayAnswer answer) {
    switch (answer) {
        case RayAnswer::NotAsked:
            break;
        case RayAnswer::Traced:
            return {1.0f, 1.0f, 1.0f};
        case RayAnswer::Interpolated:
            return {0.05f, 0.2f, 0.8f};
        case RayAnswer::Followed:
            return {1.0f, 0.35f, 0.0f};
        case RayAnswer::Missed:
            return {0.05f, 0.05f, 0.05f};
    }
    return {0.0f, 0.0f, 0.0f};
}

void write(RayAnswer answer, float error, PixelSample& sample) {
    const Color color = color_of(answer);
    sample[Pass::mask].x = static_cast<float>(answer);
    sample[Pass::mask_colors] = Vec4f(color.x, color.y, color.z, 0.0f);
    sample[Pass::interpolation_error].x = error;
}

}  // namespace

void write_answer(const Tracer& tracer, const ClosestHit& found, PixelSample& sample) {
    const bool interpolated = found.hit && found.hit->is_interpolated();
    write(found.answer, interpolated ? found.hit->interpolated->error : 0.0f, sample);
    const LocalRayCache* cache = found.hit ? tracer.cache(found.hit->instance) : nullptr;
    if (cache) sample[Pass::tree_index].x = static_cast<float>(cache->number());
}

void write_level(const Maybe<Hit>& hit, PixelSample& sample) {
    const bool has_level = hit && !hit->is_interpolated() && hit->local.subpatch != RayAnchor::kNone;
    sample[Pass::geometry_level].x = has_level ? static_cast<float>(own_level(hit->local.levels) + 1) : 0.0f;
}

void write_volumes(const VolumePassage& passage, PixelSample& sample) {
    const auto surface = static_cast<RayAnswer>(static_cast<int>(sample[Pass::mask].x));
    const float error = std::max(sample[Pass::interpolation_error].x, passage.error);
    write(more_telling(surface, passage.answer), error, sample);
    if (sample[Pass::tree_index].x == 0.0f) sample[Pass::tree_index].x = static_cast<float>(passage.tree);
    sample[Pass::path_length].x = static_cast<float>(passage.length);
}

}  // namespace rayleaf
