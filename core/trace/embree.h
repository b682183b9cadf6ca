// The only header that includes Embree, and the one place that knows how Embree 3.13 and 4 differ.
#pragma once

#include "base/cancel.h"
#include "rays/packet.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <cstddef>
#include <cstdint>
#include <utility>

namespace rayleaf {

#if RTC_VERSION_MAJOR >= 4
using EmbreeContext = RTCRayQueryContext;

inline void initialize(EmbreeContext& context) {
    rtcInitRayQueryContext(&context);
}
inline void embree_closest(RTCScene scene, EmbreeContext& context, RTCRayHit& ray) {
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.context = &context;
    rtcIntersect1(scene, &ray, &arguments);
}
inline void embree_closest16(const int* valid, RTCScene scene, EmbreeContext& context, Coherence coherence,
                             RTCRayHit16& rays) {
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.flags = coherence == Coherence::Coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
    arguments.context = &context;
    rtcIntersect16(valid, scene, &rays, &arguments);
}
inline void embree_any16(const int* valid, RTCScene scene, EmbreeContext& context, Coherence coherence,
                         RTCRay16& rays) {
    RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.flags = coherence == Coherence::Coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
    arguments.context = &context;
    rtcOccluded16(valid, scene, &rays, &arguments);
}
inline void embree_any(RTCScene scene, EmbreeContext& context, RTCRay& ray) {
    RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.context = &context;
    rtcOccluded1(scene, &ray, &arguments);
}
#else
using EmbreeContext = RTCIntersectContext;

inline void initialize(EmbreeContext& context) {
    rtcInitIntersectContext(&context);
}
inline void embree_closest(RTCScene scene, EmbreeContext& context, RTCRayHit& ray) {
    rtcIntersect1(scene, &context, &ray);
}
/// `valid`: -1 for rays that are asked, 0 for others.
inline void embree_closest16(const int* valid, RTCScene scene, EmbreeContext& context, Coherence coherence,
                             RTCRayHit16& rays) {
    context.flags =
        coherence == Coherence::Coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    rtcIntersect16(valid, scene, &context, &rays);
}
inline void embree_any16(const int* valid, RTCScene scene, EmbreeContext& context, Coherence coherence,
                         RTCRay16& rays) {
    context.flags =
        coherence == Coherence::Coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    rtcOccluded16(valid, scene, &context, &rays);
}
inline void embree_any(RTCScene scene, EmbreeContext& context, RTCRay& ray) {
    rtcOccluded1(scene, &context, &ray);
}
#endif

/// What Embree calls the id of a ray: of a packet's its lane, as callbacks need not meet it at that place, nor in
/// company. Where the processor has no vectors of sixteen floats, Embree hands packets on in parts, or ray by ray.
inline constexpr uint32_t kRayAlone = ~0u;        ///< the id of rays in no packet
inline constexpr uint32_t kRayPassing = ~0u - 1;  ///< of one in no packet that looks for all hits
/// Whether a callback was called for a ray alone, and not for some of a packet.
inline bool is_alone(RTCRayN* rays, unsigned count) {
    return count == 1 && RTCRayN_id(rays, 1, 0) == kRayAlone;
}

/// Releases the scene when it goes.
class EmbreeScene {
  public:
    EmbreeScene() = default;
    explicit EmbreeScene(RTCScene scene) : scene_(scene) {}
    ~EmbreeScene() {
        if (scene_) rtcReleaseScene(scene_);
    }
    EmbreeScene(const EmbreeScene&) = delete;
    EmbreeScene& operator=(const EmbreeScene&) = delete;
    EmbreeScene(EmbreeScene&& other) noexcept : scene_(other.scene_) { other.scene_ = nullptr; }
    EmbreeScene& operator=(EmbreeScene&& other) noexcept {
        std::swap(scene_, other.scene_);
        return *this;
    }
    RTCScene get() const { return scene_; }
    explicit operator bool() const { return scene_ != nullptr; }

  private:
    RTCScene scene_ = nullptr;
};

/// The device all tracers of the process share; it lives as long as the process.
RTCDevice embree_device();
/// A new scene of best quality with the robust flag. Its build looks at the token, which must live until then.
EmbreeScene new_embree_scene(const CancelToken& cancel = kNeverCancelled);
/// What a user geometry answers; null: rays of that kind are not asked.
struct UserGeometryCallbacks {
    RTCBoundsFunction bounds;
    RTCIntersectFunctionN closest;
    RTCOccludedFunctionN any;
};
/// A geometry of `count` primitives whose callbacks get `owner` as geometryUserPtr.
RTCGeometry new_user_geometry(void* owner, size_t count, const UserGeometryCallbacks& callbacks);
/// A new buffer of a geometry. Where there is no memory for it, releases the geometry and throws std::bad_alloc.
void* new_embree_buffer(RTCGeometry geometry, RTCBufferType type, RTCFormat format, size_t item_bytes, size_t count,
                        unsigned slot = 0);
template <typename T>
T* new_embree_buffer(RTCGeometry geometry, RTCBufferType type, RTCFormat format, size_t count, unsigned slot = 0) {
    return static_cast<T*>(new_embree_buffer(geometry, type, format, sizeof(T), count, slot));
}
/// Adds a geometry, which it takes over, to a scene as number 0 and builds it. Throws Cancelled if the scene's token
/// says so, std::runtime_error with Embree's word if the build fails.
void build_embree_scene(const EmbreeScene& scene, RTCGeometry geometry);
/// After a build: throws Cancelled if it was, std::runtime_error with Embree's word if it failed.
void throw_embree_error();
/// What Embree holds now for all scenes of the process.
uint64_t embree_bytes();

}  // namespace rayleaf
