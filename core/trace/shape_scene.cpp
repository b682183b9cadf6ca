#include "trace/shape_scene.h"

namespace rayleaf {

void ShapeScene::set_scene(EmbreeScene scene, const Box3f& box) {
    scene_ = std::move(scene);
    const Vec3d padding(kBoxPadding);
    box_ = Box3d(Vec3d(box.min) - padding, Vec3d(box.max) + padding);
}

bool ShapeScene::closest(const LocalRay& ray, ShapeHit& hit) const {
    std::optional<GeometryCache::Reader> own;
    if (!ray.reader && geometry_cache_) own.emplace(*geometry_cache_);
    ShapeQuery query(ray, kind_, own ? &*own : ray.reader, hit);
    prepare(query);
    RTCRayHit embree_ray = ray.embree_ray_hit();
    embree_closest(scene_.get(), query.context, embree_ray);
    return query.found;
}

bool ShapeScene::occluded(const LocalRay& ray) const {
    std::optional<GeometryCache::Reader> own;
    if (!ray.reader && geometry_cache_) own.emplace(*geometry_cache_);
    ShapeHit hit;
    ShapeQuery query(ray, kind_, own ? &*own : ray.reader, hit);
    prepare(query);
    RTCRay embree_ray = ray.embree_ray();
    embree_any(scene_.get(), query.context, embree_ray);
    return query.found;
}

}  // namespace rayleaf
