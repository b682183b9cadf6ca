#include "trace/embree.h"

#include <atomic>
#include <cstdlib>
#include <limits>
#include <new>
#include <stdexcept>
#include <string>

#include <oneapi/tbb/task_arena.h>

namespace rayleaf {
namespace {

std::atomic<int64_t> bytes_held{0};

bool count_bytes(void*, ssize_t bytes, bool /*after_the_fact*/) {
    bytes_held.fetch_add(bytes, std::memory_order_relaxed);
    return true;
}

RTCDevice make_device() {
    // Tests ask for the kernels of other processors, like isa=avx2.
    RTCDevice device = rtcNewDevice(std::getenv("RAYLEAF_EMBREE"));
    if (!device) throw std::runtime_error("Embree cannot start on this machine");
    rtcSetDeviceMemoryMonitorFunction(device, count_bytes, nullptr);
    return device;
}

const char* error_text(RTCError error) {
    switch (error) {
        case RTC_ERROR_OUT_OF_MEMORY:
            return "out of memory";
        case RTC_ERROR_UNSUPPORTED_CPU:
            return "unsupported processor";
        case RTC_ERROR_CANCELLED:
            return "cancelled";
        case RTC_ERROR_INVALID_ARGUMENT:
        case RTC_ERROR_INVALID_OPERATION:
            return "invalid use";
        default:
            return "unknown error";
    }
}

/// Embree's question during a build whether to go on. `token` is a const CancelToken.
bool embree_goes_on(void* token, double /*share*/) {
    return !static_cast<const CancelToken*>(token)->cancelled();
}

}  // namespace

void throw_embree_error() {
    const RTCError error = rtcGetDeviceError(embree_device());
    if (error == RTC_ERROR_CANCELLED) throw Cancelled();
    if (error != RTC_ERROR_NONE) throw std::runtime_error(std::string("Embree: ") + error_text(error));
}

RTCDevice embree_device() {
    static RTCDevice device = make_device();
    return device;
}

EmbreeScene new_embree_scene(const CancelToken& cancel) {
    EmbreeScene scene(rtcNewScene(embree_device()));
    rtcSetSceneBuildQuality(scene.get(), RTC_BUILD_QUALITY_HIGH);
    rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
    if (&cancel != &kNeverCancelled)
        rtcSetSceneProgressMonitorFunction(scene.get(), embree_goes_on, const_cast<CancelToken*>(&cancel));
    return scene;
}

RTCGeometry new_user_geometry(void* owner, size_t count, const UserGeometryCallbacks& callbacks) {
    RTCGeometry geometry = rtcNewGeometry(embree_device(), RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(count));
    rtcSetGeometryUserData(geometry, owner);
    rtcSetGeometryBoundsFunction(geometry, callbacks.bounds, nullptr);
    rtcSetGeometryIntersectFunction(geometry, callbacks.closest);
    rtcSetGeometryOccludedFunction(geometry, callbacks.any);
    return geometry;
}

void* new_embree_buffer(RTCGeometry geometry, RTCBufferType type, RTCFormat format, size_t item_bytes, size_t count,
                        unsigned slot) {
    // Embree gives neither more items than 32 bits count, nor memory that the system has not.
    const bool countable = count <= std::numeric_limits<uint32_t>::max();
    void* const buffer = countable ? rtcSetNewGeometryBuffer(geometry, type, slot, format, item_bytes, count) : nullptr;
    if (buffer || (countable && count == 0)) return buffer;
    rtcReleaseGeometry(geometry);
    rtcGetDeviceError(embree_device());  // this error is reported; a later build must not report it again
    throw std::bad_alloc();
}

void build_embree_scene(const EmbreeScene& scene, RTCGeometry geometry) {
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene.get(), geometry, 0);
    rtcReleaseGeometry(geometry);
    // Embree keeps a task group in each scene, and oneTBB makes it a child of the group of the task that builds first.
    // That group ends before the scene does, and a later cancellation would follow the pointer to it. What an arena
    // executes is no task's child.
    oneapi::tbb::task_arena(oneapi::tbb::task_arena::attach()).execute([&] { rtcCommitScene(scene.get()); });
    throw_embree_error();
}

uint64_t embree_bytes() {
    return static_cast<uint64_t>(std::max<int64_t>(0, bytes_held.load(std::memory_order_relaxed)));
}

}  // namespace rayleaf
