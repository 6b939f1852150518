#pragma once
/// Images in memory and as files.

#include <cstdint>
#include <filesystem>
#include <vector>

namespace weft::engine {

/// Rows from the top, four bytes per pixel: sRGB red, green, blue, and alpha (not premultiplied).
struct Image {
  int width = 0, height = 0;       // [pixels]
  std::vector<std::uint8_t> rgba;  // (height x width x 4)

  Image() = default;
  Image(int width, int height);  // transparent black

  const std::uint8_t* pixel(int x, int y) const {
    return rgba.data() + 4 * (static_cast<std::size_t>(y) * width + x);
  }
  std::uint8_t* pixel(int x, int y) { return rgba.data() + 4 * (static_cast<std::size_t>(y) * width + x); }
};

/// Contact sheet: images of one size in rows of `columns` (>= 1), separated by `gap` white pixels.
Image make_contact_sheet(const std::vector<Image>& images, int columns, int gap);

/// Whether write_image supports the file's extension: .png, or .jpg, which drops alpha.
bool is_picture(const std::filesystem::path& file);

/// Replaces the file atomically. Throws InputError if it cannot be written.
void write_image(const std::filesystem::path& file, const Image& image);

/// Throws InputError if the file cannot be read or is not a PNG.
Image read_png(const std::filesystem::path& file);
Image read_jpg(const std::filesystem::path& file);  // likewise

}  // namespace weft::engine
