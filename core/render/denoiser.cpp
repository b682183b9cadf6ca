#include "render/denoiser.h"

#include "base/error.h"

#include <array>
#include <optional>

#include <dlfcn.h>

namespace rayleaf {
namespace {

constexpr const char* kDenoiser = "denoiser";
constexpr const char* kLibraryWanted =
    "Open Image Denoise 1 or 2: libOpenImageDenoise.so.2 of a Blender from blender.org (4.0 and later), or of "
    "github.com/RenderKit/oidn, where the system looks for libraries";
// Of the library's interface, the same in versions 1 and 2.
constexpr int kCpuDevice = 1, kThreeFloats = 3, kNoError = 0, kCancelledError = 6;
constexpr std::array<const char*, 3> kSystemNames = {"libOpenImageDenoise.so.2", "libOpenImageDenoise.so.1",
                                                     "libOpenImageDenoise.so"};

/// One that the process has loaded, wherever from; null if it has none.
void* loaded_library() {
    if (dlsym(RTLD_DEFAULT, "oidnNewDevice") != nullptr) return dlopen(nullptr, RTLD_NOW);
    for (const char* name : kSystemNames)
        if (void* handle = dlopen(name, RTLD_NOW | RTLD_NOLOAD)) return handle;
    return nullptr;
}

void* opened_library(const std::vector<std::string>& paths) {
    if (void* handle = loaded_library()) return handle;
    std::string tried;
    const auto open = [&tried](const char* path) {
        void* handle = dlopen(path, RTLD_NOW | RTLD_LOCAL);
        if (handle == nullptr) tried += (tried.empty() ? "" : "; ") + std::string(dlerror());
        return handle;
    };
    for (const std::string& path : paths)
        if (void* handle = open(path.c_str())) return handle;
    for (const char* name : kSystemNames)
        if (void* handle = open(name)) return handle;
    throw InputError(kDenoiser, "library", "not found (" + tried + ")", kLibraryWanted);
}

std::string version_text(int number) {
    return std::to_string(number / 10000) + "." + std::to_string(number / 100 % 100) + "." +
           std::to_string(number % 100);
}

bool goes_on(void* cancel, double) {
    return !static_cast<const CancelToken*>(cancel)->cancelled();
}

}  // namespace

/// Its functions. Version 2 calls some of them otherwise.
struct Denoiser::Library {
    void* handle = nullptr;
    void* (*new_device)(int) = nullptr;
    void (*commit_device)(void*) = nullptr;
    void (*release_device)(void*) = nullptr;
    int (*device_error)(void*, const char**) = nullptr;
    int (*device_number)(void*, const char*) = nullptr;
    void (*set_device_number)(void*, const char*, int) = nullptr;
    void (*set_device_flag)(void*, const char*, bool) = nullptr;
    void* (*new_filter)(void*, const char*) = nullptr;
    void (*set_image)(void*, const char*, void*, int, size_t, size_t, size_t, size_t, size_t) = nullptr;
    void (*set_filter_flag)(void*, const char*, bool) = nullptr;
    void (*set_monitor)(void*, bool (*)(void*, double), void*) = nullptr;
    void (*commit_filter)(void*) = nullptr;
    void (*execute_filter)(void*) = nullptr;
    void (*release_filter)(void*) = nullptr;

    explicit Library(const std::vector<std::string>& paths) : handle(opened_library(paths)) {
        find(new_device, "oidnNewDevice");
        find(commit_device, "oidnCommitDevice");
        find(release_device, "oidnReleaseDevice");
        find(device_error, "oidnGetDeviceError");
        find(device_number, "oidnGetDeviceInt", "oidnGetDevice1i");
        find(set_device_number, "oidnSetDeviceInt", "oidnSetDevice1i");
        find(set_device_flag, "oidnSetDeviceBool", "oidnSetDevice1b");
        find(new_filter, "oidnNewFilter");
        find(set_image, "oidnSetSharedFilterImage");
        find(set_filter_flag, "oidnSetFilterBool", "oidnSetFilter1b");
        find(set_monitor, "oidnSetFilterProgressMonitorFunction");
        find(commit_filter, "oidnCommitFilter");
        find(execute_filter, "oidnExecuteFilter");
        find(release_filter, "oidnReleaseFilter");
    }

