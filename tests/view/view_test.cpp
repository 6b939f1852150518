/// `weft view` under real input: mouse and keys on a separate screen (Xvfb, xdotool), checked by the window's
/// report and by a picture of it. Waits for states, never for times: machines may be slow. Exit code 77 if
/// Xvfb or xdotool is missing.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "tests/view/drop_source.h"
#include "tests/view/input_delay.h"
#include "weft/render/camera.h"
#include "weft/render/image.h"

namespace weft::engine {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr PictureSize kSize = {760, 480};
constexpr int kPatience = 60;  // [s]; only failures take this long

bool is_program(const std::string& name) {
  return std::system(("command -v " + name + " > /dev/null 2>&1").c_str()) == 0;
}

void pause_for(int ms) { std::this_thread::sleep_for(std::chrono::milliseconds(ms)); }

/// A running program, terminated by the destructor.
class Program {
 public:
  /// `open`: a file descriptor that it may keep.
  explicit Program(const std::vector<std::string>& words, int open = -1,
                   const std::string& err = "/dev/null") {
    process_ = fork();
    if (process_ != 0) return;
    if (open >= 0) fcntl(open, F_SETFD, 0);
    const int log = ::open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    dup2(log, 1);
    dup2(log, 2);
    std::vector<char*> arguments;
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    execvp(arguments[0], arguments.data());
    _exit(127);
  }

  ~Program() {
    if (has_ended()) return;
    kill(process_, SIGTERM);
    waitpid(process_, nullptr, 0);
  }

  bool has_ended() {
    int status = 0;
    if (process_ < 0 || waitpid(process_, &status, WNOHANG) != process_) return process_ < 0;
    process_ = -1;
    exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return true;
  }

  int exit_code() const { return exit_code_; }

 private:
  pid_t process_ = -1;
  int exit_code_ = -1;
};

/// An invisible screen for all tests.
class Screen : public testing::Environment {
 public:
  void SetUp() override {
    int ends[2];
    ASSERT_EQ(pipe2(ends, O_CLOEXEC), 0);
    // -noreset: otherwise the server restarts, and refuses connections, after the last window closes.
    server_ = std::make_unique<Program>(
        std::vector<std::string>{"Xvfb", "-displayfd", std::to_string(ends[1]), "-screen", "0", "1280x720x24",
                                 "-nolisten", "tcp", "-noreset"},
        ends[1]);
    close(ends[1]);
    std::string number;
    for (char c = 0; read(ends[0], &c, 1) == 1 && c != '\n';) number += c;
    close(ends[0]);
    ASSERT_FALSE(number.empty()) << "Xvfb does not start";
    setenv("DISPLAY", (":" + number).c_str(), 1);
    setenv("XDG_STATE_HOME", (fs::path(WEFT_OUTPUT_DIR) / "state").c_str(), 1);  // not the user's own files
    fs::remove_all(fs::path(WEFT_OUTPUT_DIR) / "state");
  }

  void TearDown() override { server_.reset(); }

 private:
  std::unique_ptr<Program> server_;
};

void xdotool(const std::string& words) { ASSERT_EQ(std::system(("xdotool " + words).c_str()), 0) << words; }

/// A window of `weft view`, with simulated input and its report.
class View : public testing::Test {
 protected:
  static void enter_folder() {
    const fs::path folder =
        fs::path(WEFT_OUTPUT_DIR) / testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(folder);
    fs::create_directories(folder);
    fs::current_path(folder);
  }

  void open(std::vector<std::string> more = {}, const PictureSize& size = kSize) {
    enter_folder();
    // Small, soft and cheap, so that it runs in real time on a busy machine.
    std::vector<std::string> words = {WEFT_PROGRAM,
                                      "view",
                                      "paper/fig6_ball",
                                      "--report",
                                      "view.json",
                                      "--size",
                                      std::to_string(size.width) + "x" + std::to_string(size.height),
                                      "--set",
                                      "cloth[0].grid.cells=[12, 12]",
                                      "--set",
                                      "solver.steps_per_frame=6",
                                      "--set",
                                      "solver.integrator=paper_fixed"};
    words.insert(words.end(), more.begin(), more.end());
    start(words, "wind x");
  }

  /// The frames of a run of 0.2 s.
  void open_run() {
    enter_folder();
    const int status = std::system("'" WEFT_PROGRAM
                                   "' run paper/fig6_ball --set 'cloth[0].grid.cells=[12, 12]' --frames 12 "
                                   "--out run > words.txt 2>&1");
    ASSERT_EQ(WEXITSTATUS(status), 0) << words();
    start({WEFT_PROGRAM, "view", "run", "--report", "view.json", "--size", "760x480"}, "frame");
  }

  /// `control`: one that the window has.
  void start(const std::vector<std::string>& words, const std::string& control) {
    program_ = std::make_unique<Program>(words, -1, "words.txt");
    // Keys go to the window under the mouse: there is no window manager.
    xdotool("mousemove 700 440");
    until("the window is there", [&](const Json& j) { return j["controls"].contains(control); });
  }

