// The ray interpolant tree as published: E. B. Atalay and D. M. Mount, Interpolation over Light Fields with
// Applications in Computer Graphics ("RI"). The slow twin of the fast tree that artists use, and its baseline.
//
// Idea: six binary trees over the directed lines through an object's box. A cell holds the output rays of its 16 corner
// lines; it is halved, on demand and only along the path of the line asked for, until the ray interpolated at its
// centre is close to the true one. Then the cell is final and its lines are interpolated.
//
// Departures from the paper, each with its reason where it is made:
//   root cells by a middle plane and slopes                                        line_space.h
//   the distance of output rays, its unit; reflection beside refraction            output_ray.h, ray_cache.h
//   classes include what happened inside glass                                     output_ray.h
//   origins inside the box                                                         ray_cache.h
//   a cell whose corners all miss is final only if it is narrow: 17 misses say little about a large cell. One that the
//   depth limit leaves large is traced
//   cells of several classes are halved down to the depth limit (the paper's threshold has no value for them)
//   the first-hit test of a cell of two classes is the tracer's, against all patches instead of the few at the corners
//   volumes have no direction, therefore no angular test
//   cells are rebuilt from integers, so that pruning changes no answer
//
// One thread at a time: asking builds and prunes the tree without any lock.
#pragma once

#include "ri_tree/corner_weights.h"
#include "ri_tree/line_space.h"
#include "ri_tree/ray_cache.h"
#include "ri_tree/sample_pool.h"
#include "ri_tree/sample_tracer.h"

#include <array>
#include <memory>
#include <optional>

namespace rayleaf {

class ReferenceTree final : public RayCache {
  public:
    /// Throws InputError for invalid settings. Nothing is sampled yet.
    ReferenceTree(std::shared_ptr<const Shape> shape, const SampleSettings& samples, const RayCacheSettings& settings);
    ~ReferenceTree() override;

    /// Spacings are ignored: the paper samples every cell.
    void ask(const RayQuestions& questions, std::span<CachedAnswer> answers, std::span<HitChanges> changes) override;
    using RayCache::ask;
    OutputRay trace(const Ray& object_ray) const override;
    RayCacheStatistics statistics() const override;

    /// The final cell that answers a ray, held or not; empty for an invalid ray or one that misses the box.
    std::optional<CellKey> final_cell(const Ray& object_ray);
    const LineSpace& space() const { return space_; }
    const SampleTracer& tracer() const { return tracer_; }

  private:
    struct Leaf;
    struct Node;
    struct Found {
        const Node* node;
        CellKey key;
    };

    SampleTracer tracer_;
    RayCacheSettings settings_;
    LineSpace space_;
    SamplePool samples_;
    std::array<std::unique_ptr<Node>, kLineDirections> roots_;
    uint64_t clock_ = 0;
    RayCacheStatistics statistics_;

    Ray to_local(const Ray& object_ray) const;
    OutputRay to_object(OutputRay local) const;
    CachedAnswer answer(const Ray& local, Uninterpolated others);
    CachedAnswer answer_in(const Found& found, const Line& line, const Ray& local, bool starts_inside) const;
    CachedAnswer answer_on_side(const Found& found, const Line& line, const Ray& local) const;
    CachedAnswer interpolated(const Ray& local);

    Found descend(const Line& line);
    std::unique_ptr<Node> make_root(uint8_t direction);
    std::unique_ptr<Node> make_child(const Node& parent, const CellKey& parent_key, bool upper);
    /// The leaf of a cell that is final; empty if it must be halved.
    std::unique_ptr<const Leaf> judge(const Node& node, const CellKey& key);
    std::unique_ptr<Leaf> sort_corners(const Node& node) const;
    void measure_angles(const Node& node, const CellKey& key, Leaf& leaf) const;
    OutputRay interpolate(const Node& node, const SampleClass& sample_class, const CornerWeights& weights,
                          const Vec3d& direction) const;
    SampleId take_sample(const Ray& ray);

    uint64_t held_bytes() const;
    void prune();
    void remove_older(std::unique_ptr<Node>& node, uint64_t stamp);
};

}  // namespace rayleaf
