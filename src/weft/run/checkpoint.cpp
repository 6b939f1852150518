#include "weft/run/checkpoint.h"

#include <cstdint>
#include <span>
#include <sstream>
#include <string_view>

#include "weft/core/archive.h"
#include "weft/core/hash.h"
#include "weft/core/staged_file.h"
#include "weft/core/version.h"
#include "weft/io/input_file.h"
#include "weft/run/start_from.h"
#include "weft/scene/scene_writer.h"

namespace weft::engine {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kWhat = "a checkpoint";
constexpr std::uint32_t kMagic = 0x52464557;  // "WEFR"
constexpr std::size_t kChecksum = sizeof(std::uint64_t);

template <class Archive>
void describe(Archive& archive, Checkpoint& c) {
  members(archive, c.scene_name, c.description, c.frame, c.num_frames, c.check_passages, c.audit, c.pc2,
          c.glb, c.obj, c.start_from, c.start, c.run);
}

}  // namespace

std::string describe_run(const SceneDesc& scene, int num_frames, const RunOptions& options) {
  std::ostringstream text;
  text << std::boolalpha << "[run]\nweft = \"" << kVersion << "\"\nname = \"" << scene.name
       << "\"\nframes = " << num_frames << "\naudit = " << options.audit
       << "\ncheck_passages = " << options.check_passages << "\npc2 = " << options.pc2
       << "\nglb = " << options.glb << "\nobj = " << options.obj << "\nstart_from = \""
       << full_start_from(options) << "\"\n\n"
       << scene_text_with_hashes(scene);
  return text.str();
}

std::string full_start_from(const RunOptions& options) {
  return options.start_from.empty() ? "" : to_text(parse_start_from(options.start_from));
}

std::string find_difference(const std::string& there, const std::string& here) {
  std::istringstream a(there), b(here);
  std::string section, line_a, line_b;
  for (;;) {
    const bool has_a = static_cast<bool>(std::getline(a, line_a)),
               has_b = static_cast<bool>(std::getline(b, line_b));
    if (!has_a && !has_b) return "";
    if (has_a && has_b && line_a == line_b) {
      if (line_a.starts_with('[')) section = line_a + ' ';
      continue;
    }
    const auto shown = [](bool has, const std::string& line) {
      return has && !line.empty() ? line : "nothing";
    };
    return section + shown(has_a, line_a) + " there, " + shown(has_b, line_b) + " here";
  }
}

void write_checkpoint(const fs::path& file, Checkpoint checkpoint) {
  Writer out;
  std::string version = kVersion;
  out.plain(kMagic);
  describe(out, version);
  describe(out, checkpoint);
  out.plain(hash_of<std::byte>(out.bytes));
  write_file(file, {reinterpret_cast<const char*>(out.bytes.data()), out.bytes.size()});
  sync_folder(file.parent_path());
}

Checkpoint read_checkpoint(const fs::path& file) {
  const std::string text = read_bytes(file, kWhat);
  const std::span<const std::byte> bytes = std::as_bytes(std::span(text));
  try {
    Reader all(bytes, kWhat);
    if (bytes.size() < kChecksum) all.fail();
    Reader reader(bytes.first(bytes.size() - kChecksum), kWhat);
    std::uint32_t magic = 0;
    std::string version;
    reader.plain(magic);
    if (magic != kMagic) reader.fail();
    describe(reader, version);
    if (version != kVersion) throw InputError("a checkpoint of Weft " + version + "; this is " + kVersion);
    std::uint64_t sum = 0;
    Reader(bytes.last(kChecksum), kWhat).plain(sum);
    if (sum != hash_of<std::byte>(bytes.first(bytes.size() - kChecksum))) reader.fail();
    Checkpoint checkpoint;
    describe(reader, checkpoint);
    return checkpoint;
  } catch (const InputError& error) {
    throw InputError(file.string() + ": " + error.what());
  }
}

}  // namespace weft::engine