  /// Presses F12 until the window reports a wanted state.
  Json until(const std::string& what, const std::function<bool(const Json&)>& is_wanted) {
    const auto start = std::chrono::steady_clock::now();
    Json state;
    while (std::chrono::steady_clock::now() - start < std::chrono::seconds(kPatience)) {
      if (program_->has_ended()) {
        ADD_FAILURE() << "the program has ended before " << what << ": " << words();
        return state;
      }
      if (std::system("xdotool key F12 2> /dev/null") != 0) break;
      pause_for(30);
      std::ifstream in("view.json");
      const Json now = Json::parse(in, nullptr, false);
      if (now.is_discarded()) continue;
      state = now;
      if (is_wanted(state)) return state;
    }
    ADD_FAILURE() << "waited in vain until " << what << "; the last state is " << state.dump(1);
    return state;
  }

  /// State after all previous input has been processed and drawn.
  Json state() {
    std::int64_t first = -1;
    return until("pictures are drawn", [&](const Json& j) {
      if (first < 0) first = j["drawn_frames"];
      return j["drawn_frames"] > first + 2;
    });
  }

  Json paused() {
    if (state()["playing"]) xdotool("key space");
    return until("it is paused", [](const Json& j) { return !j["sides"][0]["playing"]; });
  }

  void drag(const std::string& button, int x, int y, int to_x, int to_y) {
    move(x, y);
    xdotool("mousedown " + button);
    state();
    move((x + to_x) / 2, (y + to_y) / 2);
    move(to_x, to_y);
    state();
    xdotool("mouseup " + button);
  }

  /// The middle of a control.
  static void move_to(const Json& state, const std::string& control) {
    ASSERT_TRUE(state["controls"].contains(control)) << control;
    const Json& c = state["controls"][control];
    move((c[0].get<int>() + c[2].get<int>()) / 2, (c[1].get<int>() + c[3].get<int>()) / 2);
  }

  void click(const std::string& control) {
    move_to(state(), control);
    state();
    xdotool("mousedown 1");
    state();
    xdotool("mouseup 1");
    state();
  }

  static void move(int x, int y) { xdotool("mousemove " + std::to_string(x) + " " + std::to_string(y)); }

  /// `discards`: the scene was changed, so that the window asks first.
  void close_by(const std::string& key, bool discards = false) {
    xdotool("key " + key);
    if (discards) {
      until("it asks", [](const Json& j) { return j["asking"] == true; });
      xdotool("key d");
    }
    const auto start = std::chrono::steady_clock::now();
    while (!program_->has_ended() &&
           std::chrono::steady_clock::now() - start < std::chrono::seconds(kPatience))
      pause_for(10);
    EXPECT_EQ(program_->exit_code(), 0) << words();
  }

  static std::string words() {
    std::ifstream in("words.txt");
    return {std::istreambuf_iterator<char>(in), {}};
  }

  static Vec3 vector(const Json& j) { return {j[0].get<double>(), j[1].get<double>(), j[2].get<double>()}; }

  static Camera camera(const Json& state) {
    const Json& c = state["camera"];
    return {.target = vector(c["target"]),
            .distance = c["distance"],
            .azimuth_deg = c["azimuth"],
            .elevation_deg = c["elevation"]};
  }

  /// Position of a point in the window.
  static Eigen::Vector2i pixel(const Camera& camera, const Vec3& p) {
    const Eigen::Vector4d clip =
        Camera::projection(camera.fov_deg, kSize.aspect(), 0.1, 100) * camera.view() * p.homogeneous();
    return {static_cast<int>((1 + clip.x() / clip.w()) / 2 * kSize.width),
            static_cast<int>((1 - clip.y() / clip.w()) / 2 * kSize.height)};
  }

