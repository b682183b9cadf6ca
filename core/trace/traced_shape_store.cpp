#include "trace/traced_shape_store.h"

namespace rayleaf {
namespace {

/// Tracers that may be built meanwhile without a shape before it is dropped: an undo finds what the edit replaced.
constexpr uint64_t kTracersKept = 2;

}  // namespace

TracedShapeKey key_of(const Shape& shape, const ContentHash& tolerance) {
    if (const std::optional<ContentHash> content = shape.content_hash()) return {*content, tolerance};
    ContentHasher hasher;
    hasher.add(static_cast<uint64_t>(reinterpret_cast<uintptr_t>(&shape)));
    return {hasher.value(), tolerance};
}

void TracedShapeStore::next_tracer() {
    const std::scoped_lock lock(mutex_);
    std::erase_if(entries_, [&](const auto& entry) { return entry.second.asked + kTracersKept <= tracers_; });
    ++tracers_;
}

KeptShape TracedShapeStore::find(const TracedShapeKey& key) {
    const std::scoped_lock lock(mutex_);
    const auto found = entries_.find(key);
    if (found == entries_.end()) return {};
    found->second.asked = tracers_;
    return found->second.kept;
}

void TracedShapeStore::keep(const TracedShapeKey& key, KeptShape kept) {
    const std::scoped_lock lock(mutex_);
    entries_[key] = {std::move(kept), tracers_};
}

size_t TracedShapeStore::count() const {
    const std::scoped_lock lock(mutex_);
    return entries_.size();
}

}  // namespace rayleaf
