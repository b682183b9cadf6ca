#include "tessellation/readers.h"

#include <bitset>
#include <mutex>

namespace rayleaf {
namespace {

struct Numbers {
    std::mutex mutex;
    std::bitset<kMostReaders> taken;
};

Numbers& numbers() {
    static auto* const all = new Numbers;  // threads may end after static objects do
    return *all;
}

/// A thread's number, from its first ray to its end.
struct Claim {
    int number = -1;

    Claim() {
        Numbers& all = numbers();
        const std::lock_guard lock(all.mutex);
        for (int i = 0; i < kMostReaders && number < 0; ++i)
            if (!all.taken[i]) number = i;
        if (number >= 0) all.taken[number] = true;
    }
    ~Claim() {
        if (number < 0) return;
        Numbers& all = numbers();
        const std::lock_guard lock(all.mutex);
        all.taken[number] = false;
    }
    Claim(const Claim&) = delete;
    Claim& operator=(const Claim&) = delete;
};

}  // namespace

int reader_number() {
    thread_local const Claim claim;
    return claim.number;
}

uint64_t ReaderEpochs::oldest() const {
    uint64_t oldest = current_.load(std::memory_order_seq_cst);
    for (const Announced& each : announced_) {
        const uint64_t epoch = each.epoch.load(std::memory_order_seq_cst);
        if (epoch != kNobody && epoch < oldest) oldest = epoch;
    }
    return oldest;
}

}  // namespace rayleaf
