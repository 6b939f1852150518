/// Records the examples for pictures of the docs: unchanged sources of examples/, with a World that records
/// its steps.

#include <algorithm>
#include <cmath>
#include <deque>
#include <exception>
#include <filesystem>
#include <iostream>
#include <memory>
#include <vector>

#include "weft/face/world_impl.h"
#include "weft/io/glb_writer.h"
#include "weft/run/film.h"
#include "weft/weft.h"

namespace {

/// Records the first world that an example steps.
class Recorder {
 public:
  void record(const weft::World& world) {
    if (filmed_ == nullptr) {
      filmed_ = &world;
      animation_ = weft::engine::make_animation(weft::WorldAccess::engine(world));
    }
    if (&world == filmed_)
      weft::engine::append_frame(weft::engine::capture_frame(weft::WorldAccess::engine(world)), animation_);
  }

  void write(const std::filesystem::path& file) {
    weft::engine::write_glb(file, animation_);
    filmed_ = nullptr;
  }

 private:
  const weft::World* filmed_ = nullptr;
  weft::engine::Animation animation_;
} recorder;

class RecordedWorld : public weft::World {
 public:
  RecordedWorld() = default;
  RecordedWorld(weft::World&& world) : weft::World(std::move(world)) {}
  weft::StepReport step(double dt) {
    weft::StepReport report = weft::World::step(dt);
    recorder.record(*this);
    return report;
  }
};

class RecordedBatch : public weft::WorldBatch {
 public:
  using weft::WorldBatch::WorldBatch;
  std::vector<weft::StepReport> step(double dt) {
    std::vector<weft::StepReport> reports = weft::WorldBatch::step(dt);
    recorder.record((*this)[6]);
    return reports;
  }
};

}  // namespace

// In each namespace, `weft` is Weft with World and WorldBatch replaced by the recording ones.
#define WEFT_EXAMPLE(name)          \
  namespace name::weft {            \
  using namespace ::weft;           \
  using World = RecordedWorld;      \
  using WorldBatch = RecordedBatch; \
  }
WEFT_EXAMPLE(hello_cloth)
WEFT_EXAMPLE(gripper)
WEFT_EXAMPLE(cape)
WEFT_EXAMPLE(game_loop)
WEFT_EXAMPLE(contact_forces)
WEFT_EXAMPLE(batch_of_worlds)
WEFT_EXAMPLE(rollback)
namespace hello_cloth {
#include "examples/hello_cloth.cpp"
}
namespace gripper {
#include "examples/gripper.cpp"
}
namespace cape {
#include "examples/cape.cpp"
}
namespace game_loop {
#include "examples/game_loop.cpp"
}
namespace contact_forces {
#include "examples/contact_forces.cpp"
}
namespace batch_of_worlds {
#include "examples/batch_of_worlds.cpp"
}
namespace rollback {
#include "examples/rollback.cpp"
}

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "film_examples FOLDER\n";
    return 2;
  }
  const struct {
    const char* name;
    int (*main)();
  } examples[] = {{"hello_cloth", hello_cloth::main},
                  {"gripper", gripper::main},
                  {"cape", cape::main},
                  {"game_loop", game_loop::main},
                  {"contact_forces", contact_forces::main},
                  {"batch_of_worlds", batch_of_worlds::main},
                  {"rollback", rollback::main}};
  try {
    for (const auto& example : examples) {
      if (example.main() != 0) std::cerr << example.name << " failed\n";
      recorder.write(std::filesystem::path(argv[1]) / (std::string(example.name) + ".glb"));
    }
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
}
