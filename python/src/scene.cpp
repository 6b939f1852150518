/// Scene files, runs and mesh files.

#include <nanobind/stl/unique_ptr.h>

#include "locked_world.h"
#include "weft/io.h"
#include "weft/run.h"

namespace weft::python {
namespace {

/// The Python class SceneError gets the mistakes as the attribute `diagnostics`.
void bind_errors(nb::module_& m) {
  nb::class_<Diagnostic> mistake(m, "Diagnostic");
  mistake.attr("__doc__") = "One mistake in a scene.";
  mistake.def_ro("file", &Diagnostic::file, "Of a changed value: \"--set path.to.key\"")
      .def_ro("line", &Diagnostic::line, "From 1; 0: not in a file")
      .def_ro("column", &Diagnostic::column, "From 1; 0: not in a file")
      .def_ro("message", &Diagnostic::message, "A sentence")
      .def("__str__", &Diagnostic::to_string)
      .def("__repr__", [](const Diagnostic& d) { return "Diagnostic(\"" + d.to_string() + "\")"; });
  static PyObject* const error = PyErr_NewExceptionWithDoc(
      "weft._core.SceneError",
      "A scene with mistakes; `diagnostics` has file, line, column and message of each.",
      m.attr("InputError").ptr(), nullptr);
  m.attr("SceneError") = nb::borrow(error);
  nb::register_exception_translator([](const std::exception_ptr& thrown, void*) {
    try {
      std::rethrow_exception(thrown);
    } catch (const SceneError& e) {
      nb::object instance = nb::borrow(error)(e.what());
      instance.attr("diagnostics") = nb::cast(e.diagnostics());
      PyErr_SetObject(error, instance.ptr());
    }
  });
}

void bind_scene_class(nb::module_& m) {
  nb::class_<Scene>(m, "Scene")
      .def_static("load", [](const std::string& name) { return Scene::load(name); })
      .def_static("parse",
                  [](const std::string& text, const std::string& file) { return Scene::parse(text, file); })
      .def("set", &Scene::set)
      .def("to_json", &Scene::to_json)
      .def("write", &Scene::write)
      .def_prop_ro("name", &Scene::name)
      .def_prop_ro("frames_per_second", &Scene::frames_per_second)
      .def_prop_ro("steps_per_frame", &Scene::steps_per_frame)
      .def_prop_ro("num_frames", &Scene::num_frames)
      .def_prop_ro("step", &Scene::step)
      .def("copy", [](const Scene& scene) { return scene; })
      .def(
          "build",
          [](const Scene& scene) {
            std::optional<LoadedScene> loaded;
            {
              const nb::gil_scoped_release release;
              loaded.emplace(build_scene(scene));
            }
            return nb::make_tuple(std::make_unique<LockedWorld>(std::move(loaded->world)), loaded->warnings);
          },
          nb::sig("def build(self) -> tuple[World, list[str]]"));
  m.def("scene_names", scene_names, "Names of the shipped scenes, sorted.");
}

nb::dict run_scene(const Scene& scene, std::optional<int> frames, int threads, bool audit,
                   bool check_passages, const std::string& folder, bool glb, bool obj,
                   const std::string& start_from, const std::string& unfinished,
                   std::optional<int> checkpoint_every, nb::object on_frame) {
  std::optional<nb::python_error> raised;  // ends the run, which keeps its frames, and is thrown then
  RunOptions options{.frames = frames,
                     .threads = threads,
                     .audit = audit,
                     .check_passages = check_passages,
                     .folder = folder,
                     .pc2 = true,
                     .glb = glb,
                     .obj = obj,
                     .start_from = start_from,
                     .unfinished = value_of<Unfinished>(unfinished),
                     .checkpoint_every = checkpoint_every};
  options.keep_going = [&] {
    const nb::gil_scoped_acquire hold;
    if (PyErr_CheckSignals() != 0) raised.emplace();
    return !raised;
  };
  OnFrame tell;
  if (!on_frame.is_none())
    tell = [&](const Progress& progress) {
      const nb::gil_scoped_acquire hold;
      try {
        return !on_frame(progress.frame, progress.num_frames, progress.seconds_spent, progress.seconds_left)
                    .is(nb::handle(Py_False));
      } catch (nb::python_error& error) {
        raised.emplace(std::move(error));
        return false;
      }
    };
  std::optional<RunResult> result;
  {
    const nb::gil_scoped_release release;
    result.emplace(run(scene, options, tell));
  }
  if (raised) throw std::move(*raised);
  nb::dict values;
  values["report"] = result->report;
  values["failure"] = result->failure;
  values["problems"] = result->problems;
  values["files"] = result->files;
  return values;
}

void bind_meshes(nb::module_& m) {
  m.def(
      "read_obj",
      [](const std::string& file) {
        std::optional<MeshFromFile> read;
        {
          const nb::gil_scoped_release release;
          read.emplace(read_obj(file));
        }
        return nb::make_tuple(make_array(std::move(read->mesh.positions)),
                              make_array<int>(std::move(read->mesh.triangles), {3}),
                              make_array<double>(std::move(read->mesh.uv), {3, 2}));
      },
      nb::sig("def read_obj(file: str) -> tuple[NDArray[numpy.float64], NDArray[numpy.int32], "
              "NDArray[numpy.float64]]"));
  m.def("write_obj", [](const std::string& file, const Vectors& vertices, const Triangles& faces,
                        const std::optional<CornerUvs>& uv) {
    const TriangleMesh mesh = to_mesh(vertices, faces, uv);
    const nb::gil_scoped_release release;
    write_obj(file, mesh);
  });
}

}  // namespace

void bind_scene(nb::module_& m) {
  bind_errors(m);
  bind_scene_class(m);
  bind_meshes(m);
  m.def("run", run_scene, nb::arg("scene"), nb::arg("frames").none(), nb::arg("threads"), nb::arg("audit"),
        nb::arg("check_passages"), nb::arg("folder"), nb::arg("glb"), nb::arg("obj"), nb::arg("start_from"),
        nb::arg("unfinished"), nb::arg("checkpoint_every").none(), nb::arg("on_frame").none(),
        nb::sig("def run(scene: Scene, frames: int | None, threads: int, audit: bool, check_passages: bool, "
                "folder: str, "
                "glb: bool, obj: bool, start_from: str, unfinished: str, checkpoint_every: int | None, "
                "on_frame: collections.abc.Callable[[int, int, float, float], object] "
                "| None) -> dict[str, typing.Any]"));
}

}  // namespace weft::python
