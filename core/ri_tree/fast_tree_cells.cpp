// The fast tree's cells: found, made where they are missing, and held.
#include "ri_tree/fast_tree.h"
#include "ri_tree/fast_tree_search.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace rayleaf {
namespace {

static_assert(1 << kStepDepths == kNodeChildren);

/// The centre, then pairs of opposite corners: samples that are likely to differ come early.
constexpr std::array<int, kCellCorners + 1> kSampleOrder = {
    kCenterSample, 0, 15, 3, 12, 5, 10, 6, 9, 1, 14, 2, 13, 4, 11, 7, 8};

/// A cell is sampled once the rays that crossed it in earlier frames are this share of those that one frame must have:
/// it will be crossed again. With a share of 1 a sequence of frames takes twice as long to get there; with 1/4, cells
/// are sampled that are not used often enough, and a sequence of glass that does not move is slower.
constexpr double kEarlierShare = 0.5;

}  // namespace

void FastTree::begin_descents(Search& search, RaySet set) const {
    CellBlock* block = search.reader.current();
    for (uint32_t rest = set; rest != 0; rest &= rest - 1) {
        const int ray = std::countr_zero(rest);
        const auto direction = static_cast<uint8_t>(search.batch.line_direction[ray]);
        search.descents[ray] = {0, block ? &block->root(direction) : nullptr};
    }
}

/// For rays that share few cells: all go down one step, then all the next, so that they wait for memory together. No
/// cell is made.
void FastTree::descend_together(Search& search, RaySet set, const std::array<int, kBatchRays>& crossed) const {
    const LineBatch& batch = search.batch;
    CellBlock* block = search.reader.current();
    if (!block) return;
    for (RaySet going = set; going != 0;) {
        for (uint32_t rest = going; rest != 0; rest &= rest - 1) {
            const int ray = std::countr_zero(rest);
            Descent& at = search.descents[ray];
            const CellRef ref = at.place->load(std::memory_order_acquire);
            const CellVerdict verdict = verdict_of(ref);
            if (verdict == CellVerdict::Interpolated) prefetch<2>(block->leaf(ref));
            if (verdict != CellVerdict::Halved || at.step >= crossed[ray]) {
                going = static_cast<RaySet>(going & ~(1 << ray));
                continue;
            }
            const auto direction = static_cast<uint8_t>(batch.line_direction[ray]);
            at.place = &block->node(ref).children[steps_.child(direction, at.step, places_of(batch, ray))];
            ++at.step;
            __builtin_prefetch(at.place);
        }
    }
}

/// Descends to the final cell that holds a ray and makes missing cells on the way, or stops where too few rays cross.
FastTree::Found FastTree::find(Search& search, int ray, int deepest_crossed) {
    const LineBatch& batch = search.batch;
    Found found;
    found.key.direction = static_cast<uint8_t>(batch.line_direction[ray]);
    const uint8_t direction = found.key.direction;
    const LinePlaces places = places_of(batch, ray);
    CellBlock* block = search.reader.current();
    std::atomic<CellRef>* place = search.descents[ray].place;
    found.step = search.descents[ray].step;
    const auto goes_on = [&] {
        return found.step <= deepest_crossed ||
               (found.step <= steps_.deepest() && crossed_before(steps_.key(direction, found.step, places)));
    };
    for (; goes_on(); ++found.step) {
        CellRef ref = place ? place->load(std::memory_order_acquire) : 0;
        found.verdict = verdict_of(ref);
        if (found.verdict == CellVerdict::Unknown) {
            const CellKey key = steps_.key(direction, found.step, places);
            found.verdict = copy_older(search, key, found.step);
            if (found.verdict == CellVerdict::Unknown) found.verdict = make_cell(search, key, found.step);
            if (place) ref = store_cell(search, found.verdict, *place);
            if (ref == 0) place = nullptr;  // no room: from here on in memory of its own
        }
        if (found.verdict != CellVerdict::Halved) {
            found.key = steps_.key(direction, found.step, places);
            if (found.verdict == CellVerdict::Interpolated) found.leaf = place ? &block->leaf(ref) : &search.own_leaf;
            return found;
        }
        if (place) place = &block->node(ref).children[steps_.child(direction, found.step, places)];
    }
    found.verdict = CellVerdict::Unknown;
    return found;
}

/// Whether enough rays of earlier frames crossed a cell that too few of this frame's rays cross.
bool FastTree::crossed_before(const CellKey& key) const {
    return static_cast<double>(crossings_.before(key)) >= kEarlierShare * settings_.rays_per_cell;
}

