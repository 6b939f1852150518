// Makes garments, a moving figure and scenes of both: make_wardrobe FOLDER [CELL]
// Makes the meshes of scenes garments/walk and garments/sewn_dress, and prints the seams of the latter:
// make_wardrobe --walk FOLDER
//
// `weft bench garments` runs the first scenes (tools/wardrobe/wardrobe.h).

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>

#include "tools/wardrobe/walk.h"
#include "tools/wardrobe/wardrobe.h"

int main(int argc, char** argv) try {
  if (argc == 3 && std::strcmp(argv[1], "--walk") == 0) {
    std::printf("%s", weft::engine::wardrobe::write_walk(argv[2]).c_str());
    return 0;
  }
  const double cell = argc == 3 ? std::atof(argv[2]) : 0.009;
  if (argc < 2 || argc > 3 || !(cell >= 0.003 && cell <= 0.05)) {
    std::fprintf(stderr,
                 "usage: make_wardrobe FOLDER [CELL from 0.003 to 0.05 m], make_wardrobe --walk FOLDER\n");
    return 2;
  }
  for (const std::string& scene : weft::engine::wardrobe::write_wardrobe(argv[1], cell))
    std::printf("%s/%s.toml\n", argv[1], scene.c_str());
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "make_wardrobe: %s\n", error.what());
  return 1;
}
