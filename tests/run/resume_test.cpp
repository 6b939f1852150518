/// Runs that were killed go on from their last checkpoint, and end with the files of an unbroken run.

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "tests/message_of.h"
#include "tests/read_text.h"
#include "tests/run/shipped.h"
#include "weft/core/folder_lock.h"
#include "weft/core/staged_file.h"
#include "weft/io/pc2.h"
#include "weft/run/checkpoint.h"
#include "weft/run/run_folder.h"

namespace weft::engine {
namespace {

namespace fs = std::filesystem;

/// A report without what a clock says.
nlohmann::json without_times(const fs::path& file) {
  nlohmann::json report = nlohmann::json::parse(read_text(file));
  for (const char* key : {"ms_per_frame", "cpu_ms_per_frame", "untangle_seconds"}) report.erase(key);
  report["work"].erase("seconds");
  return report;
}

class Resume : public testing::Test {
 protected:
  void SetUp() override { fs::remove_all(folder_); }
  void TearDown() override { file_observer = nullptr; }

  /// A sheet that falls on a ball.
  static SceneDesc sheet(int cells) {
    return shipped("contact/rotating_ball",
                   {"cloth[0].grid.cells=[" + std::to_string(cells) + ", " + std::to_string(cells) + "]"});
  }

  RunOptions options(const char* name, Unfinished unfinished = Unfinished::refuse) const {
    return {.frames = 9,
            .audit = true,
            .folder = (folder_ / name).string(),
            .obj = true,
            .unfinished = unfinished,
            .checkpoint_every = 2};
  }

  /// Runs in a process of its own; true if it ended by itself.
  static bool run_apart(const std::function<void()>& body) {
    const pid_t child = fork();
    if (child == 0) {
      body();
      _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
  }

  /// Both folders have the same files with the same bytes, and the same report but for times.
  void expect_same(const char* a, const char* b) const {
    const std::map<std::string, std::string> files = contents(a), others = contents(b);
    for (const auto& [name, content] : files) {
      ASSERT_TRUE(others.contains(name)) << name;
      if (name != "report.json") {
        EXPECT_EQ(content == others.at(name), true) << name;
      }
    }
    EXPECT_EQ(files.size(), others.size());
    EXPECT_EQ(without_times(folder_ / a / "report.json"), without_times(folder_ / b / "report.json"));
  }

  std::map<std::string, std::string> contents(const char* name) const {
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / name)) {
      if (!entry.is_directory())
        files[entry.path().lexically_relative(folder_ / name).generic_string()] = read_text(entry.path());
    }
    return files;
  }

