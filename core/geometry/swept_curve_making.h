// A bevelled curve whose surface can be made in the background, while more of the scene is described.
#pragma once

#include "geometry/swept_curve.h"

#include <memory>

namespace rayleaf {

class SweptSurface;

class SweptCurve {
  public:
    explicit SweptCurve(SweptCurveDescription description);
    /// Does not wait: what has not begun is not made, what has ends by itself.
    ~SweptCurve();
    SweptCurve(const SweptCurve&) = delete;
    SweptCurve& operator=(const SweptCurve&) = delete;

    const SweptCurveDescription& description() const;
    /// Has another thread make the surface.
    void begin();
    /// Whether borders of an area cross each other or themselves: then the filled area is undefined. Throws as making
    /// the surface does.
    bool borders_cross() const;
    /// The surface: the one from the background for whoever asks first, then new ones. Throws InputError if the
    /// description is invalid.
    std::shared_ptr<SweptSurface> surface() const;

  private:
    struct Making;
    std::shared_ptr<Making> making_;
};

}  // namespace rayleaf
