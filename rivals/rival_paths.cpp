#include "rivals/rival_paths.h"

#include "base/error.h"
#include "ri_tree/snell.h"

namespace rayleaf {
namespace {

bool advance_volume(RivalPath& path, const RivalHit& hit) {
    if (path.ray.direction.dot(hit.facet_normal) < 0.0f) {
        if (path.inside++ == 0) path.entered = hit.t;
    } else if (path.inside > 0) {
        if (--path.inside == 0) path.answer.length += hit.t - path.entered;
    } else if (path.hits == 1) {
        path.answer.length += hit.t;
    }
    path.ray.t_min = hit.t + kRivalCrossingStep;
    return path.hits <= kMostInteriorHits;
}

bool advance_glass(RivalPath& path, const RivalHit& hit, const RivalMaterial& material) {
    Vec3f& direction = path.ray.direction;
    const bool from_inside = direction.dot(hit.facet_normal) > 0.0f;
    const Vec3f normal = hit.normal.dot(direction) > 0.0f ? -hit.normal : hit.normal;
    const float eta = from_inside ? material.ior : 1.0f / material.ior;
    const std::optional<Vec3f> through = refracted_by_snell(direction, normal, eta);
    direction = through ? *through : reflected_direction(direction, normal);
    path.answer.exit_position = hit.position;
    path.answer.exit_direction = direction;
    const float side = direction.dot(hit.facet_normal);
    path.ray.origin = hit.facet_position + hit.facet_normal * std::copysign(kRivalStartOffset, side);
    if (side >= 0.0f) return false;
    if (path.hits <= material.most_interior_hits) return true;
    path.answer.exit_position = path.answer.position;
    path.answer.exit_direction = Vec3f(0.0f);
    return false;
}

}  // namespace

bool advance(RivalPath& path, const RivalHit* hit, std::span<const RivalMaterial> materials) {
    if (!hit) return false;
    const RivalMaterial& material = materials[hit->surface];
    if (path.hits++ == 0) {
        path.answer.object = static_cast<int32_t>(hit->surface);
        if (material.kind != OutputKind::Volume) {
            path.answer.position = path.answer.exit_position = hit->position;
            path.answer.normal = hit->normal;
        }
    }
    switch (material.kind) {
        case OutputKind::Simple:
            path.answer.exit_direction = hit->normal;
            return false;
        case OutputKind::Mirror:
            path.answer.exit_direction = reflected_direction(path.ray.direction, hit->normal);
            return false;
        case OutputKind::Glass:
            return advance_glass(path, *hit, material);
        case OutputKind::Volume:
            return advance_volume(path, *hit);
    }
    return false;
}

RivalTracer::RivalTracer(std::span<const std::shared_ptr<const PatchSurface>> surfaces,
                         std::vector<RivalMaterial> materials, RivalMethod method)
    : scene_(surfaces, method), materials_(std::move(materials)) {
    if (materials_.size() != surfaces.size())
        throw InputError("rival tracer", "materials", std::to_string(materials_.size()),
                         std::to_string(surfaces.size()));
}

RivalPath RivalTracer::path_of(const Ray& ray) const {
    RivalPath path;
    path.ray = {scene_.frame().to_local(ray.origin), Vec3f(ray.direction), 0.0f};
    return path;
}

PathAnswer RivalTracer::in_object_space(const PathAnswer& answer) const {
    PathAnswer result = answer;
    if (answer.object == kNoObject) return result;
    const auto scale = static_cast<float>(scene_.frame().scale);
    const Vec3f center(scene_.frame().center);
    result.position = answer.position * scale + center;
    result.exit_position = answer.exit_position * scale + center;
    result.length *= scale;
    return result;
}

void RivalTracer::trace(std::span<const Ray> rays, std::span<PathAnswer> answers, PacketUse packets) const {
    if (packets == PacketUse::Packets) {
        for (size_t i = 0; i < rays.size(); i += kPacketSize) {
            const size_t count = std::min<size_t>(kPacketSize, rays.size() - i);
            trace_packet(rays.subspan(i, count), answers.subspan(i, count));
        }
        return;
    }
    for (size_t i = 0; i < rays.size(); ++i) {
        RivalPath path = path_of(rays[i]);
        RivalHit hit;
        bool goes_on = true;
        while (goes_on) goes_on = advance(path, scene_.closest(path.ray, hit) ? &hit : nullptr, materials_);
        answers[i] = in_object_space(path.answer);
    }
}

void RivalTracer::count(const CountingScene& twin, std::span<const Ray> rays, std::span<uint64_t> flops) const {
    for (size_t i = 0; i < rays.size(); ++i) {
        RivalPath path = path_of(rays[i]);
        RivalHit hit;
        flops[i] = 0;
        while (advance(path, twin.closest(path.ray, hit, flops[i]) ? &hit : nullptr, materials_))
            flops[i] += kBounceFlops;
        flops[i] += kBounceFlops;
    }
}

void RivalTracer::trace_packet(std::span<const Ray> rays, std::span<PathAnswer> answers) const {
    std::array<RivalPath, kPacketSize> paths;
    std::array<RivalRay, kPacketSize> asked;
    std::array<RivalHit, kPacketSize> hits;
    std::array<int, kPacketSize> active{}, found{};
    for (size_t i = 0; i < rays.size(); ++i) {
        paths[i] = path_of(rays[i]);
        active[i] = 1;
    }
    for (bool any = true; any;) {
        for (int i = 0; i < kPacketSize; ++i) asked[i] = paths[i].ray;
        found = active;
        scene_.closest16(asked, found, hits);
        any = false;
        for (int i = 0; i < kPacketSize; ++i) {
            active[i] = active[i] && advance(paths[i], found[i] ? &hits[i] : nullptr, materials_);
            any = any || active[i];
        }
    }
    for (size_t i = 0; i < rays.size(); ++i) answers[i] = in_object_space(paths[i].answer);
}

}  // namespace rayleaf