  const fs::path folder_ =
      fs::path(WEFT_OUTPUT_DIR) / testing::UnitTest::GetInstance()->current_test_info()->name();
};

TEST_F(Resume, AfterKillsAtFortyMomentsEndsWithTheBytesOfAnUnbrokenRun) {
  const SceneDesc scene = sheet(32);
  int num_events = 0;
  file_observer = [&](FileEvent, const fs::path&) { ++num_events; };
  run_to_folder(scene, options("whole"));
  file_observer = nullptr;
  constexpr int kKills = 40;
  ASSERT_GT(num_events, kKills);
  std::set<int> resumed_from, moments;
  for (int k = 0; k < kKills; ++k) moments.insert(num_events * k / kKills);
  for (int k = 1; k <= 12; ++k) moments.insert(num_events - k);  // while the results are put into place
  for (const int last : moments) {
    const bool has_ended = run_apart([&] {
      int events = 0;
      file_observer = [&](FileEvent, const fs::path&) {
        if (events++ == last) raise(SIGKILL);
      };
      run_to_folder(scene, options("broken"));
    });
    ASSERT_FALSE(has_ended);
    const fs::path unfinished = folder_ / "broken/unfinished";
    if (fs::exists(unfinished / "cloth.pc2") && fs::file_size(unfinished / "cloth.pc2") > 0) {
      EXPECT_NO_THROW(read_pc2(unfinished / "cloth.pc2"));
    }
    if (fs::exists(unfinished / kCheckpointName)) {
      resumed_from.insert(read_checkpoint(unfinished / kCheckpointName).frame);
      // A write that the system did not finish: bytes behind the checkpoint's length, of no frame.
      for (const char* name : {"cloth.pc2", "animation.frames"}) {
        if (fs::exists(unfinished / name)) std::ofstream(unfinished / name, std::ios::app) << "torn";
      }
    }
    run_to_folder(scene, options("broken", Unfinished::resume));
    expect_same("whole", "broken");
    ASSERT_FALSE(HasFailure()) << "killed at event " << last << " of " << num_events;
    fs::remove_all(folder_ / "broken");
  }
  EXPECT_GE(resumed_from.size(), 4u) << "from different checkpoints";
}

TEST_F(Resume, AfterAnInterruptionGoesOnToo) {
  const SceneDesc scene = sheet(8);
  run_to_folder(scene, options("whole"));
  const auto interrupted = [&](int frame, Unfinished unfinished) {
    const FinishedRun run =
        run_to_folder(scene, options("broken", unfinished), {},
                      [frame](const Progress& progress) { return progress.frame < frame; });
    EXPECT_EQ(run.report.outcome, RunOutcome::interrupted);
    EXPECT_EQ(read_pc2(folder_ / "broken/cloth.pc2").frames.size(), frame + 1u);
  };
  interrupted(3, Unfinished::refuse);
  interrupted(2, Unfinished::refuse);  // its results are complete: it may be run again
  interrupted(5, Unfinished::resume);
  run_to_folder(scene, options("broken", Unfinished::resume));
  expect_same("whole", "broken");
  EXPECT_FALSE(fs::exists(folder_ / "broken/unfinished"));
}

TEST_F(Resume, IsRefusedForAnotherRunAndNothingIsOverwrittenUnasked) {
  const SceneDesc scene = sheet(8);
  const auto kill = [&] {
    run_apart([&] {
      run_to_folder(scene, options("broken"), {}, [](const Progress& progress) {
        if (progress.frame == 5) raise(SIGKILL);
        return true;
      });
    });
  };
  kill();
  const auto before = contents("broken");
  EXPECT_NE(message_of([&] {
              run_to_folder(scene, options("broken"));
            }).find("has an unfinished run, up to frame 4 of 9: resume it"),
            std::string::npos);
  const auto refused = [&](const SceneDesc& other, const RunOptions& with) {
    return message_of([&] { run_to_folder(other, with); });
  };
  SceneDesc stiffer = scene;
  stiffer.solver.integrator = "xpbd";
  const RunOptions resume = options("broken", Unfinished::resume);
  EXPECT_NE(
      refused(stiffer, resume).find("[solver] integrator = \"newton\" there, integrator = \"xpbd\" here"),
      std::string::npos)
      << refused(stiffer, resume);
  RunOptions longer = resume;
  longer.frames = 10;
  EXPECT_NE(refused(scene, longer).find("frames = 9 there, frames = 10 here"), std::string::npos);
  EXPECT_EQ(contents("broken"), before) << "a refusal changes nothing";

  const UnfinishedRun own = read_unfinished_run(folder_ / "broken");
  run_to_folder(scene, options("whole"));
  run_to_folder(own.scene, own.options);
  expect_same("whole", "broken");
  EXPECT_NE(message_of([&] { read_unfinished_run(folder_ / "broken"); }).find("has no unfinished run"),
            std::string::npos);

  kill();
  run_to_folder(scene, options("broken", Unfinished::discard));
  expect_same("whole", "broken");
}

TEST_F(Resume, NoticesThatAMeshFileHasChanged) {
  fs::create_directories(folder_);
  const fs::path mesh = folder_ / "sheet.obj";
  std::ofstream(mesh) << "v 0 1 0\nv 1 1 0\nv 0 1 1\nf 1 3 2\n";
  SceneDesc scene = sheet(8);
  scene.cloths[0].shape = MeshSource{.file = mesh};
  run_apart([&] {
    run_to_folder(scene, options("broken"), {}, [](const Progress& progress) {
      if (progress.frame == 3) raise(SIGKILL);
      return true;
    });
  });
  std::ofstream(mesh, std::ios::app) << "v 1 1 1\n";
  const std::string said = message_of([&] { run_to_folder(scene, options("broken", Unfinished::resume)); });
  EXPECT_NE(said.find("[[cloth]] mesh = \"hash "), std::string::npos) << said;
}

/// The state that a run has started from is in its checkpoint: the old run is not needed any more.
TEST_F(Resume, OfARunThatStartedFromAFrameNeedsNoOldRun) {
  const SceneDesc scene = sheet(8);
  run_to_folder(scene, options("old"));
  const auto from = [&](const char* name, const char* frame, Unfinished unfinished = Unfinished::refuse) {
    RunOptions with = options(name, unfinished);
    with.start_from = (folder_ / "old").string() + frame;
    return with;
  };
  const auto kill = [&] {
    run_apart([&] {
      run_to_folder(scene, from("broken", "@4"), {}, [](const Progress& progress) {
        if (progress.frame == 5) raise(SIGKILL);
        return true;
      });
    });
  };
  run_to_folder(scene, from("whole", "@4"));
  kill();
  const auto refused = [&](const RunOptions& with) {
    return message_of([&] { run_to_folder(scene, with); });
  };
  const std::string old = (folder_ / "old").string();
  EXPECT_NE(refused(options("broken", Unfinished::resume))
                .find("start_from = \"" + old + "@4\" there, start_from = \"\" here"),
            std::string::npos);
  EXPECT_NE(
      refused(from("broken", "@5", Unfinished::resume)).find("@4\" there, start_from = \"" + old + "@5\""),
      std::string::npos);
  SceneDesc faster = scene;
  faster.gravity *= 1.5;
  run_to_folder(faster, options("old"));
  const std::string said = refused(from("broken", "@4", Unfinished::resume));
  EXPECT_NE(said.find(old + "@4 is another state now"), std::string::npos) << said;

  fs::remove_all(folder_ / "old");
  run_to_folder(scene, from("broken", "@4", Unfinished::resume));
  expect_same("whole", "broken");

  run_to_folder(scene, options("old"));
  fs::remove_all(folder_ / "broken");
  kill();
  fs::remove_all(folder_ / "old");
  const UnfinishedRun own = read_unfinished_run(folder_ / "broken");
  EXPECT_EQ(own.options.start_from, old + "@4");
  run_to_folder(own.scene, own.options);
  expect_same("whole", "broken");
}

TEST_F(Resume, OfADamagedCheckpointIsRefused) {
  const SceneDesc scene = sheet(4);
  run_apart([&] {
    run_to_folder(scene, options("broken"), {}, [](const Progress& progress) {
      if (progress.frame == 3) raise(SIGKILL);
      return true;
    });
  });
  const fs::path file = folder_ / "broken/unfinished" / kCheckpointName;
  const std::string good = read_text(file);
  for (const std::size_t at : {std::size_t{0}, std::size_t{4}, good.size() / 2, good.size() - 1}) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ 0x40);
    std::ofstream(file, std::ios::binary) << bad;
    const std::string said = message_of([&] { run_to_folder(scene, options("broken", Unfinished::resume)); });
    EXPECT_NE(said.find(file.string() + ": "), std::string::npos) << said;
  }
  std::ofstream(file, std::ios::binary) << good.substr(0, good.size() / 3);
  EXPECT_NE(message_of([&] { run_to_folder(scene, options("broken", Unfinished::resume)); }).find("damaged"),
            std::string::npos);
}

