#include "weft/render/image.h"

#include <gtest/gtest.h>

#include <fstream>

#include "weft/error.h"

namespace weft::engine {
namespace {

const std::filesystem::path kFolder = WEFT_OUTPUT_DIR;

Image make_image(int width, int height, int seed) {
  Image image(width, height);
  for (std::size_t i = 0; i < image.rgba.size(); ++i) image.rgba[i] = static_cast<std::uint8_t>(seed + 7 * i);
  return image;
}

TEST(Png, ComesBackAsItWasWritten) {
  std::filesystem::create_directories(kFolder);
  const Image image = make_image(37, 11, 3);
  write_image(kFolder / "round_trip.png", image);
  const Image back = read_png(kFolder / "round_trip.png");
  EXPECT_EQ(back.width, 37);
  EXPECT_EQ(back.height, 11);
  EXPECT_EQ(back.rgba, image.rgba);
}

TEST(Png, ThatCannotBeWrittenOrReadIsNamed) {
  try {
    write_image(kFolder / "no such folder" / "a.png", make_image(2, 2, 0));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("a.png cannot be written: No such file"), std::string::npos)
        << error.what();
  }
  std::ofstream(kFolder / "text.png") << "no picture";
  EXPECT_THROW(read_png(kFolder / "text.png"), InputError);
  if (std::filesystem::exists("/dev/full")) {
    EXPECT_THROW(write_image("/dev/full", make_image(64, 64, 0)), InputError) << "a full disk is told";
  }
}

TEST(ContactSheet, PutsPicturesRowByRowWithWhiteBetween) {
  const std::vector<Image> images = {make_image(4, 3, 1), make_image(4, 3, 2), make_image(4, 3, 3)};
  const Image sheet = make_contact_sheet(images, 2, 5);
  ASSERT_EQ(sheet.width, 2 * 4 + 5);
  ASSERT_EQ(sheet.height, 2 * 3 + 5);
  EXPECT_EQ(sheet.pixel(0, 0)[0], images[0].pixel(0, 0)[0]);
  EXPECT_EQ(sheet.pixel(9 + 3, 2)[3], images[1].pixel(3, 2)[3]);
  EXPECT_EQ(sheet.pixel(1, 8 + 1)[2], images[2].pixel(1, 1)[2]);
  EXPECT_EQ(sheet.pixel(5, 1)[0], 255) << "the gap";
  EXPECT_EQ(sheet.pixel(12, 10)[0], 255) << "the empty place";
  EXPECT_EQ(make_contact_sheet(images, 9, 0).width, 12) << "no more columns than pictures";
}

}  // namespace
}  // namespace weft::engine
