#include "trace/traced_shape_store.h"

namespace rayleaf {
TracedShapeKey key_of(const Shape& shape, const ContentHash& tolerance) {
    if (const std::optional<ContentHash> content = shape.content_hash()) return {*content, tolerance};
    ContentHasher hasher;
    hasher.add(static_cast<uint64_t>(reinterpret_cast<uintptr_t>(&shape)));
    return {hasher.value(), tolerance};
}

}  // namespace rayleaf
