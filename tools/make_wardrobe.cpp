// Makes garments, a moving figure and scenes of both: make_wardrobe FOLDER [CELL]
//
// `weft bench garments` runs these scenes (tools/wardrobe/wardrobe.h).

#include <cstdio>
#include <cstdlib>
#include <exception>

#include "tools/wardrobe/wardrobe.h"

int main(int argc, char** argv) {
  const double cell = argc == 3 ? std::atof(argv[2]) : 0.009;
  if (argc < 2 || argc > 3 || !(cell >= 0.003 && cell <= 0.05)) {
    std::fprintf(stderr, "usage: make_wardrobe FOLDER [CELL from 0.003 to 0.05 m]\n");
    return 2;
  }
  try {
    for (const std::string& scene : weft::engine::wardrobe::write_wardrobe(argv[1], cell))
      std::printf("%s/%s.toml\n", argv[1], scene.c_str());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "make_wardrobe: %s\n", error.what());
    return 1;
  }
  return 0;
}
