// What one camera path contributes to a pixel: one value per pass, written by an integrator, averaged by the film.
#pragma once

#include "base/vector.h"
#include "film/mattes.h"
#include "film/pass.h"

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

namespace rayleaf {

/// What a sample holds beside the passes of the table, where anybody asks.
struct SampleExtras {
    std::vector<Vec4f> slots;
    std::vector<MatteRecord> mattes;

    void clear(size_t slot_count) {
        slots.assign(slot_count, Vec4f(0.0f));
        mattes.clear();
    }
};

/// Values of the passes for one sample. xyzw are the channels in order. Those of passes that are off are nowhere: they
/// read as 0, whatever is written.
class PixelSample {
  public:
    SampleExtras* extras = nullptr;  ///< null if no slot and no matte is enabled

    /// Zeros. `passes`: those that are on, a bit for each pass of the table.
    explicit PixelSample(uint64_t passes) : passes_(passes) { clear(); }

    void clear() {
        extras = nullptr;
        for (uint64_t rest = passes_; rest != 0; rest &= rest - 1)
            values_[static_cast<size_t>(std::countr_zero(rest))] = Vec4f(0.0f);
    }
    bool has(Pass pass) const { return (passes_ >> static_cast<uint32_t>(pass) & 1u) != 0; }

    Vec4f& operator[](Pass pass) {
        if (has(pass)) return values_[static_cast<size_t>(pass)];
        nowhere_ = Vec4f(0.0f);
        return nowhere_;
    }
    const Vec4f& operator[](Pass pass) const {
        if (is_slot(pass)) return extras->slots[slot_of(pass)];
        return has(pass) ? values_[static_cast<size_t>(pass)] : kNothing;
    }
    void add(Pass pass, const Color& color) {
        Vec4f& value = (*this)[pass];
        value += Vec4f(color.x, color.y, color.z, 0.0f);
    }
    /// Adds light to the slot of its group; -1, no slot, is ignored.
    void add_to_slot(int slot, const Color& color) {
        if (!extras || slot < 0 || static_cast<size_t>(slot) >= extras->slots.size()) return;
        extras->slots[static_cast<size_t>(slot)] += Vec4f(color.x, color.y, color.z, 0.0f);
    }

  private:
    static inline const Vec4f kNothing{0, 0, 0, 0};
    uint64_t passes_;
    Vec4f nowhere_;
    std::array<Vec4f, kPassCount> values_;  ///< those of passes that are off are never touched
};

}  // namespace rayleaf
