// The state of one thread while it asks the fast tree.
#pragma once

#include "base/cache_line.h"
#include "ri_tree/fast_tree.h"

namespace rayleaf {

/// Up to sixteen questions, and where their answers go. Optional arrays are null.
struct FastTree::Batch {
    int count;
    const Ray* rays;
    const RaySpacing* spacings;
    const RayDifferential* differentials;
    CachedAnswer* answers;
    HitChanges* changes;
};

/// How far a ray has descended: the step, and the reference to the cell there (CellNode::children); null: in no block.
///
struct FastTree::Descent {
    int step = 0;
    std::atomic<CellRef>* place = nullptr;
};

/// The working state of a thread that answers.
struct FastTree::Search {
    LineBatch batch;
    std::array<Descent, kBatchRays> descents;  ///< of the batch's rays
    CellStore::Reader reader;
    std::array<uint64_t, kAnswerKinds> answers{};
    uint64_t samples_taken = 0;
    CellLeaf own_leaf;  ///< of a cell for which there was no room
    Uninterpolated others;

    Search(CellStore& store, Uninterpolated uninterpolated) : reader(store), others(uninterpolated) {}
    ~Search() {
        CellCounts& counts = reader.counts();
        for (size_t i = 0; i < answers.size(); ++i)
            if (answers[i] > 0) counts.answers[i].fetch_add(answers[i], std::memory_order_relaxed);
        if (samples_taken > 0) counts.samples_taken.fetch_add(samples_taken, std::memory_order_relaxed);
    }
};

/// A final cell, or one that too few rays cross.
struct FastTree::Found {
    CellKey key;
    int step = 0;
    CellVerdict verdict = CellVerdict::Unknown;
    const CellLeaf* leaf = nullptr;
};

/// Prefetches a leaf. Level 3: into all of the processor's caches. Level 2: into all but the first, where several
/// leaves are fetched at once, more than the first cache can wait for.
template <int kLevel>
void prefetch(const CellLeaf& leaf) {
    // The size of a mirror's leaf; the processor itself fetches the rest of larger ones.
    constexpr size_t kBytes = offsetof(CellLeaf, coefficients) + size_t{kCubicTerms} * 3 * sizeof(float);
    const auto* bytes = reinterpret_cast<const std::byte*>(&leaf);
    for (size_t at = 0; at < kBytes; at += kCacheLine) __builtin_prefetch(bytes + at, 0, kLevel);
}

/// A ray's places along the axes.
inline LinePlaces places_of(const LineBatch& batch, int ray) {
    LinePlaces places{};
    for (int k = 0; k < kLineAxes; ++k) places[k] = static_cast<uint32_t>(batch.place[k][ray]);
    return places;
}

}  // namespace rayleaf
