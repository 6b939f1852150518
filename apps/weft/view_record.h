#pragma once
/// Recordings of the window: the picture, without the panels, at its own size and rate.

#include <memory>
#include <string>

#include "view_side.h"
#include "weft/io/glb_writer.h"
#include "weft/render/renderer.h"
#include "weft/render/video.h"

namespace weft::engine::app {

class Viewer;

struct RecordRequest {
  std::string file = "weft-view.mp4";  // .mp4, .webp, .gif; frame_####.png; .glb
  std::string size = "1280x720";       // of the picture
  int frames = 60;                     // of the scene to record, from the present one on [1]
  int every = 1;                       // of them in the recording [1]
};

/// Goes through the frames one by one, however long a picture takes. Beside the file is FILE.toml, the scene with
/// all changes. Its first lines have the command that draws the same. A recording that is destroyed before its
/// end leaves an earlier video or .glb as it was.
class Recording {
 public:
  /// Throws InputError for kinds of files and sizes that are not supported, and files that cannot be written.
  Recording(Viewer& viewer, const RecordRequest& request);
  ~Recording();

  /// Adds the frame that was asked for, when it is there, and asks for the next. Call after each update of the
  /// sides. Throws InputError if the file cannot be written.
  void advance(Renderer& renderer);

  void finish();  // with the frames so far
  bool is_done() const { return is_done_; }
  int drawn() const { return drawn_; }
  int wanted() const { return request_.frames / request_.every + 1; }
  const std::string& file() const { return request_.file; }

 private:
  bool is_there() const;
  bool has_failed() const;
  void ask_for_next();
  void add(Renderer& renderer);
  Image draw(Renderer& renderer) const;
  void write_parameters() const;
  std::string command() const;

  Viewer& viewer_;
  RecordRequest request_;
  PictureSize size_;
  std::vector<std::int64_t>
      asked_from_;  // (num_sides) steps or frame of each side, when a frame was asked for
  int frame_ = 0, drawn_ = 0;
  bool is_done_ = false;
  std::unique_ptr<VideoWriter> video_;
  std::unique_ptr<StagedFile> glb_file_;
  std::unique_ptr<GlbWriter> glb_;
};

}  // namespace weft::engine::app
