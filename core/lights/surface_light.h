// Emitting surfaces: the elements (triangles, patches) of instances whose material emits, each a light of its own.
//
// A triangle that takes much of the view is sampled evenly by solid angle. Of others a point is chosen by the
// element's parameters; its density per area is one over the area that a unit of parameters covers, so that patches of
// any shape need no table of their own.
#pragma once

#include "lights/emitting_triangle.h"
#include "lights/lamp_sample.h"
#include "lights/light.h"
#include "lights/light_tree.h"

namespace rayleaf {

class SurfaceLights {
  public:
    /// Throws Cancelled soon after `cancel` says so.
    SurfaceLights(const std::vector<EmittingInstance>& emitters, const Tracer& tracer, SurfaceEmission emission,
                  EvenEmission even_emission, const CancelToken& cancel);

    uint32_t count() const { return static_cast<uint32_t>(elements_.size()); }
    /// The elements as the tree sees them, in order. Throws Cancelled soon after `cancel` says so.
    std::vector<LightTreeItem> tree_items(const CancelToken& cancel) const;
    /// An element that was chosen for a query.
    struct Wanted {
        uint32_t item;
        Vec2f random;  ///< for the place on it
        LightQuery* query;
    };
    /// Finds the queries' lights; they leave the choice of the element out. At most kMostTogether.
    void sample(std::span<const Wanted> wanted) const;
    /// Density of `sample` towards a point that a ray hit on the element.
    double density(uint32_t item, const Vec3d& from, const SurfacePoint& point) const;
    /// The element that holds a point; empty where none of its instance was given as emitting.
    std::optional<uint32_t> item_of(const SurfacePoint& point) const;
    /// Which kinds of rays see the element.
    uint16_t visibility(uint32_t item) const;
    uint32_t instance(uint32_t item) const { return elements_[item].instance; }
    LightLink link(uint32_t item) const { return links_.empty() ? LightLink() : links_[table_of(item)]; }
    /// Of what a hit emits back along its ray, the largest component; 0 where its object is no light.
    float brightness(const Ray& ray, const Hit& hit, PathState path) const;
    const Tracer& tracer() const { return tracer_; }
    size_t bytes() const;

  private:
    struct Element {
        uint32_t instance = 0, element = 0;
        uint32_t at_rest = kNone;  ///< its place among the triangles at rest
    };
    static constexpr uint32_t kNone = 0xffffffffu;
    struct Place;
    struct Asked;
    /// What an element is taken for when one is chosen.
    struct Estimate {
        Box3d bounds;
        double area = 0, radiance = 0;  ///< world units², mean of the probes
        LightCone cone;
    };

    std::vector<Element> elements_;
    std::vector<int32_t> table_of_instance_;              ///< -1: does not emit
    std::vector<LightLink> links_;                        ///< per table; empty: all shine on all
    std::vector<StillTriangle> still_;                    ///< of meshes at rest, whose triangles are found once
    std::vector<std::vector<uint32_t>> item_of_element_;  ///< per table; kNone: does not emit
    const Tracer& tracer_;
    SurfaceEmission emission_;
    EvenEmission even_emission_;

    bool is_at_rest(uint32_t instance) const;
    StillTriangle at_rest(const Element& of) const;
    SeenTriangle seen(const Element& of, float time, const Vec3d& from) const;
    /// The normal at a point of an element in world space, as long as the world area per unit of parameters.
    static Vec3d area(const Affine3d& local_to_world, const Shape& shape, const ElementPoint& point);
    Vec3d area(const Element& of, const ElementPoint& point, float time) const;
    LightSample* begin_light(const Wanted& wanted, const Vec3d& offset, double seen_density, const Vec3d& area) const;
    LightSample* light_at(const Place& place) const;
    void sample(const StillTriangle& triangle, const Wanted& wanted, Asked& asked) const;
    void sample(const Wanted& wanted, Asked& asked) const;
    /// `looks`: whether a side that is shut in is told from others.
    Estimate estimate(const Element& of, bool looks) const;
    bool is_around_all(uint32_t instance, const CancelToken& cancel) const;
    void take_even_part_of_skies(std::vector<Estimate>& estimates, const CancelToken& cancel) const;
    size_t table_of(uint32_t item) const { return static_cast<size_t>(table_of_instance_[instance(item)]); }
};

}  // namespace rayleaf