/// Counts rays in the cells, down to step `last`, that too few of them cross. Cells with twice the count they need are
/// not counted further: they keep enough when all counts are halved.
void FastTree::count_crossings(const LineBatch& batch, RaySet set, const std::array<int, kBatchRays>& crossed,
                               int last) {
    const double enough = 2.0 * kEarlierShare * settings_.rays_per_cell;
    for (uint32_t rest = set; rest != 0; rest &= rest - 1) {
        const int ray = std::countr_zero(rest);
        const LinePlaces places = places_of(batch, ray);
        const auto direction = static_cast<uint8_t>(batch.line_direction[ray]);
        for (int step = crossed[ray] + 1; step <= std::min(last, steps_.deepest()); ++step) {
            const CellKey key = steps_.key(direction, step, places);
            if (crossings_.before(key) < enough) crossings_.add(key);
        }
    }
}

/// Samples a cell and judges it. Its leaf, if it has one, is the search's own. Any two samples of different classes
/// decide, so samples that are held already are looked at first, and after the first such pair none is traced.
CellVerdict FastTree::make_cell(Search& search, const CellKey& key, int step) {
    const CellDepths depths = steps_.depths(step);
    CellSamples samples;
    std::optional<SampleClass> seen;
    const auto differs = [&](int i) {
        if (!seen) seen = samples[i].sample_class;
        return samples[i].sample_class != *seen;
    };
    std::array<SampleTable::Key, kCellCorners + 1> keys;
    for (int i = 0; i <= kCellCorners; ++i) {
        keys[i] = SampleTable::key_of(steps_.sample_point(key, i));
        samples_.prefetch(keys[i]);
    }
    for (const SampleTable::Key& each : keys) samples_.prefetch_sample(each);
    uint32_t missing = 0;
    for (int i = 0; i <= kCellCorners; ++i) {
        if (!samples_.find(keys[i], samples[i]))
            missing |= 1u << i;
        else if (differs(i))
            return CellJudge::judge_mixed(depths);
    }
    for (const int i : kSampleOrder) {
        if ((missing >> i & 1) == 0) continue;
        samples[i] = sample(keys[i].point);
        ++search.samples_taken;
        samples_.put(keys[i], samples[i]);
        if (differs(i)) return CellJudge::judge_mixed(depths);
    }
    return judge_.judge(key, depths, samples, search.own_leaf);
}

/// The verdict that the older block has on a cell, its leaf copied to the search's own; or Unknown.
CellVerdict FastTree::copy_older(Search& search, const CellKey& key, int step) const {
    CellBlock* older = search.reader.older();
    if (!older) return CellVerdict::Unknown;
    const LinePlaces places = steps_.first_places(key);
    CellRef ref = older->root(key.direction).load(std::memory_order_acquire);
    for (int i = 0; i < step; ++i) {
        if (verdict_of(ref) != CellVerdict::Halved) return CellVerdict::Unknown;
        ref = older->node(ref).children[steps_.child(key.direction, i, places)].load(std::memory_order_acquire);
    }
    if (verdict_of(ref) == CellVerdict::Interpolated) {
        const CellLeaf& leaf = older->leaf(ref);
        std::memcpy(static_cast<void*>(&search.own_leaf), &leaf, leaf.stored_bytes());
    }
    return verdict_of(ref);
}

/// Publishes a cell at its place, with the search's own leaf; 0 if there is no room.
CellRef FastTree::store_cell(Search& search, CellVerdict verdict, std::atomic<CellRef>& place) {
    CellBlock& block = *search.reader.current();
    std::optional<CellRef> made = static_cast<CellRef>(verdict);
    if (verdict == CellVerdict::Halved) made = block.add_node();
    if (verdict == CellVerdict::Interpolated) made = block.add_leaf(search.own_leaf);
    if (!made) {
        search.reader.found_no_room();
        return 0;
    }
    CellRef before = 0;
    // If another thread has made the same cell meanwhile, its cell is used, and this space is lost until the exchange.
    if (place.compare_exchange_strong(before, *made, std::memory_order_acq_rel)) return *made;
    return before;
}

std::optional<CellKey> FastTree::final_cell(const Ray& object_ray) {
    Search search(store_, Uninterpolated::Leave);
    functions_.prepare(&object_ray, 1, frame_, search.batch);
    if (space_.box().isEmpty() || search.batch.in_box == 0) return std::nullopt;
    begin_descents(search, 1);
    return find(search, 0, steps_.deepest()).key;
}

}  // namespace rayleaf
