#include "tessellation/geometry_cache.h"

#include "tessellation/dice.h"
#include "tessellation/grid_arena.h"

#include <thread>

namespace rayleaf {
namespace {

using Kind = GridArena::Kind;

/// A level thrashes if at least kThrashingMisses of a thread's last kWindow lookups were misses.
constexpr uint32_t kWindow = 1024, kThrashingMisses = kWindow / 4;

/// Cold tessellations are counted if one bit for each takes at most one part in this many of the budget.
constexpr uint64_t kSeenShare = 20;

/// Parts are counted like one more level.
constexpr int kParts = kStoredLevels, kCounted = kStoredLevels + 1;
constexpr uint64_t kSeenPartsShare = 40, kWordBits = 64;

/// Counters that one thread writes and others read.
class Counter {
  public:
    void add() { value_.store(value_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed); }
    uint64_t value() const { return value_.load(std::memory_order_relaxed); }

  private:
    std::atomic<uint64_t> value_{0};
};

/// For grids of each format: their kind, where they are stored, and how they are made.
constexpr Kind kind_of(const MediumGrid*) {
    return Kind::Medium;
}
constexpr Kind kind_of(const Grid*) {
    return Kind::Fine;
}
constexpr Kind kind_of(const StepGrid*) {
    return Kind::Steps;
}
constexpr int level_of(Kind kind) {
    return kind == Kind::Medium ? kMedium : kFine;
}
MediumGrid& grid_in(const GridArena& arena, uint32_t slot, const MediumGrid*) {
    return arena.medium(slot);
}
Grid& grid_in(const GridArena& arena, uint32_t slot, const Grid*) {
    return arena.fine(slot);
}
StepGrid& grid_in(const GridArena& arena, uint32_t slot, const StepGrid*) {
    return arena.steps(slot);
}
void dice(const Dicer& dicer, uint32_t subpatch, MediumGrid& grid) {
    dicer.levels()->dice_medium(subpatch, grid);
}
void dice(const Dicer& dicer, uint32_t subpatch, Grid& grid) {
    dicer.dice(subpatch, grid);
}
void dice(const Dicer& dicer, uint32_t subpatch, StepGrid& grid) {
    dicer.dice_steps(subpatch, grid);
}

}  // namespace

/// The state of one thread: room to dice without the cache, and its counters.
struct GeometryCache::ThreadState {
    union {
        Grid fine;
        StepGrid steps;
    };
    MediumGrid medium;
    std::unique_ptr<Grid> parts[kFinestLevel - kFine];
    struct Level {
        Counter lookups, diced, cold, bypassed;
        uint32_t window_lookups = 0, window_misses = 0;
        bool thrashes = false;
    };
    Level levels[kCounted];
    /// By kind, slots that no other thread sees.
    std::array<uint32_t, GridArena::kKinds> spares;
    Counter splits, part_bytes;
    ReaderEpochs::Reader& reader;

