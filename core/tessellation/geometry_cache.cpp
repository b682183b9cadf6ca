#include "tessellation/geometry_cache.h"

#include "tessellation/dice.h"

#include <thread>

namespace rayleaf {
namespace {

/// A level thrashes if this share of a thread's last so many lookups found nothing.
constexpr uint32_t kWindow = 1024, kThrashingMisses = kWindow / 4;

/// Cold tessellations are counted while a bit for each takes no more than this share of the budget.
constexpr uint64_t kSeenShare = 20;

/// Counters that one thread writes and others read.
class Counter {
  public:
    void add() { value_.store(value_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed); }
    uint64_t value() const { return value_.load(std::memory_order_relaxed); }

  private:
    std::atomic<uint64_t> value_{0};
};

void dice_grid(const Dicer& dicer, uint32_t subpatch, Grid& grid) {
    dicer.dice(subpatch, grid);
}
void dice_grid(const Dicer& dicer, uint32_t subpatch, MediumGrid& grid) {
    dicer.levels()->dice_medium(subpatch, grid);
}
void dice_grid(const Dicer& dicer, uint32_t subpatch, CoarseGrid& grid) {
    dicer.levels()->dice_coarse(subpatch, grid);
}

}  // namespace

/// What a thread has of its own: room to dice without the cache, and its counters.
struct alignas(64) GeometryCache::ThreadState {
    Grid fine;
    MediumGrid medium;
    CoarseGrid coarse;
    std::unique_ptr<Grid> parts[kFinestLevel - kFine];
    struct Level {
        Counter lookups, diced, cold, bypassed;
        uint32_t spare = GridIndex::kNone;  ///< a slot that no one sees
        uint32_t window_lookups = 0, window_misses = 0;
        bool thrashes = false;
    };
    Level levels[kStoredLevels];
    Counter splits, parts_diced, part_bytes;

