// A triangle mesh traced by Embree's own robust triangles.
#pragma once

#include "geometry/triangle_mesh.h"
#include "trace/shape_scene.h"

namespace rayleaf {

class TriangleScene final : public ShapeScene {
  public:
    TriangleScene(const TriangleMesh& mesh, const CancelToken& cancel);

    LocalHit local_hit(const ShapeHit& hit) const override;
    LocalHit on_facet(const LocalHit& hit) const override;
    /// Embree rounds vertices once more where it mixes those of two times.
    double float_error() const override { return deforms() ? 0x1p-20 : ShapeScene::float_error(); }
    uint64_t triangle_count() const override { return mesh_->triangles().size(); }

  private:
    const TriangleMesh* mesh_;
};

}  // namespace rayleaf