TEST_F(Resume, TwoRunsInOneFolderAreRefused) {
  const FolderLock lock(folder_ / "used/unfinished");
  const std::string said = message_of([&] { run_to_folder(sheet(4), options("used")); });
  EXPECT_NE(said.find("is in use: another run writes into it"), std::string::npos) << said;
}

TEST_F(Resume, IsPossibleAfterAFullDisk) {
  const SceneDesc scene = sheet(16);
  run_to_folder(scene, options("whole"));
  const std::uintmax_t room = fs::file_size(folder_ / "whole/cloth.pc2") / 2;
  const bool said_so = run_apart([&] {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{room, room};
    setrlimit(RLIMIT_FSIZE, &limit);
    const std::string said = message_of([&] { run_to_folder(scene, options("broken")); });
    if (said.find("cannot be written: File too large") == std::string::npos) _exit(1);
  });
  EXPECT_TRUE(said_so);
  run_to_folder(scene, options("broken", Unfinished::resume));
  expect_same("whole", "broken");
}

/// A checkpoint is renamed into place when everything that it counts on is on the disk, itself included.
TEST_F(Resume, CheckpointsComeAfterWhatTheyCountOn) {
  std::set<std::string> unsynced;
  int num_checkpoints = 0, num_after = 0;
  file_observer = [&](FileEvent event, const fs::path& path) {
    const std::string name = path.filename().string();
    if (event == FileEvent::flush) unsynced.insert(name);
    if (event == FileEvent::sync) unsynced.erase(name);
    if (event == FileEvent::rename && name == kCheckpointName) {
      EXPECT_TRUE(unsynced.empty()) << *unsynced.begin();
      ++num_checkpoints;
    }
    if (event == FileEvent::sync_folder) ++num_after;
  };
  run_to_folder(sheet(4), options("run"));
  EXPECT_EQ(num_checkpoints, 5) << "at the start and after every second frame";
  EXPECT_GE(num_after, num_checkpoints);
}

}  // namespace
}  // namespace weft::engine
