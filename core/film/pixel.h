// What one camera path contributes to a pixel: one value per pass, written by an integrator, averaged by the film.
#pragma once

#include "base/vector.h"
#include "film/mattes.h"
#include "film/pass.h"

#include <array>
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

/// Values of all passes for one sample; passes that are off are simply not read. xyzw are the channels in order.
struct PixelSample {
    std::array<Vec4f, kPassCount> values;
    SampleExtras* extras = nullptr;  ///< null if no slot and no matte is enabled

    PixelSample() { values.fill(Vec4f(0.0f)); }

    Vec4f& operator[](Pass pass) { return values[static_cast<size_t>(pass)]; }
    const Vec4f& operator[](Pass pass) const {
        return is_slot(pass) ? extras->slots[slot_of(pass)] : values[static_cast<size_t>(pass)];
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
};

}  // namespace rayleaf
