#include "view_report.h"

#include <nlohmann/json.hpp>

#include "viewer.h"
#include "weft/core/staged_file.h"
#include "weft/scene/tunables.h"

namespace weft::engine::app {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

Json to_json(const std::vector<RunProblem>& problems) {
  Json json = Json::array();
  for (const RunProblem& problem : problems)
    json.push_back({{"code", to_string(problem.code)}, {"message", problem.message}});
  return json;
}

Json to_json(const LiveStatus& s, const Vec3& center) {
  return {{"integrator", s.integrator},
          {"model", s.model},
          {"playing", s.playing},
          {"steps", s.steps},
          {"frames", s.frames},
          {"time", s.time},
          {"wind", {{"velocity", to_json(s.wind.velocity)}, {"drag", s.wind.drag}}},
          {"held", s.held ? to_json(*s.held) : Json()},
          {"center", to_json(center)},
          {"ms_per_step", {{"p50", s.ms_per_step}, {"p95", s.ms_per_step_p95}}},
          {"steps_per_second", s.steps_per_second},
          {"simulated_per_second", s.simulated_per_second},
          {"too_heavy", s.too_heavy},
          {"failure", s.failure.empty() ? Json() : Json(s.failure)},
          {"first_step", s.first_step},
          {"last_step", s.last_step},
          {"speed", s.speed},
          {"keys_for_restart", s.keys_for_restart},
          {"problems", to_json(s.problems)},
          {"warnings", s.warnings}};
}

Json to_json(const ViewLook& look) {
  return {{"color", look.color ? Json(label_of(*look.color).word) : Json()},
          {"springs", look.springs},
          {"yarns", look.yarns},
          {"seams", look.seams},
          {"pins", look.pins},
          {"contacts", look.contacts},
          {"checker", look.checker}};
}

Json to_json(const std::vector<ColliderSceneDesc>& colliders) {
  Json names = Json::array();
  for (const ColliderSceneDesc& collider : colliders) names.push_back(collider.name);
  return names;
}

/// What its instruments show.
Json instruments(const ViewSide& side) {
  Json json = {{"largest_value", side.largest_value()},
               {"crossings", side.findings() ? Json(side.findings()->intersections) : Json()},
               {"no_color", side.no_color()}};
  for (std::size_t b = 0; b < side.meshes().bodies.size(); ++b)
    json["bodies"].push_back(to_json(side.box_of_body(static_cast<int>(b)).center()));
  const std::optional<ProbeReading> probe = side.probe();
  json["probe"] = probe ? Json(probe->particle) : Json();
  const LiveFrame* frame = side.measured();
  if (!frame) return json;
  json["pinned"] = frame->pins ? (*frame->pins)[0].particles.size() : 0;
  json["contacts"] = frame->contacts.size();
  json["yarns"] = frame->yarns.size();
  return json;
}

Json to_json(ViewSide& side) {
  if (side.status()) {
    Json json = to_json(*side.status(), side.center());
    json["instruments"] = instruments(side);
    return json;
  }
  const PlayHead& head = *side.head();
  return {{"playing", head.is_playing},
          {"loops", head.loops},
          {"frame", side.frame()},
          {"frames", side.num_frames()},
          {"time", side.frame() / head.frames_per_second},
          {"instruments", instruments(side)},
          {"center", to_json(side.center())}};
}

Json to_json(const Camera& c) {
  return {{"azimuth", c.azimuth_deg},
          {"elevation", c.elevation_deg},
          {"distance", c.distance},
          {"target", to_json(c.target)}};
}

/// Numbers that a person tunes, by their keys.
Json tuned(SceneDesc scene) {
  Json json = Json::object();
  for (const TunableGroup& group : list_tunables(scene)) {
    for (const Tunable& t : group.values) {
      if (const auto* number = std::get_if<double*>(&t.value)) json[t.key] = **number;
      if (const auto* whole = std::get_if<int*>(&t.value)) json[t.key] = **whole;
    }
  }
  for (std::size_t c = 0; c < scene.cloths.size(); ++c) {
    if (scene.cloths[c].fabric)
      json["cloth[" + std::to_string(c) + "].fabric"] = scene.cloths[c].fabric->name;
  }
  return json;
}

}  // namespace

void write_view_report(const std::filesystem::path& file, const Viewer& viewer) {
  Json json = {{"scene", viewer.shows_gallery() ? Json() : Json(viewer.side(0).title())},
               {"playing", viewer.is_playing()},
               {"view", viewer.look.springs ? "springs" : "cloth"},
               {"look", to_json(viewer.look)},
               {"scales", {{"color", viewer.scales().color}, {"force", viewer.scales().force}}},
               {"touched", viewer.hands().touched()},
               {"throwing", viewer.hands().is_throwing()},
               {"record_file", viewer.record_request.file},
               {"recording", viewer.recording() ? Json(viewer.recording()->drawn()) : Json()},
               {"bodies", viewer.edits() ? to_json(viewer.edits()->now().colliders) : Json::array()},
               {"help", viewer.shows_help()},
               {"gallery", viewer.shows_gallery()},
               {"message", viewer.message()},
               {"asking", viewer.is_asking()},
               {"navigating", viewer.window().is_navigating()},
               {"typing", viewer.window().is_typing()},
               {"changed", viewer.edits() && viewer.edits()->is_changed()},
               {"tuned", viewer.edits() ? tuned(viewer.edits()->now()) : Json::object()},
               {"grabbing", viewer.hands().is_grabbing()},
               {"camera", to_json(viewer.camera())},
               {"size", {viewer.window().size().width, viewer.window().size().height}},
               {"driver", viewer.window().driver()},
               {"software", viewer.window().is_software()},
               {"quality_level", viewer.quality_level()},
               {"drawn_frames", viewer.drawn_frames()},
               {"drawn_per_second", viewer.drawn_per_second()},
               {"ms_per_picture", viewer.picture_ms()},
               {"ms_per_panel", viewer.panel_ms()},
               {"pictures", viewer.pictures()},
               {"sides", Json::array()},
               {"controls", viewer.controls}};
  for (int s = 0; s < viewer.num_sides(); ++s) json["sides"].push_back(to_json(viewer.side(s)));
  write_file(file, json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

std::filesystem::path name_of_next_picture() {
  for (int number = 1;; ++number) {
    std::filesystem::path file = "weft-view-" + std::to_string(number) + ".png";
    if (!std::filesystem::exists(file)) return file;
  }
}

}  // namespace weft::engine::app
