#include "lab/accuracy/reference.h"

#include <fmt/core.h>

#include <cmath>
#include <cstdlib>
#include <fstream>

#include "weft/core/hash.h"
#include "weft/error.h"
#include "weft/world/measures.h"

namespace weft::engine::lab {
namespace {

constexpr int kVersion = 1;             // of the method: raise it with every change of the results
constexpr double kShareOfLimit = 0.25;  // step, as a share of the stability limit

std::uint64_t hash_of(const HungCloth& cloth, int num_frames, int substeps) {
  Hash hash;
  for (const int n : {kVersion, num_frames, substeps}) hash.add(n);
  add_to_hash(cloth.state, hash);
  const ClothModel& model = *cloth.model;
  const std::vector<Spring>& springs = model.topology->springs;
  for (std::size_t s = 0; s < springs.size(); ++s) {
    hash.add(springs[s].i);
    hash.add(springs[s].j);
    hash.add(springs[s].rest_length);
    hash.add(model.stiffness(static_cast<int>(s)));
  }
  for (const double m : model.mass) hash.add(m);
  hash.add(model.material.damping);
  for (const int p : cloth.environment.pins.particle) hash.add(p);
  for (const double g : cloth.environment.gravity) hash.add(g);
  return hash.value();
}

template <class OnFrame>
void simulate(HungCloth cloth, int num_frames, int substeps, const OnFrame& on_frame) {
  const auto integrator = make_integrator({.integrator = "explicit"});
  const auto jobs = make_serial_jobs();
  for (int f = 0; f < num_frames; ++f) {
    for (int s = 0; s < substeps; ++s)
      integrator->advance(*cloth.model, cloth.environment, kReferenceFrame / substeps, *jobs, cloth.state);
    on_frame(f, cloth.state);
  }
}

Reference compute_reference(const HungCloth& cloth, int num_frames, int substeps) {
  Reference reference;
  simulate(cloth, num_frames, substeps, [&](int, const ClothState& state) {
    reference.frames.push_back(frame_of(state));
    reference.strain = std::max(reference.strain, compute_strain(*cloth.model, state).max);
  });
  simulate(cloth, num_frames, substeps / 2, [&](int f, const ClothState& state) {
    reference.error += distance_from(reference.frames[f], state) / num_frames;
  });
  return reference;
}

// Binary file in the format of this machine: error, strain, and all frames as in memory.

bool read(const std::filesystem::path& file, std::size_t num_frames, std::size_t frame_size,
          Reference& reference) {
  std::ifstream in(file, std::ios::binary);
  in.read(reinterpret_cast<char*>(&reference.error), sizeof reference.error);
  in.read(reinterpret_cast<char*>(&reference.strain), sizeof reference.strain);
  reference.frames.assign(num_frames, std::vector<float>(frame_size));
  for (auto& frame : reference.frames)
    in.read(reinterpret_cast<char*>(frame.data()), static_cast<std::streamsize>(frame_size * sizeof(float)));
  return in.good();
}

void write(const Reference& reference, const std::filesystem::path& file) {
  std::filesystem::create_directories(file.parent_path());
  const std::filesystem::path part = file.string() + ".part";  // atomic: a file is complete or missing
  std::ofstream out(part, std::ios::binary);
  out.write(reinterpret_cast<const char*>(&reference.error), sizeof reference.error);
  out.write(reinterpret_cast<const char*>(&reference.strain), sizeof reference.strain);
  for (const auto& frame : reference.frames) {
    out.write(reinterpret_cast<const char*>(frame.data()),
              static_cast<std::streamsize>(frame.size() * sizeof(float)));
  }
  out.close();
  if (!out) throw InputError("cannot write " + part.string() + "; name another folder with --cache");
  std::filesystem::rename(part, file);
}

}  // namespace

std::vector<float> frame_of(const ClothState& state) {
  std::vector<float> frame;
  frame.reserve(3 * state.x.size());
  for (std::size_t i = 0; i < state.x.size(); ++i) {
    for (const double c : state.x.get(i)) frame.push_back(static_cast<float>(c));
  }
  return frame;
}

Reference find_reference(const HungCloth& cloth, int num_frames, const std::filesystem::path& folder,
                         const std::function<void(const std::string&)>& say) {
  const double limit = kShareOfLimit * explicit_step_limit(*cloth.model, cloth.environment.wind);
  const int substeps = static_cast<int>(std::ceil(kReferenceFrame / limit));
  const auto file = folder / fmt::format("reference-{:016x}.bin", hash_of(cloth, num_frames, substeps));
  Reference reference;
  if (read(file, num_frames, 3 * cloth.state.x.size(), reference)) return reference;
  if (say) say(fmt::format("{}: computing the reference, {} substeps per frame", cloth.name, substeps));
  reference = compute_reference(cloth, num_frames, substeps);
  write(reference, file);
  return reference;
}

double distance_from(const std::vector<float>& frame, const ClothState& state) {
  double sum = 0;
  for (std::size_t i = 0; i < state.x.size(); ++i) {
    sum += (Vec3(frame[3 * i], frame[3 * i + 1], frame[3 * i + 2]) - state.x.get(i)).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(state.x.size()));
}

std::filesystem::path default_cache_folder() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && *cache)
    return std::filesystem::path(cache) / "weft";
  if (const char* home = std::getenv("HOME"); home && *home)
    return std::filesystem::path(home) / ".cache" / "weft";
  return std::filesystem::temp_directory_path() / "weft";
}

}  // namespace weft::engine::lab