    template <typename Function>
    void find(Function*& function, const char* name, const char* name_before = nullptr) {
        void* found = dlsym(handle, name);
        if (found == nullptr && name_before != nullptr) found = dlsym(handle, name_before);
        if (found == nullptr) throw InputError(kDenoiser, "library", std::string("without ") + name, kLibraryWanted);
        function = reinterpret_cast<Function*>(found);  // NOLINT: POSIX says that it may be done
    }
};

Denoiser::Denoiser(const std::vector<std::string>& paths, int threads)
    : library_(std::make_unique<const Library>(paths)) {
    constexpr int kMostThreads = 1024;
    if (threads < 0 || threads > kMostThreads)
        throw InputError(kDenoiser, "threads", std::to_string(threads), "0 to " + std::to_string(kMostThreads));
    device_ = library_->new_device(kCpuDevice);
    if (device_ == nullptr) {
        const char* text = nullptr;
        library_->device_error(nullptr, &text);
        throw InputError(kDenoiser, "library", text != nullptr ? quotable(text) : "without a device for processors",
                         "one that denoises on processors");
    }
    if (threads > 0) library_->set_device_number(device_, "numThreads", threads);
    // Others work in this process meanwhile.
    library_->set_device_flag(device_, "setAffinity", false);
    library_->commit_device(device_);
    version_ = version_text(library_->device_number(device_, "version"));
    try {
        throw_error();
    } catch (const InputError&) {
        library_->release_device(device_);
        throw;
    }
}

Denoiser::~Denoiser() {
    library_->release_device(device_);
}

void Denoiser::throw_error() const {
    const char* text = nullptr;
    const int code = library_->device_error(device_, &text);
    if (code == kNoError) return;
    if (code == kCancelledError) throw Cancelled();
    throw InputError(kDenoiser, "library", "Open Image Denoise " + version_ + ": " + quotable(text ? text : "an error"),
                     "one that works");
}

/// Denoises one image of the picture by the others, `color` by all of them.
void Denoiser::filter(const NoisyPicture& picture, const char* image, std::vector<float>& output,
                      const CancelToken& cancel) const {
    const Library& library = *library_;
    void* const filter = library.new_filter(device_, "RT");
    const auto width = static_cast<size_t>(picture.width), height = static_cast<size_t>(picture.height);
    const auto set = [&](const char* name, const float* pixels) {
        // The library writes to the output alone.
        library.set_image(filter, name, const_cast<float*>(pixels), kThreeFloats, width, height, 0, 0, 0);  // NOLINT
    };
    const std::string which = image;
    if (which == "color") {
        set("color", picture.color.data());
        if (!picture.albedo.empty()) set("albedo", picture.albedo.data());
        if (!picture.albedo.empty() && !picture.normal.empty()) set("normal", picture.normal.data());
        library.set_filter_flag(filter, "hdr", true);
        if (!picture.albedo.empty() && picture.guides != DenoisingGuides::Noisy)
            library.set_filter_flag(filter, "cleanAux", true);
    } else {
        set(image, which == "albedo" ? picture.albedo.data() : picture.normal.data());
    }
    set("output", output.data());
    library.set_monitor(filter, &goes_on, const_cast<CancelToken*>(&cancel));  // NOLINT: it is asked only
    library.commit_filter(filter);
    library.execute_filter(filter);
    library.release_filter(filter);
    throw_error();
}

std::vector<float> Denoiser::denoised(const NoisyPicture& picture, const CancelToken& cancel) const {
    const size_t numbers = 3 * static_cast<size_t>(picture.width) * static_cast<size_t>(picture.height);
    const auto fits = [numbers](std::span<const float> image, bool optional) {
        return image.size() == numbers || (optional && image.empty());
    };
    if (picture.width < 1 || picture.height < 1 || !fits(picture.color, false) || !fits(picture.albedo, true) ||
        !fits(picture.normal, true))
        throw InputError(kDenoiser, "images", "of different sizes", "three numbers for each pixel");
    std::vector<float> output(numbers);
    NoisyPicture guided = picture;
    std::vector<float> albedo, normal;
    if (picture.guides == DenoisingGuides::Denoised) {
        const auto prepare = [&](std::span<const float>& guide, const char* name, std::vector<float>& clean) {
            if (guide.empty()) return;
            clean.resize(numbers);
            filter(picture, name, clean, cancel);
            guide = clean;
        };
        prepare(guided.albedo, "albedo", albedo);
        prepare(guided.normal, "normal", normal);
    }
    filter(guided, "color", output, cancel);
    return output;
}

}  // namespace rayleaf
