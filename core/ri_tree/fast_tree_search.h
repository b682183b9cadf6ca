// What one thread holds while it asks the fast tree.
#pragma once

#include "ri_tree/fast_tree.h"

namespace rayleaf {

/// Up to sixteen questions, and where answers go. What may be null is left out.
struct FastTree::Batch {
    int count;
    const Ray* rays;
    const RaySpacing* spacings;
    const RayDifferential* differentials;
    CachedAnswer* answers;
    HitChanges* changes;
};

/// What a thread needs while it answers.
struct FastTree::Search {
    LineBatch batch;
    CellStore::Reader reader;
    std::array<uint64_t, kAnswerKinds> answers{};
    uint64_t samples_taken = 0;
    CellLeaf own_leaf;  ///< of a cell that there was no room for
    Uninterpolated others;

    Search(CellStore& store, Uninterpolated uninterpolated) : reader(store), others(uninterpolated) {}
    ~Search() {
        CellCounts& counts = reader.counts();
        for (size_t i = 0; i < answers.size(); ++i)
            if (answers[i] > 0) counts.answers[i].fetch_add(answers[i], std::memory_order_relaxed);
        if (samples_taken > 0) counts.samples_taken.fetch_add(samples_taken, std::memory_order_relaxed);
    }
};

/// A final cell, or one that a ray does not pay for.
struct FastTree::Found {
    CellKey key;
    int step = 0;
    CellVerdict verdict = CellVerdict::Unknown;
    const CellLeaf* leaf = nullptr;
};

}  // namespace rayleaf
