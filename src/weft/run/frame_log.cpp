#include "weft/run/frame_log.h"

#include <utility>

#include "weft/error.h"

namespace weft::engine {
namespace {

/// Calls visit(address, number of bytes) for each list of numbers.
template <class Frame, class Visit>
void visit_numbers(Frame& frame, const Visit& visit) {
  for (auto& cloth : frame.cloths) visit(cloth.data(), cloth.size() * sizeof(float));
  for (auto& pose : frame.poses) {
    visit(pose.translation.data(), 3 * sizeof(double));
    visit(pose.rotation.coeffs().data(), 4 * sizeof(double));
  }
  for (auto& body : frame.body_vertices) visit(body.data(), body.size() * sizeof(float));
  for (auto& cloth : frame.values) visit(cloth.data(), cloth.size() * sizeof(float));
}

std::uintmax_t size_of(const AnimationFrame& frame) {
  std::uintmax_t size = 0;
  visit_numbers(frame, [&](const void*, std::size_t bytes) { size += bytes; });
  return size;
}

}  // namespace

FrameLog::FrameLog(const std::filesystem::path& file, const std::filesystem::path& log, AnimationFrame like,
                   int num_frames)
    : log_(log),
      like_(std::move(like)),
      file_(file, log, num_frames * size_of(like_)),
      num_frames_(num_frames) {}

void FrameLog::append(const AnimationFrame& frame) {
  visit_numbers(frame, [&](const void* numbers, std::size_t bytes) {
    file_.out().write(static_cast<const char*>(numbers), static_cast<std::streamsize>(bytes));
  });
  file_.flush();
  ++num_frames_;
}

FrameLogReader::FrameLogReader(std::filesystem::path log, AnimationFrame like)
    : log_(std::move(log)), frame_(std::move(like)), size_(size_of(frame_)), in_(log_, std::ios::binary) {}

int FrameLogReader::num_frames() {
  in_.clear();
  in_.seekg(0, std::ios::end);  // of the open file: it may have been removed since
  const std::streamoff size = in_.tellg();
  return size < 0 ? 0 : static_cast<int>(static_cast<std::uintmax_t>(size) / size_);
}

const AnimationFrame& FrameLogReader::read(int frame) {
  in_.clear();  // of an end that has moved since
  in_.seekg(static_cast<std::streamoff>(size_ * static_cast<std::uintmax_t>(frame)));
  visit_numbers(frame_, [&](void* numbers, std::size_t bytes) {
    in_.read(static_cast<char*>(numbers), static_cast<std::streamsize>(bytes));
  });
  if (!in_) throw InputError(log_.string() + " cannot be read");
  return frame_;
}

void FrameSpool::append(AnimationFrame frame) {
  visit_numbers(frame, [&](const void* numbers, std::size_t bytes) { file_.append(numbers, bytes); });
  like_ = std::move(frame);
  ++num_frames_;
}

AnimationFrame FrameSpool::read(int frame) {
  AnimationFrame read = like_;
  std::size_t position = size_of(like_) * static_cast<std::size_t>(frame);
  visit_numbers(read, [&](void* numbers, std::size_t bytes) {
    file_.read(position, numbers, bytes);
    position += bytes;
  });
  return read;
}

}  // namespace weft::engine
