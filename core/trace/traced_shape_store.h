// Shapes as they are traced, kept from one tracer to the next: an edit, or another frame, builds anew what has changed.
//
// A traced shape depends on its content and, where it is diced, on how finely each part of it is wanted. Shapes that go
// through the geometry cache are not kept: their subpatches have numbers in one tracer.
#pragma once

#include "base/content_hash.h"
#include "base/kept_by_key.h"
#include "trace/instance_table.h"
#include "trace/shape_scene.h"

#include <compare>
#include <cstdint>
#include <memory>

namespace rayleaf {

struct TracedShapeKey {
    ContentHash shape{};
    ContentHash tolerance{};  ///< of shapes that are diced

    auto operator<=>(const TracedShapeKey&) const = default;  // NOLINT(modernize-use-nullptr): it has no pointers
};

struct KeptShape {
    std::shared_ptr<ShapeScene> scene;  ///< owns the shape that it is of
    uint64_t resident_bytes = 0;        ///< as of the plan
};

/// The key of a shape: of its content, or, where that has no hash, of the very object, which is then kept.
TracedShapeKey key_of(const Shape& shape, const ContentHash& tolerance);

/// Users are tracers.
class TracedShapeStore final : public KeptByKey<TracedShapeKey, KeptShape> {
  public:
    Spares<InstanceTable> tables;  ///< of tracers that are gone
};

}  // namespace rayleaf
