// The table of samples while threads make its memory, fill it, let it grow and forget: what is found is what was put,
// and the limit holds at every moment.
#include "ri_tree/sample_table.h"
#include "stress.h"

using namespace rayleaf;

namespace {

constexpr uint32_t kPoints = 3000;

LatticePoint point_of(uint32_t number) {
    return {static_cast<uint8_t>(number % kLineDirections), {number, number * 3, 7, number * number}};
}

FastSample sample_of(uint32_t number) {
    FastSample sample;
    sample.sample_class.first_hit = number % 5;  // some are misses
    const auto value = static_cast<float>(number);
    sample.values.fill(value);
    for (auto& changes : sample.changes) changes.fill(-value);
    return sample;
}

void check(uint32_t number, const FastSample& found, OutputKind kind) {
    const FastSample wanted = sample_of(number);
    stress::require(found.sample_class == wanted.sample_class, "the class of another sample");
    if (wanted.sample_class.is_miss()) return;
    for (int i = 0; i < sample_value_count(kind); ++i) {
        stress::require(found.values[i] == wanted.values[i], "a value of another sample");
        stress::require(found.changes[i] == wanted.changes[i], "changes of another sample");
    }
}

void use(SampleTable& table, OutputKind kind, uint64_t most_bytes, int thread, int times) {
    std::mt19937 random(static_cast<uint32_t>(thread));
    for (int i = 0; i < times; ++i) {
        const uint32_t number = random() % kPoints;
        const SampleTable::Key key = SampleTable::key_of(point_of(number));
        FastSample found;
        table.prefetch(key);
        table.prefetch_sample(key);
        if (table.find(key, found))
            check(number, found, kind);
        else
            table.put(key, sample_of(number));
        stress::require(table.bytes() <= most_bytes, "more memory than allowed");
    }
}

void try_size(uint64_t most_bytes, int threads, int times) {
    for (const OutputKind kind : {OutputKind::Mirror, OutputKind::Glass}) {
        SampleTable table(kind, SampleContents::ValuesAndChanges, most_bytes);
        stress::run_together(threads, [&](int thread) { use(table, kind, most_bytes, thread, times); });
        stress::require(table.count() <= uint64_t{kPoints} * static_cast<uint64_t>(threads), "more than were put");
    }
}

}  // namespace

int main() {
    const stress::NoOtherThreads alone;
    constexpr uint64_t kTable = 8192, kChunks[] = {0, 1, 9, 20, 30, 40, 64, 90, 150};
    for (const int threads : stress::kThreadCounts) {
        // One chunk or few: they are made at once, by all.
        for (const uint64_t kilobytes : kChunks)
            for (int again = 0; again < 6; ++again) try_size(kTable + kilobytes * 1000, threads, 120);
        for (const uint64_t most_bytes : {uint64_t{0}, uint64_t{300'000}, uint64_t{4'000'000}})
            try_size(most_bytes, threads, 3000);
    }
}
