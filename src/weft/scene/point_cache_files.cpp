/// Public classes for point caches.

#include <cmath>
#include <variant>

#include "weft/error.h"
#include "weft/io.h"
#include "weft/io/mdd.h"
#include "weft/io/mesh_files.h"
#include "weft/io/pc2.h"

namespace weft {

struct PointCacheFile::Impl {
  std::string name;
  std::unique_ptr<engine::PointCacheReader> reader;
};

PointCacheFile::PointCacheFile(const std::string& file)
    : impl_(new Impl{file, engine::open_point_cache(file)}) {}
PointCacheFile::~PointCacheFile() = default;
PointCacheFile::PointCacheFile(PointCacheFile&&) noexcept = default;
PointCacheFile& PointCacheFile::operator=(PointCacheFile&&) noexcept = default;

int PointCacheFile::num_points() const { return impl_->reader->num_points(); }
int PointCacheFile::num_frames() const { return impl_->reader->num_frames(); }

std::vector<float> PointCacheFile::times() const {
  const auto* mdd = dynamic_cast<const engine::MddReader*>(impl_->reader.get());
  return mdd ? mdd->times() : std::vector<float>();
}

std::vector<float> PointCacheFile::frame(int k) const {
  if (k < 0 || k >= num_frames())
    throw InputError(impl_->name + " has " + std::to_string(num_frames()) + " frames; it has no frame " +
                     std::to_string(k));
  return impl_->reader->frame(k);
}

struct PointCacheWriter::Impl {
  Impl(const std::string& name, int num_points, const std::vector<float>& times)
      : file(name), num_frames(times.size()) {
    if (engine::has_ending(name, ".mdd"))
      writer.emplace<engine::MddWriter>(file, num_points, times);
    else
      writer.emplace<engine::Pc2Writer>(file, num_points);
  }

  engine::StagedFile file;
  std::size_t num_frames, num_written = 0;
  std::variant<std::monostate, engine::Pc2Writer, engine::MddWriter> writer;
};

PointCacheWriter::PointCacheWriter(const std::string& file, int num_points, const std::vector<float>& times) {
  if (!engine::has_ending(file, ".pc2") && !engine::has_ending(file, ".mdd"))
    throw InputError(file + ": a point cache is written as .pc2 or .mdd");
  if (num_points < 1) throw InputError(file + ": a point cache has at least one point");
  impl_ = std::make_unique<Impl>(file, num_points, times);
}
PointCacheWriter::~PointCacheWriter() = default;
PointCacheWriter::PointCacheWriter(PointCacheWriter&&) noexcept = default;
PointCacheWriter& PointCacheWriter::operator=(PointCacheWriter&&) noexcept = default;

void PointCacheWriter::add_frame(std::span<const float> positions) {
  for (const float x : positions) {
    if (!std::isfinite(x))
      throw InputError(impl_->file.file().string() + ": a position of frame " +
                       std::to_string(impl_->num_written) + " is not finite");
  }
  std::visit(
      [&](auto& writer) {
        if constexpr (requires { writer.add_frame(positions); }) writer.add_frame(positions);
      },
      impl_->writer);
  ++impl_->num_written;
}

void PointCacheWriter::finish() {
  if (impl_->num_written != impl_->num_frames)
    throw InputError(impl_->file.file().string() + ": " + std::to_string(impl_->num_written) +
                     " frames, expected " + std::to_string(impl_->num_frames));
  impl_->file.finish();
  impl_->file.replace();
}

}  // namespace weft