    Grid& scratch(const Grid*) { return fine; }
    MediumGrid& scratch(const MediumGrid*) { return medium; }
    CoarseGrid& scratch(const CoarseGrid*) { return coarse; }
};

uint64_t GeometryCacheStatistics::vertices_diced() const {
    uint64_t sum = parts_diced * kLevelVertices[kFine];
    for (int level = 0; level < kStoredLevels; ++level) sum += levels[level].diced * kLevelVertices[level];
    return sum;
}

uint64_t GeometryCacheStatistics::vertices_recomputed() const {
    uint64_t sum = 0;
    for (int level = 0; level < kStoredLevels; ++level) sum += levels[level].recomputed() * kLevelVertices[level];
    return sum;
}

template <typename GridType>
GeometryCache::Pool<GridType>::Pool(uint64_t budget, uint32_t keys)
    : slots(budget, sizeof(GridType), keys), grids(std::make_unique_for_overwrite<GridType[]>(slots.capacity())) {}

GeometryCache::GeometryCache(const GeometryCacheSettings& settings, uint32_t subpatch_count)
    : settings_(settings), subpatch_count_(subpatch_count) {
    if (settings.mode == CacheMode::Single) settings_.rule.resolution = LevelRule::Resolution::Single;
    // Workers, and the thread that waits for them and works too.
    const uint64_t threads = uint64_t{std::thread::hardware_concurrency()} + 1;
    const uint64_t fixed =
        sizeof(*this) + threads * (sizeof(ThreadState) + sizeof(ThreadState::parts) / sizeof(void*) * sizeof(Grid));
    uint64_t left = settings.mode == CacheMode::None ? 0 : settings.budget - std::min(settings.budget, fixed);
    if (seen_bytes() <= settings.budget / kSeenShare) {
        seen_ = std::make_unique<std::atomic<uint64_t>[]>(seen_bytes() / sizeof(uint64_t));
        left -= std::min(left, seen_bytes());
    }
    const uint64_t third = settings.mode == CacheMode::Multi ? left / kStoredLevels : 0;
    coarse_ = std::make_unique<Pool<CoarseGrid>>(third, subpatch_count);
    medium_ = std::make_unique<Pool<MediumGrid>>(third, subpatch_count);
    fine_ = std::make_unique<Pool<Grid>>(settings.mode == CacheMode::Multi ? third : left, subpatch_count);
}

GeometryCache::~GeometryCache() {
    for (std::atomic<ThreadState*>& state : states_) delete state.load(std::memory_order_acquire);
}

uint64_t GeometryCache::seen_bytes() const {
    return (uint64_t{subpatch_count_} * kStoredLevels / 64 + 1) * sizeof(uint64_t);
}

GeometryCache::ThreadState* GeometryCache::state_of(int reader) const {
    ThreadState* state = states_[reader].load(std::memory_order_acquire);
    if (state) return state;
    state = new ThreadState;
    states_[reader].store(state, std::memory_order_release);  // only this thread has the number
    return state;
}

template <typename GridType>
const GridType& GeometryCache::look_up(ThreadState& state, Pool<GridType>& pool, int level, uint32_t key,
                                       const Dicer& dicer, uint32_t subpatch) const {
    ThreadState::Level& own = state.levels[level];
    own.lookups.add();
    if (++own.window_lookups == kWindow) {
        own.thrashes = own.window_misses >= kThrashingMisses;
        own.window_lookups = own.window_misses = 0;
    }
    const uint32_t slot = pool.slots.find(key);
    if (slot != GridIndex::kNone) return pool.grids[slot];
    return dice_missing(state, pool, level, key, dicer, subpatch);
}

template <typename GridType>
const GridType& GeometryCache::dice_missing(ThreadState& state, Pool<GridType>& pool, int level, uint32_t key,
                                            const Dicer& dicer, uint32_t subpatch) const {
    ThreadState::Level& own = state.levels[level];
    ++own.window_misses;
    own.diced.add();
    count_cold(state, level, key);
    const bool not_worth_it =
        pool.slots.capacity() == 0 || (own.thrashes && pool.slots.full() && !pool.slots.missed_lately(key));
    if (!not_worth_it && own.spare == GridIndex::kNone)
        own.spare = pool.slots.acquire(epochs_).value_or(GridIndex::kNone);
    if (not_worth_it || own.spare == GridIndex::kNone) {
        own.bypassed.add();
        GridType& grid = state.scratch(static_cast<GridType*>(nullptr));
        dice_grid(dicer, subpatch, grid);
        return grid;
    }
    GridType& grid = pool.grids[own.spare];
    dice_grid(dicer, subpatch, grid);
    if (pool.slots.publish(key, own.spare, epochs_))
        own.spare = GridIndex::kNone;
    else
        own.bypassed.add();
    return grid;
}

void GeometryCache::count_cold(ThreadState& state, int level, uint32_t key) const {
    if (!seen_) return;
    const uint64_t bit = uint64_t{key} * kStoredLevels + static_cast<uint64_t>(level);
    const uint64_t mask = uint64_t{1} << (bit % 64);
    if ((seen_[bit / 64].fetch_or(mask, std::memory_order_relaxed) & mask) == 0) state.levels[level].cold.add();
}

GeometryCacheStatistics GeometryCache::statistics() const {
    GeometryCacheStatistics result;
    result.budget = settings_.budget;
    result.cold_counted = seen_ != nullptr;
    const auto held = [](const GridSlots& slots, size_t slot_bytes) {
        return slots.tracking_bytes() + slots.slots_in_use() * slot_bytes;
    };
    result.levels[kCoarse].bytes = held(coarse_->slots, sizeof(CoarseGrid));
    result.levels[kMedium].bytes = held(medium_->slots, sizeof(MediumGrid));
    result.levels[kFine].bytes = held(fine_->slots, sizeof(Grid));
    result.bytes = sizeof(*this) + (seen_ ? seen_bytes() : 0);
    for (const LevelCounters& level : result.levels) result.bytes += level.bytes;
    for (const std::atomic<ThreadState*>& each : states_) {
        const ThreadState* state = each.load(std::memory_order_acquire);
        if (!state) continue;
        result.bytes += sizeof(ThreadState) + state->part_bytes.value() * sizeof(Grid);
        result.splits += state->splits.value();
        result.parts_diced += state->parts_diced.value();
        for (int level = 0; level < kStoredLevels; ++level) {
            const ThreadState::Level& own = state->levels[level];
            result.levels[level].lookups += own.lookups.value();
            result.levels[level].diced += own.diced.value();
            result.levels[level].cold += own.cold.value();
            result.levels[level].bypassed += own.bypassed.value();
        }
    }
    return result;
}

GeometryCache::Reader::Reader(const GeometryCache& cache) : cache_(&cache), number_(reader_number()) {
    if (number_ < 0) {
        own_state_ = std::make_unique<ThreadState>();
        state_ = own_state_.get();
        return;
    }
    state_ = cache.state_of(number_);
    if (cache.epochs_.is_inside(number_)) return;
    cache.epochs_.enter(number_);
    entered_ = true;
}

GeometryCache::Reader::~Reader() {
    if (entered_) cache_->epochs_.leave(number_);
}

namespace {

/// For threads without a number: diced, and not looked for.
template <typename GridType>
const GridType& diced_alone(const Dicer& dicer, uint32_t subpatch, GridType& grid) {
    dice_grid(dicer, subpatch, grid);
    return grid;
}

}  // namespace

const CoarseGrid& GeometryCache::Reader::coarse(const Dicer& dicer, uint32_t first, uint32_t subpatch) const {
    if (own_state_) return diced_alone(dicer, subpatch, state_->coarse);
    return cache_->look_up(*state_, *cache_->coarse_, kCoarse, first + subpatch, dicer, subpatch);
}

const MediumGrid& GeometryCache::Reader::medium(const Dicer& dicer, uint32_t first, uint32_t subpatch) const {
    if (own_state_) return diced_alone(dicer, subpatch, state_->medium);
    return cache_->look_up(*state_, *cache_->medium_, kMedium, first + subpatch, dicer, subpatch);
}

const Grid& GeometryCache::Reader::fine(const Dicer& dicer, uint32_t first, uint32_t subpatch) const {
    if (own_state_) return diced_alone(dicer, subpatch, state_->fine);
    return cache_->look_up(*state_, *cache_->fine_, kFine, first + subpatch, dicer, subpatch);
}

void GeometryCache::Reader::count_split() const {
    state_->splits.add();
}

const Grid& GeometryCache::Reader::part(const Dicer& dicer, uint32_t subpatch, const GridPart& part) const {
    std::unique_ptr<Grid>& grid = state_->parts[part.level - kFine - 1];
    if (!grid) {
        grid = std::make_unique<Grid>();
        state_->part_bytes.add();
    }
    GridRows rows;
    dicer.levels()->dice_part(subpatch, part, rows);
    pack(rows, *grid);
    state_->parts_diced.add();
    return *grid;
}

uint64_t GeometryCache::Reader::misses() const {
    uint64_t sum = state_->parts_diced.value();
    for (const ThreadState::Level& level : state_->levels) sum += level.diced.value();
    return sum;
}

}  // namespace rayleaf
