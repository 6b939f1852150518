#include "weft/render/image.h"

#include <algorithm>
#include <ostream>

#include "weft/core/staged_file.h"
#include "weft/error.h"

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_image.h>
#include <stb_image_write.h>
#pragma GCC diagnostic pop

namespace weft::engine {
namespace {

Image read(const std::filesystem::path& file, const char* kind) {
  int width = 0, height = 0, channels = 0;
  std::uint8_t* pixels = stbi_load(file.string().c_str(), &width, &height, &channels, 4);
  if (!pixels)
    throw InputError(file.string() + " cannot be read as a " + kind + ": " + stbi_failure_reason());
  Image image(width, height);
  std::copy_n(pixels, image.rgba.size(), image.rgba.begin());
  stbi_image_free(pixels);
  return image;
}

}  // namespace

Image::Image(int width_, int height_)
    : width(width_),
      height(height_),
      rgba(4 * static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)) {}

Image make_contact_sheet(const std::vector<Image>& images, int columns, int gap) {
  if (images.empty()) return {};
  const int count = static_cast<int>(images.size()), rows = (count + columns - 1) / columns;
  columns = std::min(columns, count);
  const int w = images[0].width, h = images[0].height;
  Image sheet(columns * w + (columns - 1) * gap, rows * h + (rows - 1) * gap);
  std::fill(sheet.rgba.begin(), sheet.rgba.end(), std::uint8_t{255});
  for (int k = 0; k < count; ++k) {
    const int left = k % columns * (w + gap), top = k / columns * (h + gap);
    for (int y = 0; y < h; ++y)
      std::copy_n(images[k].pixel(0, y), 4 * static_cast<std::size_t>(w), sheet.pixel(left, top + y));
  }
  return sheet;
}

bool is_picture(const std::filesystem::path& file) {
  return file.extension() == ".png" || file.extension() == ".jpg";
}

void write_image(const std::filesystem::path& file, const Image& image) {
  constexpr int kJpegQuality = 92;
  StagedFile staged(file);
  std::ostream& out = staged.out();
  const auto write = [](void* stream, void* data, int size) {
    static_cast<std::ostream*>(stream)->write(static_cast<const char*>(data), size);
  };
  const int done = file.extension() == ".jpg" ? stbi_write_jpg_to_func(write, &out, image.width, image.height,
                                                                       4, image.rgba.data(), kJpegQuality)
                                              : stbi_write_png_to_func(write, &out, image.width, image.height,
                                                                       4, image.rgba.data(), 4 * image.width);
  if (!done) throw InputError(file.string() + " cannot be written: the picture cannot be encoded");
  staged.finish();
  staged.replace();
}

Image read_png(const std::filesystem::path& file) { return read(file, "PNG"); }
Image read_jpg(const std::filesystem::path& file) { return read(file, "JPEG"); }

}  // namespace weft::engine
