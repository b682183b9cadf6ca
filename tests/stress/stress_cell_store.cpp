// The store of cells while threads go down it, add what is missing and exchange its blocks: a cell is what its place
// says, for as long as it is read.
#include "ri_tree/cell_store.h"
#include "stress.h"

using namespace rayleaf;

namespace {

constexpr int kDepth = 4, kBelow = 3;  ///< steps, and children in use of a node

/// A leaf that knows the way to it.
CellLeaf leaf_at(uint32_t way) {
    CellLeaf leaf{};
    leaf.sample_class.first_hit = way;
    leaf.terms = kLinearTerms;
    leaf.values = static_cast<uint8_t>(1 + way % 3);
    leaf.coefficients.fill(static_cast<float>(way));
    return leaf;
}

void check(const CellLeaf& leaf, uint32_t way) {
    stress::require(leaf.sample_class.first_hit == way, "another cell's leaf");
    const size_t count = size_t{leaf.terms} * leaf.values + kLeafPadding;
    for (size_t i = 0; i < count; ++i)
        stress::require(leaf.coefficients[i] == static_cast<float>(way), "a leaf that was overwritten");
}

/// Leaves end the way early, where its number says so.
bool is_leaf(uint32_t way, int step) {
    return step == kDepth || (step > 1 && way % 7 == 0);
}

struct Walk {
    CellStore::Reader& reader;
    uint32_t leaves_in_older = 0;

    /// What the older block has at a place; counts leaves of it.
    void look_back(uint8_t direction, const std::vector<uint32_t>& turns) {
        CellBlock* older = reader.older();
        if (!older) return;
        CellRef ref = older->root(direction).load(std::memory_order_acquire);
        uint32_t way = direction;
        for (const uint32_t turn : turns) {
            if (verdict_of(ref) != CellVerdict::Halved) break;
            ref = older->node(ref).children[turn].load(std::memory_order_acquire);
            way = way * kBelow + turn + 1;
        }
        if (verdict_of(ref) != CellVerdict::Interpolated) return;
        check(older->leaf(ref), way);
        ++leaves_in_older;
    }

    void go(uint8_t direction, std::mt19937& random) {
        CellBlock& block = *reader.current();
        std::atomic<CellRef>* place = &block.root(direction);
        std::vector<uint32_t> turns;
        uint32_t way = direction;
        for (int step = 0;; ++step) {
            CellRef ref = place->load(std::memory_order_acquire);
            if (verdict_of(ref) == CellVerdict::Unknown) {
                look_back(direction, turns);
                const std::optional<CellRef> made =
                    is_leaf(way, step) ? block.add_leaf(leaf_at(way)) : block.add_node();
                if (!made) return reader.found_no_room();
                ref = 0;
                if (place->compare_exchange_strong(ref, *made, std::memory_order_acq_rel)) ref = *made;
            }
            if (verdict_of(ref) == CellVerdict::Interpolated) return check(block.leaf(ref), way);
            stress::require(verdict_of(ref) == CellVerdict::Halved, "a verdict that nobody gave");
            const uint32_t turn = random() % kBelow;
            place = &block.node(ref).children[turn];
            turns.push_back(turn);
            way = way * kBelow + turn + 1;
        }
    }
};

void use(CellStore& store, int thread) {
    std::mt19937 random(static_cast<uint32_t>(thread));
    for (int i = 0; i < 150; ++i) {
        CellStore::Reader reader(store);
        Walk walk{reader};
        for (int k = 0; k < 8; ++k) walk.go(static_cast<uint8_t>(random() % kLineDirections), random);
        const CellStore::Reader within(store);
        if (within.older()) walk.go(0, random);
        reader.counts().samples_taken.fetch_add(1, std::memory_order_relaxed);
        stress::require(store.nodes() + store.leaves() < 1'000'000 && store.samples_taken() > 0, "counts");
    }
}

}  // namespace

int main() {
    const stress::NoOtherThreads alone;
    uint64_t exchanges = 0;
    for (const int threads : {2, 5, 16, 64, 150})
        for (const uint64_t bytes :
             {uint64_t{0}, uint64_t{512}, uint64_t{8192}, uint64_t{40'000}, uint64_t{1'000'000}}) {
            CellStore store(bytes);
            stress::run_together(threads, [&](int thread) { use(store, thread); });
            stress::require(store.samples_taken() == 150u * static_cast<unsigned>(threads), "counts of some thread");
            stress::require(store.bytes() <= bytes, "more memory than allowed");
            exchanges += store.exchanges();
        }
    stress::require(exchanges > 100, "blocks were hardly ever exchanged");
}
