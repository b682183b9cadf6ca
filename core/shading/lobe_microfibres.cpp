#include "shading/lobe_microfibres.h"

#include "shading/lobe_frame.h"

namespace rayleaf {

LobeValue evaluate_microfibres(const Lobe& lobe, const Vec3f& incoming, Side side) {
    const Vec3f i = LobeFrame(lobe).to_local(incoming);
    if (side == Side::Transmitted || !(i.z > 0.0f)) return {};
    const float narrowing = lobe.alpha_x, skew = lobe.alpha_y;
    const Vec3f cosine_lobe(narrowing * i.x + skew * i.z, narrowing * i.y, i.z);
    const float change = narrowing / cosine_lobe.length2();
    const float density = i.z / kPi * change * change;
    return {lobe.weight * density, density};
}

LobeDirection sample_microfibres(const Lobe& lobe, const Vec3f& random) {
    const float narrowing = lobe.alpha_x, skew = lobe.alpha_y;
    const Vec3f d = cosine_hemisphere(random.x, random.y);
    const Vec3f local = normalized_or(Vec3f(d.x - d.z * skew, d.y, d.z * narrowing), Vec3f(0.0f, 0.0f, 1.0f));
    return {LobeFrame(lobe).to_world(local)};
}

}  // namespace rayleaf