  std::unique_ptr<Program> program_;
};

TEST_F(View, TurnsMovesAndZooms) {
  open();
  const Json start = paused();
  // On empty space: the lower right corner, below the cloth.
  drag("1", 700, 440, 600, 400);
  const Json turned = until("the view has turned", [&](const Json& j) {
    return j["camera"]["azimuth"] != start["camera"]["azimuth"] &&
           j["camera"]["elevation"] != start["camera"]["elevation"];
  });
  EXPECT_EQ(turned["camera"]["target"], start["camera"]["target"]);
  EXPECT_TRUE(turned["sides"][0]["held"].is_null());
  drag("3", 600, 400, 640, 400);
  EXPECT_NE(state()["camera"]["azimuth"], turned["camera"]["azimuth"]) << "the right button turns as well";
  xdotool("keydown shift");
  drag("1", 700, 440, 660, 420);
  xdotool("keyup shift");
  const Json moved = until("the view has moved",
                           [&](const Json& j) { return j["camera"]["target"] != start["camera"]["target"]; });
  xdotool("click 4");
  until("the view is nearer", [&](const Json& j) {
    return j["camera"]["distance"].get<double>() < 0.95 * moved["camera"]["distance"].get<double>();
  });
  xdotool("key c");
  until("the view is as at the start", [&](const Json& j) { return j["camera"] == start["camera"]; });
  EXPECT_EQ(state()["sides"][0]["steps"], start["sides"][0]["steps"]) << "nothing has moved but the eye";
  close_by("q");
}

TEST_F(View, ShowsEveryTurnOfTheView) {
  open({}, {1280, 720});
  paused();
  move(640, 400);
  xdotool("mousedown 3");
  std::vector<double> ms = measure_input_delays(20, 640, 400);
  xdotool("mouseup 3");
  ASSERT_EQ(ms.size(), 20u);
  std::ranges::sort(ms);
  const Json now = state();
  std::printf(
      "input to picture: median %.0f ms, longest %.0f ms; a picture takes %.0f ms at quality level %d\n",
      ms[10], ms[19], now["ms_per_picture"].get<double>(), now["quality_level"].get<int>());
  close_by("q");
}

TEST_F(View, FitsAnySizeOfItsWindow) {
  open();
  paused();
  xdotool("search --sync --onlyvisible --name Weft windowsize 900 600");
  const Json large = until("the window is larger", [](const Json& j) { return j["size"] == Json{900, 600}; });
  EXPECT_EQ(large["controls"]["play"], state()["controls"]["play"]);
  xdotool("key p");
  const Json saved = until("the picture is saved", [](const Json& j) { return !j["pictures"].empty(); });
  EXPECT_EQ(read_png(saved["pictures"][0].get<std::string>()).width, 900);
  xdotool("search --onlyvisible --name Weft windowsize 320 240");
  until("it is smaller", [](const Json& j) { return j["size"] == Json{320, 240}; });
  xdotool("mousemove 200 200");
  close_by("q");
}

TEST_F(View, PausesStepsResetsAndSwitches) {
  open();
  until("it plays", [](const Json& j) { return j["sides"][0]["steps"] > 12; });
  const Json before = paused();
  const std::int64_t steps = before["sides"][0]["steps"];
  EXPECT_EQ(state()["sides"][0]["steps"], steps) << "paused";
  const auto has_steps = [](std::int64_t n) {
    return [n](const Json& j) { return j["sides"][0]["steps"] == n; };
  };
  xdotool("key period");
  until("there is one more step", has_steps(steps + 1));
  xdotool("key s");
  until("there are two more steps", has_steps(steps + 2));
  xdotool("key Right");
  until("it is at the end of the frame", has_steps((steps + 2) / 6 * 6 + 6));
  xdotool("key i");
  until("the next integrator is in use",
        [](const Json& j) { return j["sides"][0]["integrator"] == "desbrun"; });
  xdotool("key shift+i");
  until("it is the first one again",
        [](const Json& j) { return j["sides"][0]["integrator"] == "paper_fixed"; });
  xdotool("key m");
  until("other springs are in use", [](const Json& j) { return j["sides"][0]["model"] == "alternating"; });
  xdotool("key g");
  until("springs are shown", [](const Json& j) { return j["view"] == "springs"; });
  xdotool("key r");
  until("it is at the start", has_steps(0));
  EXPECT_EQ(state()["sides"][0]["time"], 0);
  xdotool("key space");
  until("it plays again", [](const Json& j) { return j["sides"][0]["steps"] > 0; });
  close_by("Escape", true);
  std::ifstream in("view.json");
  EXPECT_GT(Json::parse(in)["drawn_frames"], 0) << "the report is written at the end";
}

TEST_F(View, GrabsClothPullsItUpAndLetsItGo) {
  open();
  const Json near = paused();
  xdotool("click --repeat 5 5");  // for space above the cloth
  xdotool("key r");
  const Json start = until("it is at the start, farther away", [&](const Json& j) {
    return j["sides"][0]["steps"] == 0 &&
           j["camera"]["distance"].get<double>() > 1.8 * near["camera"]["distance"].get<double>();
  });
  const Vec3 center = vector(start["sides"][0]["center"]);
  const Eigen::Vector2i at = pixel(camera(start), center);
  move(at.x(), at.y());
  xdotool("mousedown 1");
  const Json held = until("cloth is held", [](const Json& j) { return !j["sides"][0]["held"].is_null(); });
  // A pixel is 5 mm, and three times that along the cloth, viewed from 20 degrees above.
  EXPECT_LT((vector(held["sides"][0]["held"]) - center).norm(), 0.04);
  EXPECT_EQ(held["camera"], start["camera"]) << "a grab does not turn the view";
  xdotool("key space");
  const Eigen::Vector2i up = pixel(camera(start), center + Vec3(0, 0.35, 0));
  move(up.x(), (at.y() + up.y()) / 2);
  move(up.x(), up.y());
  until("the hand is up", [&](const Json& j) {
    return j["sides"][0]["held"][1] > center.y() + 0.25 && j["sides"][0]["time"] > 1.5;
  });
  xdotool("mouseup 1");
  until("it is let go", [](const Json& j) { return j["sides"][0]["held"].is_null() && !j["grabbing"]; });
  until("it falls", [&](const Json& j) { return j["sides"][0]["center"][1] < center.y() - 0.15; });
  close_by("q");
}

TEST_F(View, WindOfTheSliderBlowsClothAway) {
  open();
  const Json start = paused();
  const Json& slider = start["controls"]["wind x"];
  const int left = slider[0], right = slider[2], y = (slider[1].get<int>() + slider[3].get<int>()) / 2;
  drag("1", left + (right - left) / 4, y, left + 10, y);
  xdotool("key period");
  const Json blown = until("the wind blows", [](const Json& j) {
    return j["sides"][0]["wind"]["velocity"][0] < 0 && j["sides"][0]["wind"]["drag"] > 0;
  });
  EXPECT_EQ(blown["camera"], start["camera"]) << "the slider has the mouse, the view has not";
  xdotool("key space");
  until("the cloth is blown to the left", [&](const Json& j) {
    return j["sides"][0]["center"][0] < start["sides"][0]["center"][0].get<double>() - 0.05;
  });
  close_by("q", true);
}

TEST_F(View, ComparesTwoIntegratorsAndSavesThePicture) {
  open({"--compare", "paper,paper_fixed"});
  const Json state = paused();
  ASSERT_EQ(state["sides"].size(), 2u);
  EXPECT_EQ(state["sides"][0]["integrator"], "paper");
  EXPECT_EQ(state["sides"][1]["integrator"], "paper_fixed");
  xdotool("key h");
  until("help is shown", [](const Json& j) { return j["help"] == true; });
  xdotool("key h");
  until("help is away", [](const Json& j) { return j["help"] == false; });
  xdotool("key p");
  const Json saved = until("the picture is saved", [](const Json& j) { return !j["pictures"].empty(); });
  const Image image = read_png(saved["pictures"][0].get<std::string>());
  ASSERT_EQ(image.width, kSize.width);
  ASSERT_EQ(image.height, kSize.height);
  // Both halves show red cloth and other colours.
  for (const int half : {0, 1}) {
    int red = 0, other = 0;
    for (int y = 0; y < image.height; ++y) {
      for (int x = half * kSize.width / 2; x < (half + 1) * kSize.width / 2; ++x) {
        const std::uint8_t* p = image.pixel(x, y);
        ++(p[0] > p[1] + 40 && p[0] > p[2] + 40 ? red : other);
      }
    }
    EXPECT_GT(red, 1000) << "half " << half;
    EXPECT_GT(other, 1000) << "half " << half;
  }
  close_by("q");
}

TEST_F(View, PlaysARunBack) {
  open_run();
  const Json first = state();
  EXPECT_EQ(first["sides"][0]["frames"], 13);
  EXPECT_EQ(first["controls"].contains("wind x"), false);
  EXPECT_EQ(first["controls"].contains("integrator 0"), false);
  until("another frame is shown",
        [&](const Json& j) { return j["sides"][0]["frame"] != first["sides"][0]["frame"]; });
  paused();
  const auto is_at = [](int frame) {
    return [frame](const Json& j) { return j["sides"][0]["frame"] == frame; };
  };
  xdotool("key r");
  const Json start = until("it is at the start", is_at(0));
  xdotool("key Right");
  until("the next frame is shown", is_at(1));
  xdotool("key s");
  until("the next frame is shown", is_at(2));
  xdotool("key Left");
  until("the frame before is shown", is_at(1));
  const Json& slider = start["controls"]["frame"];
  move(slider[2].get<int>() - 3, (slider[1].get<int>() + slider[3].get<int>()) / 2);
  xdotool("mousedown 1");
  const Json last = until("the last frame is shown", is_at(12));
  xdotool("mouseup 1");
  EXPECT_LT(last["sides"][0]["center"][1], start["sides"][0]["center"][1].get<double>() - 0.05)
      << "it has fallen";
  move(700, 440);
  xdotool("key l");
  until("it does not loop", [](const Json& j) { return j["sides"][0]["loops"] == false; });
  xdotool("key r");
  until("it is at the start again", is_at(0));
  xdotool("key space");
  until("it has stopped at the end",
        [&](const Json& j) { return j["sides"][0]["frame"] == 12 && j["playing"] == false; });
  const Json turned = state();
  const Eigen::Vector2i at = pixel(camera(turned), vector(turned["sides"][0]["center"]));
  move(at.x(), at.y());
  xdotool("click 3");
  until("it is read", [](const Json& j) { return !j["sides"][0]["instruments"]["probe"].is_null(); });
  xdotool("key 4");
  until("speed is shown", [](const Json& j) { return j["sides"][0]["instruments"]["largest_value"] > 0.3; });
  xdotool("key k");
  until("it is checked", [](const Json& j) { return j["sides"][0]["instruments"]["crossings"] == 0; });
  xdotool("key 1");
  drag("1", 380, 300, 420, 300);  // on cloth or beside it: there is nothing to grab
  EXPECT_NE(state()["camera"]["azimuth"], turned["camera"]["azimuth"]);
  xdotool("key 2");
  until("strain is shown", [](const Json& j) {
    return j["look"]["color"] == "strain" && j["sides"][0]["instruments"]["no_color"] == "" &&
           j["sides"][0]["instruments"]["largest_value"] > 0;
  });
  xdotool("key 5");
  until("contact is refused", [](const Json& j) {
    return j["sides"][0]["instruments"]["no_color"].get<std::string>().starts_with("a run has no forces");
  });
  xdotool("key 1");
  xdotool("key i");
  xdotool("key f");
  xdotool("key w");
  xdotool("key x");
  xdotool("key t");
  const Json plots =
      until("plots are shown", [](const Json& j) { return j["controls"].contains("plot energy"); });
  EXPECT_TRUE(plots["controls"].contains("plot largest strain"));
  EXPECT_TRUE(plots["controls"].contains("plot iterations"));
  EXPECT_FALSE(plots["controls"].contains("plot work per step"));
  EXPECT_EQ(plots["look"]["pins"], true);
  EXPECT_EQ(plots["look"]["contacts"], false);
  xdotool("key t");
  xdotool("key g");
  until("springs are shown", [](const Json& j) { return j["view"] == "springs"; });
  close_by("q");
}

TEST_F(View, OfARunRefusesWhatIsForScenes) {
  enter_folder();
  fs::create_directories("run");
  const auto refused = [](const std::string& rest, const std::string& sentence) {
    const int status = std::system(("'" WEFT_PROGRAM "' view " + rest + " > words.txt 2>&1").c_str());
    EXPECT_EQ(WEXITSTATUS(status), 2);
    EXPECT_NE(words().find(sentence), std::string::npos) << words();
  };
  refused("run", "run holds no run: there is no run.json");
  refused("run --compare paper,xpbd", "--compare does not apply to run: it is already simulated");
  refused("run --set scene.fps=3", "--set does not apply to run");
  refused("none.glb", "none.glb");
}

TEST_F(View, StartsWithAGalleryAndOpensWhatIsChosen) {
  enter_folder();
  start({WEFT_PROGRAM, "view", "--report", "view.json", "--size", "1280x720"}, "scene drape_sphere");
  EXPECT_EQ(state()["gallery"], true);
  click("scene drape_sphere");
  until("the scene is shown", [](const Json& j) { return j["scene"] == "drape_sphere" && !j["gallery"]; });
  xdotool("key ctrl+o");
  until("the gallery is back, with a recent file", [](const Json& j) {
    for (const auto& [name, place] : j["controls"].items()) {
      if (name.starts_with("recent ") && name.ends_with("drape_sphere.toml")) return j["gallery"] == true;
    }
    return false;
  });
  close_by("q");
}

TEST_F(View, TunesUndoesSavesAndAsksBeforeChangesAreLost) {
  open({}, {1280, 720});
  paused();
  xdotool("key n");
  const std::string key = "cloth[0].fabric.spring_structural";
  until("numbers are shown", [&](const Json& j) { return j["controls"].contains(key); });
  const Json before = state();  // the panel has its place from its second frame on
  const double usual = before["tuned"][key];
  const std::int64_t steps = before["sides"][0]["steps"];
  const Json& place = before["controls"][key];
  const int x = place[0].get<int>() + 20, y = (place[1].get<int>() + place[3].get<int>()) / 2;
  drag("1", x, y, x + 60, y);
  const Json tuned = until("it is stiffer", [&](const Json& j) { return j["tuned"][key] > 1.2 * usual; });
  EXPECT_EQ(tuned["changed"], true);
  EXPECT_EQ(tuned["sides"][0]["steps"], steps) << "without a restart";
  move(640, 600);
  xdotool("key ctrl+z");
  until("it is as before", [&](const Json& j) { return j["tuned"][key] == usual && j["changed"] == false; });
  xdotool("key ctrl+y");
  until("it is stiffer again", [&](const Json& j) { return j["tuned"][key] == tuned["tuned"][key]; });
  xdotool("key ctrl+o");
  until("it asks", [](const Json& j) { return j["asking"] == true; });
  xdotool("key Escape");
  move(640, 600);
  until("it goes on", [](const Json& j) { return j["asking"] == false && j["gallery"] == false; });
  xdotool("key ctrl+s");
  until("it is saved", [](const Json& j) { return j["changed"] == false; });
  close_by("q");
  const int status = std::system("'" WEFT_PROGRAM "' check fig6_ball_tuned.toml > check.txt 2>&1");
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

TEST_F(View, ShowsThePastAgain) {
  open();
  until("it plays", [](const Json& j) { return j["sides"][0]["steps"] > 40; });
  const Json now = paused();
  const Json& slider = now["controls"]["past"];
  move(slider[0].get<int>() + 3, (slider[1].get<int>() + slider[3].get<int>()) / 2);
  state();
  xdotool("mousedown 1");
  const Json first = until("the start is shown", [](const Json& j) { return j["sides"][0]["steps"] == 0; });
  xdotool("mouseup 1");
  EXPECT_EQ(first["sides"][0]["last_step"], now["sides"][0]["steps"]);
  EXPECT_EQ(first["sides"][0]["time"], 0);
  move(700, 440);
  xdotool("key period");
  const Json other = until("other steps follow", [](const Json& j) { return j["sides"][0]["steps"] == 1; });
  EXPECT_EQ(other["sides"][0]["last_step"], 1);
  close_by("q");
}

TEST_F(View, PinsAndUnpinsByClickAndByBox) {
  open();
  paused();
  xdotool("key r");
  const Json start = until("it is at the start", [](const Json& j) { return j["sides"][0]["steps"] == 0; });
  const Eigen::Vector2i at = pixel(camera(start), vector(start["sides"][0]["center"]));
  const auto has_pins = [](int count) {
    return [count](const Json& j) { return j["sides"][0]["instruments"]["pinned"] == count; };
  };
  const auto click_with = [&](const std::string& keys) {
    move(at.x(), at.y());
    for (const char* key : {"keydown", "keyup"}) {
      xdotool(std::string(key) + " " + keys);
      if (std::string(key) == "keydown") xdotool("click 1");
    }
  };
  click_with("ctrl");
  until("a particle is pinned", has_pins(1));
  click_with("ctrl");
  until("it is free again", has_pins(0));
  const auto select = [&](const std::string& keys) {
    xdotool("keydown " + keys);
    drag("1", 730, 470, 330, 20);  // beside the panel, from below the cloth
    xdotool("keyup " + keys);
  };
  select("ctrl");
  const Json boxed = until("the particles in the box are pinned",
                           [](const Json& j) { return j["sides"][0]["instruments"]["pinned"] > 20; });
  EXPECT_EQ(boxed["camera"], start["camera"]);
  EXPECT_EQ(boxed["look"]["pins"], true) << "pins are shown from the first one on";
  xdotool("keydown ctrl");
  select("shift");
  xdotool("keyup ctrl");
  until("they are free", has_pins(0));
  xdotool("key ctrl+z");
  until("they are pinned again", has_pins(boxed["sides"][0]["instruments"]["pinned"]));
  close_by("q", true);
}

TEST_F(View, ShowsColoursContactsReadingsAndTheChecker) {
  open();
  until("it lies on the ball", [](const Json& j) { return j["sides"][0]["time"] > 0.8; });
  paused();
  const auto instrument = [](const Json& j, const std::string& name) {
    return j["sides"][0]["instruments"][name];
  };
  xdotool("key 5");
  const Json pressed = until("the pressure of contacts is measured", [&](const Json& j) {
    return j["look"]["color"] == "contact" && j["controls"].contains("legend");
  });
  xdotool("key f");
  xdotool("key period");
  const Json touching =
      until("forces of contacts are shown", [&](const Json& j) { return instrument(j, "contacts") > 0; });
  EXPECT_GT(instrument(touching, "largest_value"), 0);
  EXPECT_GE(touching["scales"]["color"].get<double>(), instrument(touching, "largest_value").get<double>());
  for (const auto& [key, name] :
       {std::pair("2", "strain"), std::pair("3", "shear"), std::pair("4", "speed")}) {
    xdotool(std::string("key ") + key);
    until("the colour is another", [&](const Json& j) { return j["look"]["color"] == name; });
  }
  const Eigen::Vector2i at = pixel(camera(pressed), vector(pressed["sides"][0]["center"]) + Vec3(0, 0.1, 0));
  move(at.x(), at.y());
  xdotool("click 3");
  const Json probed = until("it is read", [&](const Json& j) { return !instrument(j, "probe").is_null(); });
  EXPECT_EQ(probed["camera"], pressed["camera"]) << "a click does not turn the view";
  xdotool("key k");
  until("the checker has checked", [&](const Json& j) { return instrument(j, "crossings") == 0; });
  xdotool("key 1");
  until("the fabric is back",
        [](const Json& j) { return j["look"]["color"].is_null() && !j["controls"].contains("legend"); });
  close_by("q");
}

TEST_F(View, MovesThrowsAddsAndRemovesBodies) {
  open({"--set", "scene.gravity=[0, 0, 0]"}, {1280, 720});  // nothing falls on the ball
  paused();
  xdotool("key r");
  const Json start = until("it is at the start", [](const Json& j) { return j["sides"][0]["steps"] == 0; });
  const auto ball = [](const Json& j) { return vector(j["sides"][0]["instruments"]["bodies"][0]); };
  const Vec3 place = ball(start);
  const auto on_screen = [&](const Vec3& point) {
    const auto at = camera(start).pixel(point, {1280, 720});
    return Eigen::Vector2i(static_cast<int>(at->x()), static_cast<int>(at->y()));
  };
  const Eigen::Vector2i at = on_screen(place - Vec3(0, 0.1, 0));
  drag("1", at.x(), at.y(), at.x() + 90, at.y());
  const Json moved = until("the scene is changed", [](const Json& j) { return j["changed"] == true; });
  EXPECT_EQ(moved["touched"], "ball");
  EXPECT_EQ(moved["camera"], start["camera"]);
  EXPECT_LT((ball(moved) - place).norm(), 1e-6) << "it waits for the next step";
  EXPECT_EQ(moved["throwing"], false) << "nothing flies while it is paused";
  xdotool("key Right");
  until("it glides", [&](const Json& j) { return (ball(j) - place).norm() > 0.02; });
  xdotool("key ctrl+z");
  until("it is not changed", [](const Json& j) { return j["changed"] == false; });
  xdotool("key space");
  until("it has gone back", [&](const Json& j) { return (ball(j) - place).norm() < 1e-3; });
  // A slow machine may see a throw as a move: until it flies.
  bool has_flown = false;
  for (int k = 0; k < 20 && !has_flown; ++k) {
    const Eigen::Vector2i now = on_screen(ball(state()) - Vec3(0, 0.1, 0));
    move(now.x(), now.y());
    xdotool("mousedown 1");
    until("the ball is held", [](const Json& j) { return j["touched"] == "ball"; });
    for (int step = 1; step <= 4; ++step) move(now.x() + 20 * step, now.y() - 10 * step);
    xdotool("mouseup 1");
    state();
    until("it has flown, or not", [](const Json& j) { return j["throwing"] == false; });
    state();
    has_flown = (ball(state()) - place).norm() > 1;
  }
  EXPECT_TRUE(has_flown) << "a body that does not fly stays where the hand left it, at 0.3 m";
  paused();
  xdotool("key Delete");
  until("there is no ball", [](const Json& j) { return j["bodies"].empty(); });
  xdotool("key n");
  until("numbers are shown", [](const Json& j) { return j["controls"].contains("+ capsule"); });
  click("+ capsule");
  until("there is a capsule", [](const Json& j) { return j["bodies"] == Json{"capsule"}; });
  move(640, 600);
  xdotool("key ctrl+z");
  until("there is none", [](const Json& j) { return j["bodies"].empty(); });
  close_by("q", true);
}

TEST_F(View, DrawsTheWindAsAnArrow) {
  open();
  paused();
  xdotool("key w");
  const Json shown =
      until("the arrow is there", [](const Json& j) { return j["controls"].contains("wind tip 0"); });
  const Json& tip = shown["controls"]["wind tip 0"];
  const int x = tip[0].get<int>() + 1, y = tip[1].get<int>() + 1;
  drag("1", x, y, x + 60, y);
  const Json blown = until(
      "the wind blows", [](const Json& j) { return vector(j["sides"][0]["wind"]["velocity"]).norm() > 1; });
  EXPECT_GT(vector(blown["sides"][0]["wind"]["velocity"]).dot(camera(blown).right()), 1) << "to the right";
  EXPECT_EQ(blown["camera"], shown["camera"]);
  close_by("q", true);
}

TEST_F(View, RecordsFramesByTheirNumbersAndAnAnimation) {
  enter_folder();
  start({WEFT_PROGRAM, "view", "drape_sphere", "--report", "view.json", "--size", "1280x720", "--set",
         "cloth[0].grid.cells=[12, 12]", "--set", "scene.duration=0.1"},
        "wind x");
  paused();
  xdotool("key r");
  xdotool("key v");
  until("the recorder is shown", [](const Json& j) { return j["controls"].contains("record file"); });
  const auto type = [&](const std::string& control, const std::string& words) {
    click(control);
    until("the field has the keyboard", [](const Json& j) { return j["typing"] == true; });
    xdotool("key ctrl+a");
    state();
    xdotool("type --delay 1 " + words);
    state();
    xdotool("key Return");
    until("the field is left", [](const Json& j) { return j["typing"] == false; });
    move(640, 600);
    state();
  };
  type("record file", "'f_##.png'");
  type("record size", "160x90");
  click("record");
  move(640, 600);
  const Json done = until("it is recorded", [](const Json& j) { return j["message"] == "written f_##.png"; });
  EXPECT_EQ(done["sides"][0]["frames"], 6);
  for (int frame = 0; frame <= 6; ++frame) {
    const Image image = read_png("f_0" + std::to_string(frame) + ".png");
    EXPECT_EQ(image.width, 160);
    EXPECT_EQ(image.height, 90);
  }
  EXPECT_FALSE(fs::exists("f_07.png"));
  // The command in its first lines draws the same.
  std::ifstream in("f_##.png.toml");
  std::string line, command;
  while (std::getline(in, line) && !line.empty()) {
    if (line.starts_with("#   weft ")) command = line.substr(9);
  }
  fs::rename("f_06.png", "recorded.png");
  ASSERT_EQ(std::system(("'" WEFT_PROGRAM "' " + command + " > drawn.txt 2>&1").c_str()), 0) << command;
  const Image ours = read_png("recorded.png"), theirs = read_png("f_06.png");
  double difference = 0;
  for (std::size_t k = 0; k < ours.rgba.size(); ++k) difference += std::abs(ours.rgba[k] - theirs.rgba[k]);
  EXPECT_LT(difference / static_cast<double>(ours.rgba.size()), 2);

  type("record file", "run.glb");
  click("record");
  move(640, 600);
  until("it is recorded", [](const Json& j) { return j["message"] == "written run.glb"; });
  EXPECT_EQ(std::system("'" WEFT_PROGRAM "' verify run.glb > verified.txt 2>&1"), 0);
  type("record file", "none.bmp");
  click("record");
  move(640, 600);
  until("it says what it records", [](const Json& j) {
    return j["message"].get<std::string>().find("record to a .mp4") == 0 && j["recording"].is_null();
  });
  xdotool("key r");
  until("it is at the start", [](const Json& j) { return j["sides"][0]["steps"] == 0; });
  close_by("q");
}

TEST_F(View, ARecordingIsCancelled) {
  open({"--set", "scene.duration=20"}, {1280, 720});
  xdotool("key v");
  until("the recorder is shown", [](const Json& j) { return j["controls"].contains("record"); });
  click("record");
  until("it records", [](const Json& j) { return j["recording"] > 0; });
  move(640, 600);
  xdotool("key space");
  until("it refuses to play", [](const Json& j) {
    return j["message"].get<std::string>().find("finish or cancel it first") != std::string::npos;
  });
  click("record cancel");
  until("it is cancelled", [](const Json& j) { return j["recording"].is_null(); });
  EXPECT_FALSE(fs::exists("fig6_ball.mp4"));
  close_by("q");
}

TEST_F(View, IsUsedByTheKeyboardAlone) {
  open();
  paused();
  xdotool("key r");
  until("it is at the start", [](const Json& j) { return j["sides"][0]["steps"] == 0; });
  const auto height = [](const Json& j) {
    return j["controls"]["play"][3].get<double>() - j["controls"]["play"][1].get<double>();
  };
  const double usual = height(state());
  xdotool("key ctrl+equal");
  until("the text is larger", [&](const Json& j) { return height(j) > 1.1 * usual; });
  xdotool("key ctrl+minus");
  until("the text is as before", [&](const Json& j) { return height(j) == usual; });
  xdotool("key F6");
  until("the keyboard is in the panel", [](const Json& j) { return j["navigating"] == true; });
  state();
  for (int press = 0; press < 2; ++press) {  // shows where it is, then goes from Play to Step
    xdotool("key Right");
    state();
  }
  xdotool("key space");
  const Json stepped =
      until("there is one more step", [](const Json& j) { return j["sides"][0]["steps"] == 1; });
  EXPECT_EQ(stepped["playing"], false) << "the space bar is the button's";
  xdotool("key Escape");
  until("it is out again", [](const Json& j) { return j["navigating"] == false; });
  xdotool("key space");
  until("it plays", [](const Json& j) { return j["playing"] == true; });
  close_by("q");
}

/// The panels, as docs/manual/view.md shows them: WEFT_VIEW_PICTURES=docs/images makes its pictures again.
TEST_F(View, ShowsItsPanels) {
  const char* folder = std::getenv("WEFT_VIEW_PICTURES");
  const fs::path pictures = folder ? fs::absolute(folder) : fs::path();
  enter_folder();
  start({WEFT_PROGRAM, "view", "fabrics/drape", "--report", "view.json", "--size", "1280x720"}, "wind x");
  const auto save = [&](const std::string& name) {
    const std::size_t before = state()["pictures"].size();
    xdotool("key p");
    const Json saved =
        until("the picture is saved", [&](const Json& j) { return j["pictures"].size() > before; });
    const Image image = read_png(saved["pictures"].back().get<std::string>());
    int dark = 0;
    for (std::size_t k = 0; k < image.rgba.size(); k += 4) dark += image.rgba[k] < 110;
    EXPECT_GT(dark, 2000) << "text and cloth";
    if (folder) write_image(pictures / ("view_" + name + ".jpg"), image);
  };
  until("cloth has fallen", [](const Json& j) { return j["sides"][0]["time"] > 0.9; });
  paused();
  xdotool("key n");
  xdotool("key t");
  until("numbers and plots are shown", [](const Json& j) { return j["controls"].contains("undo"); });
  save("numbers");
  xdotool("key n");
  xdotool("key t");
  xdotool("key 2");
  xdotool("key f");
  xdotool("key v");
  xdotool("key w");
  click("look");
  move(640, 330);
  xdotool("click 3");
  xdotool("key period");
  until("instruments are shown", [](const Json& j) {
    return j["controls"].contains("checker") && j["sides"][0]["instruments"]["contacts"] > 0;
  });
  save("instruments");
  xdotool("key h");
  save("help");
  close_by("q");
}

TEST_F(View, ComparesTwoFabrics) {
  open({"--set", "solver.integrator=newton", "--set", "solver.steps_per_frame=1", "--compare", "denim,silk"});
  until("they fall apart", [](const Json& j) {
    return j["sides"].size() == 2 && j["sides"][1]["time"] > 0.6 &&
           j["sides"][0]["center"] != j["sides"][1]["center"];
  });
  close_by("q");
  const int status =
      std::system("'" WEFT_PROGRAM "' view paper/fig6_ball --compare denim,slik > words.txt 2>&1");
  EXPECT_EQ(WEXITSTATUS(status), 2);
  EXPECT_NE(words().find("no integrator has the name \"slik\""), std::string::npos) << words();
}

TEST_F(View, OpensWhatIsDroppedOnIt) {
  enter_folder();
  std::ofstream("triangle.obj") << "v 0 1 0\nv 0.4 1 0\nv 0 1 0.4\nf 1 2 3\n";
  std::ofstream("broken.toml") << "[scene]\nformat = 1\nfsp = 60\n";
  ASSERT_EQ(
      WEXITSTATUS(std::system("'" WEFT_PROGRAM "' run paper/fig6_ball --set 'cloth[0].grid.cells=[12, 12]' "
                              "--frames 4 --out run > run.txt 2>&1")),
      0);
  start({WEFT_PROGRAM, "view", "--report", "view.json", "--size", "760x480"}, "path");
  const auto drop = [](const std::string& file) { return drop_file(fs::absolute(file).string(), 400, 300); };
  ASSERT_TRUE(drop(std::string(WEFT_SCENES) + "/flag.toml"));
  until("the scene is shown", [](const Json& j) { return j["scene"] == "flag" && j["gallery"] == false; });
  ASSERT_TRUE(drop("broken.toml"));
  const Json broken = until("its mistake is shown", [](const Json& j) {
    return j["message"].get<std::string>().find("fsp") != std::string::npos;
  });
  EXPECT_EQ(broken["scene"], "flag") << "what was there stays";
  ASSERT_TRUE(drop("triangle.obj"));
  until("the mesh is cloth", [](const Json& j) { return j["scene"] == "triangle"; });
  ASSERT_EQ(std::system("'" WEFT_PROGRAM "' fabrics denim > denim.toml"), 0);
  ASSERT_TRUE(drop("denim.toml"));
  until("it is denim", [](const Json& j) {
    return j["message"] == "fabric denim" && j["changed"] == true && j["scene"] == "triangle";
  });
  xdotool("key ctrl+z");
  until("it is as it came", [](const Json& j) { return j["changed"] == false; });
  ASSERT_TRUE(drop("run/animation.glb"));
  until("the run is shown", [](const Json& j) { return j["sides"][0].contains("loops"); });
  close_by("q");
}

TEST_F(View, SaysWhatToDoWhereThereIsNoDisplay) {
  fs::create_directories(WEFT_OUTPUT_DIR);
  fs::current_path(WEFT_OUTPUT_DIR);
  const int status = std::system("env -u DISPLAY -u WAYLAND_DISPLAY '" WEFT_PROGRAM
                                 "' view paper/fig6_ball > words.txt 2>&1");
  EXPECT_EQ(WEXITSTATUS(status), 1);
  EXPECT_NE(words().find("no display"), std::string::npos) << words();
  EXPECT_NE(words().find("weft render"), std::string::npos) << words();
}

}  // namespace
}  // namespace weft::engine

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  for (const char* name : {"Xvfb", "xdotool"}) {
    if (weft::engine::is_program(name)) continue;
    std::printf("skipped: there is no %s\n", name);
    return 77;
  }
  testing::AddGlobalTestEnvironment(new weft::engine::Screen);
  return RUN_ALL_TESTS();
}
