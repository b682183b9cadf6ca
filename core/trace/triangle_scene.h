// Triangle meshes: by Embree's own robust triangles, or without a tree where there are few.
#pragma once

#include "geometry/triangle_mesh.h"
#include "tessellation/packet_decision.h"
#include "trace/shape_scene.h"

#include <vector>

namespace rayleaf {

/// What all scenes of a mesh know of a hit.
class MeshScene : public ShapeScene {
  public:
    LocalHit local_hit(const ShapeHit& hit) const override;
    LocalHit on_facet(const LocalHit& hit) const override;
    bool finds_all() const override { return true; }
    uint64_t triangle_count() const override { return mesh_->triangles().size(); }

  protected:
    explicit MeshScene(const TriangleMesh& mesh) : ShapeScene(mesh, FacetKind::Triangles), mesh_(&mesh) {}
    const TriangleMesh& mesh() const { return *mesh_; }
    /// Once the box is known.
    void set_parts_and_points();

  private:
    const TriangleMesh* mesh_;
};

class TriangleScene final : public MeshScene {
  public:
    TriangleScene(const TriangleMesh& mesh, const CancelToken& cancel);

    bool find_all(const LocalRay& ray, uint32_t instance, PassedHits& passed) const override;

    /// Embree rounds vertices once more where it mixes those of two times.
    double float_error() const override { return deforms() ? 0x1p-20 : ShapeScene::float_error(); }
};

/// A mesh at rest of so few triangles that each ray is tested against all of them, in double precision: floors, walls
/// and boxes, which stand in most scenes and which most rays meet.
class FewTrianglesScene final : public MeshScene {
  public:
    explicit FewTrianglesScene(const TriangleMesh& mesh);
    static bool suits(const TriangleMesh& mesh);

    bool closest(const LocalRay& ray, ShapeHit& hit) const override;
    bool occluded(const LocalRay& ray) const override;
    void find_closest(PacketQuery& packet) const override;
    void find_any(PacketQuery& packet) const override;
    bool find_all(const LocalRay& ray, uint32_t instance, PassedHits& passed) const override;
    /// Double precision decides.
    double float_error() const override { return 0x1p-49; }

  private:
    std::vector<FacetCorners> corners_;  ///< of each triangle
    MeetFewFacets meet_few_;
};

}  // namespace rayleaf
