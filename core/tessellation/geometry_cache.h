// The geometry cache: tessellations at three resolutions for all shapes of a scene, within a budget of memory
// (Christensen, Laur, Fong, Wooten, Batali, "Ray Differentials and Multiresolution Geometry Caching for Distribution
// Ray Tracing in Complex Scenes", Eurographics 2003, section 5.2).
//
// Its contents change the time, never the picture: a grid is a pure function of (subpatch, level), so one that is not
// there is diced again. A lookup never waits. A thread that misses dices into a free slot, or if there is none now,
// into a grid of its own.
//
// Departures from the paper: the coarse level is four corners, stored in the record that the choice of a level reads
// anyway (tessellation/level.h), so it is never looked up, missed or diced again; medium and fine grids share one
// budget, so that memory goes where rays are, instead of equal thirds; the clock algorithm replaces a list of the least
// recently used, because it needs no lock; the bookkeeping counts within the budget; when memory is too small for the
// working set, a grid must be missed twice before it gets a slot; the parts of a split subpatch are stored one by one.
#pragma once

#include "base/thread_states.h"
#include "base/zeroed_array.h"
#include "tessellation/dicer.h"
#include "tessellation/level.h"
#include "tessellation/readers.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <memory>

namespace rayleaf {

class GridArena;

enum class CacheMode : uint8_t {
    Multi,   ///< three levels
    Single,  ///< fine grids only: the single-resolution cache that the paper compares with
    None     ///< nothing is kept
};

struct GeometryCacheSettings {
    /// All memory of the cache: grids, bookkeeping, the threads' own grids. However small it is, each thread has what
    /// it needs to work without the cache.
    uint64_t budget = uint64_t{30} << 20;
    CacheMode mode = CacheMode::Multi;
    LevelRule rule;
    /// Memory for resident facets, bytes; objects beyond it go through the cache.
    uint64_t resident_budget = 0;
};

/// From megabytes as users give them; zero or less: no cache.
inline uint64_t budget_from_megabytes(double megabytes) {
    constexpr double kMost = 1e9;  // a petabyte
    return megabytes > 0.0 ? static_cast<uint64_t>(std::min(megabytes, kMost) * 1048576.0) : 0;
}

/// Counters of one level.
struct LevelCounters {
    uint64_t lookups = 0;
    uint64_t diced = 0;     ///< tessellations: lookups that missed
    uint64_t cold = 0;      ///< of these, the first of their subpatch and level; 0 where not counted
    uint64_t bypassed = 0;  ///< of those diced, the ones that got no slot
    uint64_t bytes = 0;     ///< of the units that hold the level's grids now

    uint64_t recomputed() const { return diced - cold; }
};

struct GeometryCacheStatistics {
    std::array<LevelCounters, kStoredLevels> levels;  ///< coarse to fine
    /// Of parts of split subpatches. Cold ones are recognized by hashes, so a few of them may not be counted as
    /// cold.
    LevelCounters parts;
    uint64_t splits = 0;  ///< how often a ray needed a split subpatch: finer than the finest level
    uint64_t bytes = 0;   ///< held now, in all
    uint64_t budget = 0;
    bool cold_counted = true;  ///< false if one bit for each subpatch and level exceeds the budget

    uint64_t vertices_diced() const;
    uint64_t vertices_recomputed() const;  ///< the cost of the cache (section 6.1)
};

constexpr uint64_t kLevelVertices[kStoredLevels] = {4, 25, 289};

class GeometryCache {
  public:
    /// For subpatches numbered below `subpatch_count`.
    GeometryCache(const GeometryCacheSettings& settings, uint32_t subpatch_count);
    ~GeometryCache();
    GeometryCache(const GeometryCache&) = delete;
    GeometryCache& operator=(const GeometryCache&) = delete;

    class Reader;
    const GeometryCacheSettings& settings() const { return settings_; }
    GeometryCacheStatistics statistics() const;

  private:
    struct ThreadState;
    std::unique_ptr<GridArena> arena_;
    /// A bit for each (subpatch, level) diced so far, and for hashes of parts. For counting only: they publish nothing.
    ZeroedArray<std::atomic<uint64_t>> seen_, seen_parts_;
    uint64_t seen_part_words_ = 0;
    GeometryCacheSettings settings_;
    uint32_t subpatch_count_;
    mutable ReaderEpochs epochs_;
    mutable ThreadStates<ThreadState> states_;

    uint64_t seen_bytes() const;
    static uint64_t thread_bytes();
    void count_lookup(ThreadState& state, int level) const;
    template <typename GridType>
    const GridType& look_up(ThreadState& state, uint32_t first, const Dicer& dicer, uint32_t subpatch) const;
    template <typename GridType>
    const GridType& dice_missing(ThreadState& state, uint32_t key, const Dicer& dicer, uint32_t subpatch) const;
    template <typename MissedLately>
    bool deserves_slot(ThreadState& state, int level, const MissedLately& missed_lately) const;
    bool deserves_slot(ThreadState& state, int level, uint32_t key) const;
    void count_cold(ThreadState& state, int level, uint64_t bit) const;
    const Grid& part(ThreadState& state, uint32_t first, const Dicer& dicer, uint32_t subpatch,
                     const GridPart& part) const;
};

/// RAII guard of one thread's access for the time of a ray; announced when it asks for the first grid. Grids are valid
/// until it ends, or until the same thread asks for another grid of the same level.
class GeometryCache::Reader {
  public:
    explicit Reader(const GeometryCache& cache);
    ~Reader();
    Reader(const Reader&) = delete;
    Reader& operator=(const Reader&) = delete;

    /// Counts a ray that sees only the corners of a subpatch.
    void count_coarse() const;
    /// `first` is the number of the dicer's first subpatch in the cache.
    const MediumGrid& medium(const Dicer& dicer, uint32_t first, uint32_t subpatch) const;
    const Grid& fine(const Dicer& dicer, uint32_t first, uint32_t subpatch) const;
    /// The fine level in steps, for dicers that have them.
    const StepGrid& steps(const Dicer& dicer, uint32_t first, uint32_t subpatch) const;
    /// Counts a ray that needs a split subpatch.
    void count_split() const;
    /// A part beyond the fine level. Valid until the thread asks for another part of the same level.
    const Grid& part(const Dicer& dicer, uint32_t first, uint32_t subpatch, const GridPart& part) const;
    const LevelRule& rule() const { return cache_.settings_.rule; }
    /// Tessellations made by this thread so far.
    uint64_t misses() const;

  private:
    const GeometryCache& cache_;
    ThreadState& state_;
    mutable bool entered_ = false;

    void enter() const;
};

}  // namespace rayleaf
