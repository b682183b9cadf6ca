"""A library with Open Image Denoise's C interface, of version 1 or 2, made for the tests: what it puts out tells what it was
given. Its colour is the mean of the colour, plus 1 for albedo, 2 for normal, 4 for clean guides, 8 for high dynamic range;
guides denoised by themselves become twice what they were."""

import subprocess
import tempfile
from functools import cache
from pathlib import Path

SOURCE = r"""
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
struct image { const char* name; float* pixels; size_t width, height; };
struct filter { struct image images[4]; int count; bool clean, hdr; bool (*monitor)(void*, double); void* user; };
static int error_code; static const char* error_text; static int device;
void* oidnNewDevice(int type) {
    if (NO_DEVICE || type != 1) { error_code = 5; error_text = "unsupported hardware"; return 0; }
    return &device;
}
void oidnCommitDevice(void* d) { (void)d; }
void oidnReleaseDevice(void* d) { (void)d; }
int oidnGetDeviceError(void* d, const char** text) {
    (void)d; int code = error_code; *text = error_text; error_code = 0; error_text = 0; return code;
}
int GET_INT(void* d, const char* name) { (void)d; return strcmp(name, "version") == 0 ? VERSION : -1; }
void SET_INT(void* d, const char* name, int value) { (void)d; (void)name; (void)value; }
void SET_BOOL(void* d, const char* name, bool value) { (void)d; (void)name; (void)value; }
void* oidnNewFilter(void* d, const char* type) {
    (void)d; return strcmp(type, "RT") == 0 ? calloc(1, sizeof(struct filter)) : 0;
}
void oidnSetSharedFilterImage(void* f, const char* name, void* pixels, int format, size_t width, size_t height,
                              size_t offset, size_t pixel, size_t row) {
    struct filter* filter = f; (void)offset; (void)pixel; (void)row;
    if (format != 3) { error_code = 2; error_text = "format"; }
    struct image image = {name, pixels, width, height}; filter->images[filter->count++] = image;
}
void FILTER_BOOL(void* f, const char* name, bool value) {
    struct filter* filter = f;
    if (strcmp(name, "cleanAux") == 0) filter->clean = value;
    if (strcmp(name, "hdr") == 0) filter->hdr = value;
}
void oidnSetFilterProgressMonitorFunction(void* f, bool (*monitor)(void*, double), void* user) {
    struct filter* filter = f; filter->monitor = monitor; filter->user = user;
}
void oidnCommitFilter(void* f) { (void)f; }
static struct image* find(struct filter* f, const char* name) {
    for (int i = 0; i < f->count; ++i) if (strcmp(f->images[i].name, name) == 0) return &f->images[i];
    return 0;
}
void oidnExecuteFilter(void* f) {
    struct filter* filter = f;
    if (FAILS) { error_code = 4; error_text = "out of memory"; return; }
    if (filter->monitor && !filter->monitor(filter->user, 0.5)) { error_code = 6; error_text = "cancelled"; return; }
    struct image *color = find(filter, "color"), *output = find(filter, "output");
    struct image *albedo = find(filter, "albedo"), *normal = find(filter, "normal");
    size_t numbers = 3 * output->width * output->height;
    if (!color) {
        float* guide = (albedo ? albedo : normal)->pixels;
        for (size_t i = 0; i < numbers; ++i) output->pixels[i] = 2 * guide[i];
        return;
    }
    double sum = 0;
    for (size_t i = 0; i < numbers; ++i) sum += color->pixels[i];
    float value = sum / numbers + (albedo ? 1 : 0) + (normal ? 2 : 0) + (filter->clean ? 4 : 0) + (filter->hdr ? 8 : 0);
    for (size_t i = 0; i < numbers; ++i) output->pixels[i] = value + (albedo ? 100 * albedo->pixels[i] : 0);
}
void RELEASE(void* f) { free(f); }
"""
NAMES = {
    1: dict(GET_INT="oidnGetDevice1i", SET_INT="oidnSetDevice1i", SET_BOOL="oidnSetDevice1b", FILTER_BOOL="oidnSetFilter1b"),
    2: dict(GET_INT="oidnGetDeviceInt", SET_INT="oidnSetDeviceInt", SET_BOOL="oidnSetDeviceBool",
            FILTER_BOOL="oidnSetFilterBool"),
}  # fmt: skip


@cache
def library(version: int = 2, no_device: int = 0, fails: int = 0, release: str = "oidnReleaseFilter") -> str:
    """The path of one. `release`: what it calls the function that releases filters."""
    folder = Path(tempfile.mkdtemp(prefix="rayleaf-denoiser-"))
    (folder / "fake.c").write_text(SOURCE)
    names = NAMES[version] | {"VERSION": 10403 if version == 1 else 20303, "RELEASE": release}
    names |= {"NO_DEVICE": no_device, "FAILS": fails}
    options = [f"-D{name}={value}" for name, value in names.items()]
    path = folder / f"libfake{version}.so"
    subprocess.run(["cc", "-shared", "-fPIC", *options, str(folder / "fake.c"), "-o", str(path)], check=True)
    return str(path)
