// The ray cache that renders: any number of threads, sixteen rays at a time, memory within a limit.
//
// Idea: the published tree (rivals/reference_tree.h), laid out for today's processors and sampled where it is used.
//   Sixteen rays go together from leaf to leaf (line_batch.h): one looks for its cell, all that are in it are answered.
//   Leaves are polynomials of degree 3 (cell_leaf.h), so they are few.
//   Cells are tested at every fourth depth; corners and centres are shared through a table (sample_table.h).
//   Cells are sampled only if enough of the frame's rays cross them. Their number is estimated from the rays' spacing
//   and the cell alone: a ray with too wide a spacing is traced even where the cell is sampled already. In a cache
//   that is kept, rays of earlier frames that crossed a cell count too (crossing_counts.h).
//   Through convex bodies of glass, rays that no cell answers are followed by Newton's iteration (convex_path.h).
//   What makes a cell final differs from the paper's: cell_judge.h. How cells are held: cell_store.h.
//
// An answer is a pure function of ray, spacing, shape, material, settings, and the crossings of earlier frames.
#pragma once

#include "ri_tree/cell_judge.h"
#include "ri_tree/cell_steps.h"
#include "ri_tree/cell_store.h"
#include "ri_tree/convex_body.h"
#include "ri_tree/crossing_counts.h"
#include "ri_tree/line_batch.h"
#include "ri_tree/line_space.h"
#include "ri_tree/ray_cache.h"
#include "ri_tree/sample_table.h"
#include "ri_tree/sample_tracer.h"

#include <array>
#include <memory>
#include <optional>

namespace rayleaf {

class FastTree final : public RayCache {
  public:
    /// Throws InputError for invalid settings. Nothing is sampled yet. `pruned_share` is not used: the store forgets
    /// about half of its cells.
    /// Throws Cancelled soon after `cancel` says so.
    FastTree(std::shared_ptr<const Shape> shape, const SampleSettings& samples, const RayCacheSettings& settings,
             const CancelToken& cancel = kNeverCancelled);
    /// Another tree that answers as this one did when it was new; both share the tracer of samples.
    std::unique_ptr<FastTree> emptied() const;
    ~FastTree() override;

    /// Thread-safe.
    void ask(const RayQuestions& questions, std::span<CachedAnswer> answers, std::span<HitChanges> changes) override;
    using RayCache::ask;
    OutputRay trace(const Ray& object_ray) const override;
    RayCacheStatistics statistics() const override;
    void next_frame() override { crossings_.finish_frame(); }

    /// The final cell that answers a ray, held or not; empty for an invalid ray or one that misses the box.
    std::optional<CellKey> final_cell(const Ray& object_ray);
    /// The sample of a cell's corner or centre.
    FastSample sample(const LatticePoint& point) const;
    const LineSpace& space() const { return space_; }
    const SampleTracer& tracer() const { return *tracer_; }

  private:
    struct Batch;
    struct Search;
    struct Found;
    struct Descent;

    std::shared_ptr<const SampleTracer> tracer_;
    std::shared_ptr<const ConvexBody> body_;  ///< of convex glass, else null
    RayCacheSettings settings_;
    LineSpace space_;
    CellJudge judge_;
    CellSteps steps_;
    BatchFrame frame_;
    BatchFunctions functions_;
    SampleTable samples_;
    CellStore store_;
    CrossingCounts crossings_;

    FastTree(std::shared_ptr<const SampleTracer> tracer, std::shared_ptr<const ConvexBody> body,
             const RayCacheSettings& settings);
    void prepare_frame();
    Ray to_local(const Ray& object_ray) const;
    void move_to_object(OutputRay& local) const;

    void ask_batch(Search& search, const Batch& asked);
    std::array<int, kBatchRays> deepest_crossed(const Search& search, const Batch& asked, RaySet pending) const;
    void answer_cell(Search& search, const Found& found, RaySet set, const Batch& asked);
    bool follow(const Batch& asked, int ray) const;
    void interpolate(const Search& search, const Found& found, int ray, const Batch& asked, const float* values,
                     size_t stride) const;
    HitChanges changes_of(const Search& search, const Found& found, int ray, const Batch& asked,
                          const LineGeometry& line) const;
    void answer_plainly(const Search& search, const Ray& object_ray, AnsweredBy by, CachedAnswer& answer) const;

    void begin_descents(Search& search, RaySet set) const;
    void descend_together(Search& search, RaySet set, const std::array<int, kBatchRays>& crossed) const;
    Found find(Search& search, int ray, int deepest_crossed);
    bool crossed_before(const CellKey& key) const;
    void count_crossings(const LineBatch& batch, RaySet set, const std::array<int, kBatchRays>& crossed, int last);
    CellVerdict make_cell(Search& search, const CellKey& key, int step);
    CellVerdict copy_older(Search& search, const CellKey& key, int step) const;
    static CellRef store_cell(Search& search, CellVerdict verdict, std::atomic<CellRef>& place);
};

}  // namespace rayleaf
