// A ray cache while a probe tries it: each block of pixels has a tree of its own, empty at first, so that blocks may be
// rendered by several threads and are counted alike whatever is rendered beside them.
#pragma once

#include "ri_tree/fast_tree.h"

#include <memory>

#include <oneapi/tbb/enumerable_thread_specific.h>

namespace rayleaf {

class TriedCache final : public RayCache {
  public:
    /// Trees share what this one traces samples by; it stays empty.
    explicit TriedCache(std::shared_ptr<const FastTree> model) : model_(std::move(model)) {}

    /// This thread begins a block, and ends it. What it asks outside of blocks is for the caller to trace.
    void begin_block() { trees_.local() = model_->emptied(); }
    void end_block() { trees_.local().reset(); }

    void ask(const RayQuestions& questions, std::span<CachedAnswer> answers, std::span<HitChanges> changes) override {
        if (FastTree* tree = trees_.local().get()) return tree->ask(questions, answers, changes);
        std::fill(answers.begin(), answers.end(), CachedAnswer{{}, AnsweredBy::TracedNotWorthIt, 0.0, 0.0});
        std::fill(changes.begin(), changes.end(), HitChanges{});
    }
    using RayCache::ask;
    OutputRay trace(const Ray& object_ray) const override { return model_->trace(object_ray); }
    /// Of this thread's block.
    RayCacheStatistics statistics() const override {
        const std::unique_ptr<FastTree>& tree = trees_.local();
        return tree ? tree->statistics() : RayCacheStatistics{};
    }

  private:
    std::shared_ptr<const FastTree> model_;
    using Trees =
        oneapi::tbb::enumerable_thread_specific<std::unique_ptr<FastTree>, std::allocator<std::unique_ptr<FastTree>>>;
    mutable Trees trees_;
};

}  // namespace rayleaf
