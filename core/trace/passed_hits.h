// All that a ray meets on its way, where what it meets may let it through: surfaces with transparency in front of a
// light. One walk through the trees finds them, in any order; a walk for each surface would begin anew behind it.
#pragma once

#include "geometry/facet.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace rayleaf {

/// What rays may find where they meet an instance.
enum class LightPassage : uint8_t {
    Closed,   ///< nothing gets through
    Surface,  ///< surfaces that may let light through
    Unknown,  ///< something else, like the border of a medium
};

struct PassedHit {
    uint32_t instance = 0;
    uint32_t primitive = 0, part = 0;  ///< FacetId's
    FacetHit point;
};

/// What one ray has met. What comes of a whole walk does not depend on its order.
class PassedHits {
  public:
    /// More are not kept.
    static constexpr size_t kMost = 8;

    PassedHits() {}
    /// Forgets everything; more than `allowed` surfaces let nothing through.
    void start(int allowed) {
        count_ = 0;
        allowed_ = static_cast<size_t>(std::max(allowed, 0));
        is_closed_ = is_unknown_ = false;
    }
    /// True if the ray need not go on.
    bool add(const PassedHit& hit) {
        PassedHit* const end = hits_.data() + count_;
        PassedHit* const at = std::lower_bound(hits_.data(), end, hit, comes_before);
        if (at != end && !comes_before(hit, *at)) return false;  // a tree may offer a facet twice
        if (count_ == allowed_) return close();
        if (count_ == kMost) {
            is_unknown_ = true;
            return false;
        }
        std::copy_backward(at, end, end + 1);
        *at = hit;
        ++count_;
        return false;
    }
    bool close() { return is_closed_ = true; }
    void set_unknown() { is_unknown_ = true; }

    /// Nothing gets through.
    bool is_closed() const { return is_closed_; }
    /// There is more on the way than what was kept: it must be followed step by step.
    bool is_unknown() const { return is_unknown_ && !is_closed_; }
    /// Of a ray that is neither: all that it meets, the nearest first.
    std::span<const PassedHit> hits() const { return {hits_.data(), count_}; }

  private:
    union {
        std::array<PassedHit, kMost> hits_;  ///< not set before they are needed
    };
    size_t count_ = 0, allowed_ = 0;
    bool is_closed_ = false, is_unknown_ = false;

    static bool comes_before(const PassedHit& a, const PassedHit& b) {
        if (a.point.t != b.point.t) return a.point.t < b.point.t;
        if (a.instance != b.instance) return a.instance < b.instance;
        return a.primitive != b.primitive ? a.primitive < b.primitive : a.part < b.part;
    }
};

}  // namespace rayleaf
