// The ray cache that renders: any number of threads, sixteen rays at a time, memory within a limit.
//
// Idea: the tree of the reference (reference_tree.h), laid out for today's processors and asked for less.
//   Sixteen rays go together from leaf to leaf (line_batch.h): one looks for its cell, all that are in it are answered.
//   Leaves are polynomials of degree 3 (cell_leaf.h), so they are few.
//   Cells are tested at every fourth depth; corners and centres are shared through a table (sample_table.h).
//   Cells are only sampled if enough of the frame's rays cross them to pay for the samples. That is told from the rays'
//   spacing and the cell alone: a ray that asks for too little is traced even where others have paid already.
//   What makes a cell final differs from the paper's: cell_judge.h. How cells are held: cell_store.h.
//
// An answer is a pure function of ray, spacing, shape, material and settings.
#pragma once

#include "ri_tree/cell_judge.h"
#include "ri_tree/cell_store.h"
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
    /// Throws InputError for settings without meaning. Nothing is sampled yet. `pruned_share` is not used: the store
    /// forgets about a half.
    FastTree(std::shared_ptr<const Shape> shape, const SampleSettings& samples, const RayCacheSettings& settings);
    ~FastTree() override;

    /// Thread-safe.
    void ask(std::span<const Ray> rays, std::span<const RaySpacing> spacings, std::span<CachedAnswer> answers,
             Uninterpolated others) override;
    using RayCache::ask;
    OutputRay trace(const Ray& object_ray) const override;
    RayCacheStatistics statistics() const override;

    /// The final cell that answers a ray, whether or not it is held; empty for a ray that is none or misses the box.
    std::optional<CellKey> final_cell(const Ray& object_ray);
    const LineSpace& space() const { return space_; }
    const SampleTracer& tracer() const { return tracer_; }

  private:
    /// A depth at which cells are tested, counted by fours.
    struct Step {
        std::array<uint8_t, kLineAxes> levels{};
        /// How the child is found that holds a place: bit j of its number is this bit of the place along this axis.
        std::array<uint8_t, 4> axis{}, bit{};
        /// 1 over the sides: intercepts in local units, slopes.
        std::array<float, kLineAxes> inverse_sides{};
    };
    struct Search;
    struct Found;

    SampleTracer tracer_;
    RayCacheSettings settings_;
    LineSpace space_;
    CellJudge judge_;
    BatchFrame frame_;
    BatchFunctions functions_;
    int deepest_ = 0;                                                    ///< step of the smallest cells
    int deepest_mixed_ = 0;                                              ///< of the smallest ones of several classes
    std::array<std::array<Step, kGreatestCellDepth / 4 + 1>, 3> steps_;  ///< by axis of the dominant direction
    SampleTable samples_;
    CellStore store_;

    void prepare_steps();
    int deepest_worth(int axis, const RaySpacing& spacing) const;
    Ray to_local(const Ray& object_ray) const;
    OutputRay to_object(OutputRay local) const;

    void ask_batch(Search& search, const Ray* rays, const RaySpacing* spacings, int count, CachedAnswer* answers);
    void answer_cell(Search& search, const Found& found, RaySet set, const Ray* rays, CachedAnswer* answers);
    CachedAnswer interpolated(const Search& search, const Found& found, int ray, const Ray& given, const float* values,
                              size_t stride) const;
    CachedAnswer traced(const Search& search, const Ray& object_ray, AnsweredBy reason) const;

    Found find(Search& search, int ray, int deepest_worth);
    CellKey key_at(const LineBatch& batch, int ray, int step) const;
    CellPlace place_of(const CellKey& key) const;
    CellVerdict make_cell(Search& search, const CellKey& key, int step);
    CellRef add_cell(Search& search, const CellKey& key, int step, std::atomic<CellRef>& place);
};

}  // namespace rayleaf
