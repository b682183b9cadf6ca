// OpenImageIO's texture system, for the files that implement textures.
#pragma once

#include <OpenImageIO/imagecache.h>
#include <OpenImageIO/texture.h>

namespace rayleaf {

/// The texture system of all stores, apart from any that the host program has. It is made by the first store and never
/// destroyed: OpenImageIO 2.4 frees part of it with another alignment than it was allocated with, which corrupts the
/// heap under jemalloc, the allocator that Blender runs with. Stores give their tiles back one by one instead.
OIIO::TextureSystem& texture_system();
/// The files that it knows.
OIIO::ImageCache& texture_files();

}  // namespace rayleaf
