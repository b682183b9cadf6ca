// Plain IEEE arithmetic for the time of a query or a render: the host may have set its threads to flush denormal
// numbers to zero, and a picture must not depend on that.
#pragma once

#if defined(__SSE__)
#include <immintrin.h>
#endif

namespace rayleaf {

class FloatEnvironment {
  public:
#if defined(__SSE__)
    FloatEnvironment() : host_(_mm_getcsr()) {
        if ((host_ & kControlBits) != kPlain) _mm_setcsr(kPlain);
    }
    ~FloatEnvironment() {
        if ((host_ & kControlBits) != kPlain) _mm_setcsr(host_);
    }
#else
    FloatEnvironment() = default;
#endif
    FloatEnvironment(const FloatEnvironment&) = delete;
    FloatEnvironment& operator=(const FloatEnvironment&) = delete;

  private:
#if defined(__SSE__)
    static constexpr unsigned kControlBits = 0xffc0u;  ///< all but the six sticky exception flags
    static constexpr unsigned kPlain = 0x1f80u;        ///< exceptions masked, round to nearest, denormals kept
    unsigned host_;
#endif
};

}  // namespace rayleaf