    explicit ThreadState(ReaderEpochs& epochs) : reader(epochs.reader()) { spares.fill(GridArena::kNone); }
    MediumGrid& scratch(const MediumGrid*) { return medium; }
    Grid& scratch(const Grid*) { return fine; }
    StepGrid& scratch(const StepGrid*) { return steps; }
    /// Dices into the thread's own grid for parts of that level.
    const Grid& dice_part(const Dicer& dicer, uint32_t subpatch, const GridPart& part) {
        std::unique_ptr<Grid>& grid = parts[part.level - kFine - 1];
        if (!grid) {
            grid = std::make_unique<Grid>();
            part_bytes.add();
        }
        dicer.levels()->dice_part(subpatch, part, *grid);
        return *grid;
    }
    /// A slot that no other thread sees, for a grid of a kind; kNone if there is none now.
    uint32_t spare(Kind kind, GridArena& arena, ReaderEpochs& epochs) {
        uint32_t& slot = spares[static_cast<size_t>(kind)];
        if (slot == GridArena::kNone) slot = arena.acquire(kind, epochs).value_or(GridArena::kNone);
        return slot;
    }
};

uint64_t GeometryCacheStatistics::vertices_diced() const {
    uint64_t sum = parts.diced * kLevelVertices[kFine];
    for (int level = 0; level < kStoredLevels; ++level) sum += levels[level].diced * kLevelVertices[level];
    return sum;
}

uint64_t GeometryCacheStatistics::vertices_recomputed() const {
    uint64_t sum = parts.recomputed() * kLevelVertices[kFine];
    for (int level = 0; level < kStoredLevels; ++level) sum += levels[level].recomputed() * kLevelVertices[level];
    return sum;
}

GeometryCache::GeometryCache(const GeometryCacheSettings& settings, uint32_t subpatch_count)
    : settings_(settings), subpatch_count_(subpatch_count) {
    if (settings.mode == CacheMode::Single) settings_.rule.resolution = LevelRule::Resolution::Single;
    // The workers, and the thread that waits for them and works too.
    const uint64_t threads = uint64_t{std::thread::hardware_concurrency()} + 1;
    const uint64_t fixed = sizeof(*this) + sizeof(GridArena) +
                           threads * (thread_bytes() + sizeof(ThreadState::parts) / sizeof(void*) * sizeof(Grid));
    uint64_t left = settings.mode == CacheMode::None ? 0 : settings.budget - std::min(settings.budget, fixed);
    if (seen_bytes() <= settings.budget / kSeenShare) {
        seen_ = ZeroedArray<std::atomic<uint64_t>>(seen_bytes() / sizeof(uint64_t));
        left -= std::min(left, seen_bytes());
        seen_part_words_ = settings.budget / kSeenPartsShare / sizeof(uint64_t);
        seen_parts_ = ZeroedArray<std::atomic<uint64_t>>(seen_part_words_);
        left -= std::min(left, seen_part_words_ * sizeof(uint64_t));
    }
    arena_ = std::make_unique<GridArena>(left, subpatch_count);
}

GeometryCache::~GeometryCache() = default;

uint64_t GeometryCache::thread_bytes() {
    return ThreadStates<ThreadState>::state_bytes() + ReaderEpochs::reader_bytes();
}

uint64_t GeometryCache::seen_bytes() const {
    return (uint64_t{subpatch_count_} * kStoredLevels / 64 + 1) * sizeof(uint64_t);
}

void GeometryCache::count_lookup(ThreadState& state, int level) const {
    ThreadState::Level& own = state.levels[level];
    own.lookups.add();
    if (++own.window_lookups < kWindow) return;
    own.thrashes = own.window_misses >= kThrashingMisses;
    own.window_lookups = own.window_misses = 0;
}

/// Counts a miss and decides whether to keep the grid.
template <typename MissedLately>
bool GeometryCache::deserves_slot(ThreadState& state, int level, const MissedLately& missed_lately) const {
    ThreadState::Level& own = state.levels[level];
    ++own.window_misses;
    own.diced.add();
    if (arena_->empty()) return false;
    return !own.thrashes || !arena_->full() || missed_lately();
}

bool GeometryCache::deserves_slot(ThreadState& state, int level, uint32_t key) const {
    count_cold(state, level, uint64_t{key} * kStoredLevels + static_cast<uint64_t>(level));
    const Kind kind = level == kFine ? Kind::Fine : Kind::Medium;
    return deserves_slot(state, level, [&] { return arena_->missed_lately(kind, key); });
}

template <typename GridType>
const GridType& GeometryCache::look_up(ThreadState& state, uint32_t first, const Dicer& dicer,
                                       uint32_t subpatch) const {
    constexpr const GridType* kFormat = nullptr;
    count_lookup(state, level_of(kind_of(kFormat)));
    const uint32_t key = first + subpatch, slot = arena_->find(kind_of(kFormat), key);
    return slot == GridArena::kNone ? dice_missing<GridType>(state, key, dicer, subpatch)
                                    : grid_in(*arena_, slot, kFormat);
}

template <typename GridType>
const GridType& GeometryCache::dice_missing(ThreadState& state, uint32_t key, const Dicer& dicer,
                                            uint32_t subpatch) const {
    constexpr const GridType* kFormat = nullptr;
    constexpr Kind kKind = kind_of(kFormat);
    constexpr int kLevel = level_of(kKind);
    const uint32_t spare = deserves_slot(state, kLevel, key) ? state.spare(kKind, *arena_, epochs_) : GridArena::kNone;
    GridType& grid = spare == GridArena::kNone ? state.scratch(kFormat) : grid_in(*arena_, spare, kFormat);
    dice(dicer, subpatch, grid);
    if (spare != GridArena::kNone && arena_->publish(kKind, key, spare, epochs_))
        state.spares[static_cast<size_t>(kKind)] = GridArena::kNone;
    else
        state.levels[kLevel].bypassed.add();
    return grid;
}

/// A thread may use parts of several levels at a time, so they are diced outside the cache and copied.
const Grid& GeometryCache::part(ThreadState& state, uint32_t first, const Dicer& dicer, uint32_t subpatch,
                                const GridPart& part) const {
    count_lookup(state, kParts);
    const GridArena::PartKey key(first + subpatch, part);
    const uint32_t slot = arena_->find(key);
    if (slot != GridArena::kNone) return arena_->fine(slot);
    const Grid& grid = state.dice_part(dicer, subpatch, part);
    if (seen_part_words_ > 0) count_cold(state, kParts, key.hash % (seen_part_words_ * kWordBits));
    const bool keep = deserves_slot(state, kParts, [&] { return arena_->missed_lately(key); });
    const uint32_t spare = keep ? state.spare(Kind::Part, *arena_, epochs_) : GridArena::kNone;
    if (spare != GridArena::kNone) arena_->fine(spare) = grid;
    if (spare != GridArena::kNone && arena_->publish(key, spare, epochs_))
        state.spares[static_cast<size_t>(Kind::Part)] = GridArena::kNone;
    else
        state.levels[kParts].bypassed.add();
    return grid;
}

/// Counts a cold tessellation, unless its bit is set already.
void GeometryCache::count_cold(ThreadState& state, int level, uint64_t bit) const {
    if (!seen_) return;
    std::atomic<uint64_t>& word = (level == kParts ? seen_parts_ : seen_)[bit / kWordBits];
    const uint64_t mask = uint64_t{1} << (bit % kWordBits);
    if ((word.fetch_or(mask, std::memory_order_relaxed) & mask) == 0) state.levels[level].cold.add();
}

GeometryCacheStatistics GeometryCache::statistics() const {
    GeometryCacheStatistics result;
    result.budget = settings_.budget;
    result.cold_counted = static_cast<bool>(seen_);
    result.levels[kMedium].bytes = arena_->bytes(Kind::Medium);
    result.levels[kFine].bytes = arena_->bytes(Kind::Fine) + arena_->bytes(Kind::Steps);
    result.parts.bytes = arena_->bytes(Kind::Part);
    result.bytes = sizeof(*this) + sizeof(GridArena) + (seen_ ? seen_bytes() : 0) + arena_->bytes();
    states_.for_each([&](const ThreadState& state) {
        result.bytes += thread_bytes() + state.part_bytes.value() * sizeof(Grid);
        result.splits += state.splits.value();
        for (int level = 0; level < kCounted; ++level) {
            const ThreadState::Level& own = state.levels[level];
            LevelCounters& counters = level == kParts ? result.parts : result.levels[level];
            counters.lookups += own.lookups.value();
            counters.diced += own.diced.value();
            counters.cold += own.cold.value();
            counters.bypassed += own.bypassed.value();
        }
    });
    if (result.parts.lookups > 0) result.bytes += seen_part_words_ * sizeof(uint64_t);
    return result;
}

GeometryCache::Reader::Reader(const GeometryCache& cache) : cache_(cache), state_(cache.states_.local(cache.epochs_)) {}

void GeometryCache::Reader::enter() const {
    if (entered_ || state_.reader.is_inside()) return;
    cache_.epochs_.enter(state_.reader);
    entered_ = true;
}

GeometryCache::Reader::~Reader() {
    if (entered_) ReaderEpochs::leave(state_.reader);
}

void GeometryCache::Reader::count_coarse() const {
    state_.levels[kCoarse].lookups.add();
}

const MediumGrid& GeometryCache::Reader::medium(const Dicer& dicer, uint32_t first, uint32_t subpatch) const {
    enter();
    return cache_.look_up<MediumGrid>(state_, first, dicer, subpatch);
}

const Grid& GeometryCache::Reader::fine(const Dicer& dicer, uint32_t first, uint32_t subpatch) const {
    enter();
    return cache_.look_up<Grid>(state_, first, dicer, subpatch);
}

const StepGrid& GeometryCache::Reader::steps(const Dicer& dicer, uint32_t first, uint32_t subpatch) const {
    enter();
    return cache_.look_up<StepGrid>(state_, first, dicer, subpatch);
}

void GeometryCache::Reader::count_split() const {
    state_.splits.add();
}

const Grid& GeometryCache::Reader::part(const Dicer& dicer, uint32_t first, uint32_t subpatch,
                                        const GridPart& part) const {
    enter();
    return cache_.part(state_, first, dicer, subpatch, part);
}

uint64_t GeometryCache::Reader::misses() const {
    uint64_t sum = 0;
    for (const ThreadState::Level& level : state_.levels) sum += level.diced.value();
    return sum;
}

}  // namespace rayleaf
