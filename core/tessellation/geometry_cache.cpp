#include "tessellation/geometry_cache.h"

#include "tessellation/dice.h"

#include <thread>

namespace rayleaf {
namespace {

using Kind = GridArena::Kind;

/// What a level's grids are called.
template <typename GridType>
constexpr int kLevelOf = kFine;
template <>
constexpr int kLevelOf<MediumGrid> = kMedium;
template <typename GridType>
constexpr Kind kKindOf = Kind::Fine;
template <>
constexpr Kind kKindOf<MediumGrid> = Kind::Medium;

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

}  // namespace

/// What a thread has of its own: room to dice without the cache, and its counters.
struct alignas(64) GeometryCache::ThreadState {
    Grid fine;
    MediumGrid medium;
    std::unique_ptr<Grid> parts[kFinestLevel - kFine];
    struct Level {
        Counter lookups, diced, cold, bypassed;
        uint32_t spare = GridArena::kNone;  ///< a slot that no one sees
        uint32_t window_lookups = 0, window_misses = 0;
        bool thrashes = false;
    };
    Level levels[kStoredLevels];
    Counter splits, parts_diced, part_bytes;

    Grid& scratch(const Grid*) { return fine; }
    MediumGrid& scratch(const MediumGrid*) { return medium; }
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

GeometryCache::GeometryCache(const GeometryCacheSettings& settings, uint32_t subpatch_count)
    : settings_(settings), subpatch_count_(subpatch_count) {
    if (settings.mode == CacheMode::Single) settings_.rule.resolution = LevelRule::Resolution::Single;
    // Workers, and the thread that waits for them and works too.
    const uint64_t threads = uint64_t{std::thread::hardware_concurrency()} + 1;
    const uint64_t fixed = sizeof(*this) + sizeof(GridArena) +
                           threads * (sizeof(ThreadState) + sizeof(ThreadState::parts) / sizeof(void*) * sizeof(Grid));
    uint64_t left = settings.mode == CacheMode::None ? 0 : settings.budget - std::min(settings.budget, fixed);
    if (seen_bytes() <= settings.budget / kSeenShare) {
        seen_ = std::make_unique<std::atomic<uint64_t>[]>(seen_bytes() / sizeof(uint64_t));
        left -= std::min(left, seen_bytes());
    }
    arena_ = std::make_unique<GridArena>(left, subpatch_count);
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
const GridType& GeometryCache::look_up(ThreadState& state, uint32_t first, const Dicer& dicer,
                                       uint32_t subpatch) const {
    ThreadState::Level& own = state.levels[kLevelOf<GridType>];
    own.lookups.add();
    if (++own.window_lookups == kWindow) {
        own.thrashes = own.window_misses >= kThrashingMisses;
        own.window_lookups = own.window_misses = 0;
    }
    const uint32_t key = first + subpatch, slot = arena_->find(kKindOf<GridType>, key);
    if (slot == GridArena::kNone) return dice_missing<GridType>(state, key, dicer, subpatch);
    GridType* grid = nullptr;
    arena_->grid(slot, grid);
    return *grid;
}

template <typename GridType>
const GridType& GeometryCache::dice_missing(ThreadState& state, uint32_t key, const Dicer& dicer,
                                            uint32_t subpatch) const {
    constexpr Kind kKind = kKindOf<GridType>;
    ThreadState::Level& own = state.levels[kLevelOf<GridType>];
    ++own.window_misses;
    own.diced.add();
    count_cold(state, kLevelOf<GridType>, key);
    const bool not_worth_it = arena_->empty() || (own.thrashes && arena_->full() && !arena_->missed_lately(kKind, key));
    if (!not_worth_it && own.spare == GridArena::kNone)
        own.spare = arena_->acquire(kKind, epochs_).value_or(GridArena::kNone);
    if (not_worth_it || own.spare == GridArena::kNone) {
        own.bypassed.add();
        GridType& grid = state.scratch(static_cast<GridType*>(nullptr));
        dice_grid(dicer, subpatch, grid);
        return grid;
    }
    GridType* grid = nullptr;
    arena_->grid(own.spare, grid);
    dice_grid(dicer, subpatch, *grid);
    if (arena_->publish(kKind, key, own.spare, epochs_))
        own.spare = GridArena::kNone;
    else
        own.bypassed.add();
    return *grid;
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
    result.levels[kMedium].bytes = arena_->bytes(Kind::Medium);
    result.levels[kFine].bytes = arena_->bytes(Kind::Fine);
    result.bytes = sizeof(*this) + sizeof(GridArena) + (seen_ ? seen_bytes() : 0) + arena_->bytes();
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
}

void GeometryCache::Reader::enter() const {
    if (entered_ || cache_->epochs_.is_inside(number_)) return;
    cache_->epochs_.enter(number_);
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

void GeometryCache::Reader::count_coarse() const {
    state_->levels[kCoarse].lookups.add();
}

const MediumGrid& GeometryCache::Reader::medium(const Dicer& dicer, uint32_t first, uint32_t subpatch) const {
    if (own_state_) return diced_alone(dicer, subpatch, state_->medium);
    enter();
    return cache_->look_up<MediumGrid>(*state_, first, dicer, subpatch);
}

const Grid& GeometryCache::Reader::fine(const Dicer& dicer, uint32_t first, uint32_t subpatch) const {
    if (own_state_) return diced_alone(dicer, subpatch, state_->fine);
    enter();
    return cache_->look_up<Grid>(*state_, first, dicer, subpatch);
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
    dicer.levels()->dice_part(subpatch, part, *grid);
    state_->parts_diced.add();
    return *grid;
}

uint64_t GeometryCache::Reader::misses() const {
    uint64_t sum = state_->parts_diced.value();
    for (const ThreadState::Level& level : state_->levels) sum += level.diced.value();
    return sum;
}

}  // namespace rayleaf
