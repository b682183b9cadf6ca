// The fast tree's cells: found, made where they are missing, and held.
#include "ri_tree/fast_tree.h"
#include "ri_tree/fast_tree_search.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace rayleaf {
namespace {

static_assert(1 << kStepDepths == kNodeChildren);

/// The centre, then pairs of opposite corners: what is likely to differ comes early.
constexpr std::array<int, kCellCorners + 1> kSampleOrder = {
    kCenterSample, 0, 15, 3, 12, 5, 10, 6, 9, 1, 14, 2, 13, 4, 11, 7, 8};

/// A cell is bought once the rays that crossed it in earlier frames are this share of those that one frame must have:
/// what was crossed before will be again. With 1 as much is paid until all is bought, and it takes twice as many
/// frames; with 1/4 the mean of twelve frames of glass that stays is slower, by 12 to 18 %.
constexpr double kPriceShare = 0.5;

}  // namespace

void FastTree::begin_descents(Search& search, RaySet set) const {
    CellBlock* block = search.reader.current();
    for (uint32_t rest = set; rest != 0; rest &= rest - 1) {
        const int ray = std::countr_zero(rest);
        const auto direction = static_cast<uint8_t>(search.batch.line_direction[ray]);
        search.descents[ray] = {0, block ? &block->root(direction) : nullptr};
    }
}

/// Rays that share few cells wait for memory together: all go one step down, then all the next. Nothing is made.
void FastTree::descend_together(Search& search, RaySet set, const std::array<int, kBatchRays>& worth) const {
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
            if (verdict != CellVerdict::Halved || at.step >= worth[ray]) {
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

/// Goes down to the final cell that holds a ray, and makes what is missing on the way; or to where it is not worth it.
FastTree::Found FastTree::find(Search& search, int ray, int deepest_worth) {
    const LineBatch& batch = search.batch;
    Found found;
    found.key.direction = static_cast<uint8_t>(batch.line_direction[ray]);
    const uint8_t direction = found.key.direction;
    const LinePlaces places = places_of(batch, ray);
    CellBlock* block = search.reader.current();
    std::atomic<CellRef>* place = search.descents[ray].place;
    found.step = search.descents[ray].step;
    const auto goes_on = [&] {
        return found.step <= deepest_worth ||
               (found.step <= steps_.deepest() && paid_before(steps_.key(direction, found.step, places)));
    };
    for (; goes_on(); ++found.step) {
        CellRef ref = place ? place->load(std::memory_order_acquire) : 0;
        found.verdict = verdict_of(ref);
        if (found.verdict == CellVerdict::Unknown) {
            const CellKey key = steps_.key(direction, found.step, places);
            found.verdict = copy_older(search, key, found.step);
            if (found.verdict == CellVerdict::Unknown) found.verdict = make_cell(search, key, found.step);
            if (place) ref = store_cell(search, found.verdict, *place);
            if (ref == 0) place = nullptr;  // no room: from here on by itself
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

/// Whether a cell that the frame's rays do not pay for is paid for by those of earlier frames.
bool FastTree::paid_before(const CellKey& key) const {
    return static_cast<double>(crossings_.before(key)) >= kPriceShare * settings_.rays_per_cell;
}

/// Counts rays in the cells down to step `last` that they do not pay for. Of cells that were paid for twice none more:
/// they stay so when all counts are halved.
void FastTree::count_crossings(const LineBatch& batch, RaySet set, const std::array<int, kBatchRays>& worth, int last) {
    const double enough = 2.0 * kPriceShare * settings_.rays_per_cell;
    for (uint32_t rest = set; rest != 0; rest &= rest - 1) {
        const int ray = std::countr_zero(rest);
        const LinePlaces places = places_of(batch, ray);
        const auto direction = static_cast<uint8_t>(batch.line_direction[ray]);
        for (int step = worth[ray] + 1; step <= std::min(last, steps_.deepest()); ++step) {
            const CellKey key = steps_.key(direction, step, places);
            if (crossings_.before(key) < enough) crossings_.add(key);
        }
    }
}

/// Samples a cell and judges it. Its leaf, if it has one, is the search's own. Two samples of different classes decide,
/// whichever they are: those that are held already are looked at first, and after the first such pair none is traced.
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

/// What the block that was current before says of a cell, its leaf as the search's own; or Unknown.
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

/// Publishes a cell, its leaf being the search's own, at its place; 0 if there is no room.
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
    // Another thread may have made the same meanwhile; then its cell counts, and the space is lost until the exchange.
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
