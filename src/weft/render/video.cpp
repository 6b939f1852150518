#include "weft/render/video.h"

#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <sstream>
#include <system_error>
#include <vector>

#include "weft/error.h"

extern char** environ;

namespace weft::engine {
namespace {

using Arguments = std::vector<std::string>;

/// Encoding options of ffmpeg for each file type.
Arguments encoding(const std::filesystem::path& file) {
  const std::string ending = file.extension().string();
  if (ending == ".mp4") {
    return {"-vf",       "crop=trunc(iw/2)*2:trunc(ih/2)*2",
            "-c:v",      "libx264",
            "-pix_fmt",  "yuv420p",
            "-crf",      "20",
            "-movflags", "+faststart",
            "-f",        "mp4"};
  }
  if (ending == ".webp") {
    return {"-c:v", "libwebp_anim", "-quality", "70", "-compression_level", "5", "-loop", "0", "-f", "webp"};
  }
  if (ending == ".gif") {
    return {"-vf",   "split[a][b];[a]palettegen[p];[b][p]paletteuse=dither=bayer:bayer_scale=4",
            "-loop", "0",
            "-f",    "gif"};
  }
  throw InputError(file.string() + ": expected a file name ending in .mp4, .webp or .gif");
}

Arguments command(const std::filesystem::path& file, const std::filesystem::path& part, int width, int height,
                  double frames_per_second) {
  Arguments arguments = {"ffmpeg",    "-y",
                         "-loglevel", "error",
                         "-f",        "rawvideo",
                         "-pix_fmt",  "rgba",
                         "-s",        std::to_string(width) + "x" + std::to_string(height),
                         "-r",        std::to_string(frames_per_second),
                         "-i",        "-",
                         "-an"};
  for (std::string& argument : encoding(file)) arguments.push_back(std::move(argument));
  arguments.push_back("file:" + part.string());
  return arguments;
}

/// Ctrl-C and job managers signal the whole process group; ffmpeg ends when its input does, with a complete
/// file.
void block_signals(posix_spawnattr_t& attributes) {
  sigset_t blocked;
  sigemptyset(&blocked);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&blocked, signal);
  posix_spawnattr_setsigmask(&attributes, &blocked);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
}

}  // namespace

bool is_video(const std::filesystem::path& file) {
  const std::string ending = file.extension().string();
  return ending == ".mp4" || ending == ".webp" || ending == ".gif";
}

void require_ffmpeg(const std::filesystem::path& file) {
  std::istringstream folders(std::getenv("PATH") ? std::getenv("PATH") : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (access((std::filesystem::path(folder) / "ffmpeg").c_str(), X_OK) == 0) return;
  }
  throw InputError(file.string() +
                   " requires ffmpeg, which is not installed; install it (on Debian and Ubuntu: apt-get "
                   "install ffmpeg), or use .png pictures");
}

VideoWriter::VideoWriter(const std::filesystem::path& file, int width, int height, double frames_per_second)
    : file_(file), part_(file.string() + ".part") {
  Arguments arguments = command(file_, part_, width, height, frames_per_second);
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  // A socket, not a pipe: sends to a closed socket need not raise SIGPIPE.
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
    fail(std::generic_category().message(errno));
  to_ffmpeg_ = ends[0];
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDIN_FILENO);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  block_signals(attributes);
  const int error = posix_spawnp(&process_, "ffmpeg", &actions, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  if (error == 0) return;
  process_ = -1;
  fail("ffmpeg cannot be started: " + std::generic_category().message(error));
}

VideoWriter::~VideoWriter() {
  if (process_ < 0) return;
  wait();
  std::error_code ignored;
  std::filesystem::remove(part_, ignored);
}

void VideoWriter::add(const Image& image) {
  const std::uint8_t* bytes = image.rgba.data();
  std::size_t left = image.rgba.size();
  while (left > 0) {
    const ssize_t sent = send(to_ffmpeg_, bytes, left, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0) fail("ffmpeg exited early");
    bytes += sent;
    left -= static_cast<std::size_t>(sent);
  }
}

void VideoWriter::finish() {
  const int status = wait();
  if (status != 0) fail("ffmpeg exited with status " + std::to_string(status));
  std::error_code error;
  std::filesystem::rename(part_, file_, error);
  if (error) fail(error.message());
}

/// Closes ffmpeg's input, and returns its exit status.
int VideoWriter::wait() {
  if (to_ffmpeg_ >= 0) close(to_ffmpeg_);
  to_ffmpeg_ = -1;
  int status = 0;
  while (process_ >= 0 && waitpid(process_, &status, 0) < 0 && errno == EINTR) {
  }
  process_ = -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

void VideoWriter::fail(const std::string& reason) {
  wait();
  std::error_code ignored;
  std::filesystem::remove(part_, ignored);
  throw InputError(file_.string() + " cannot be written: " + reason);
}

}  // namespace weft::engine
