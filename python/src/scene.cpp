/// Scene files, runs, mesh files and point caches.

#include <nanobind/stl/array.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/unique_ptr.h>

#include "locked_world.h"
#include "weft/io.h"
#include "weft/mesh.h"
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

/// Sizes, corners, texture coordinates of the corners, groups as (name, is an object, faces), and lines.
nb::tuple polygon_arrays(MeshFaces&& faces) {
  nb::list groups;
  for (MeshGroup& group : faces.groups)
    groups.append(nb::make_tuple(group.name, group.is_object, make_array<int>(std::move(group.faces), {})));
  return nb::make_tuple(
      make_array<int>(std::move(faces.sizes), {}), make_array<int>(std::move(faces.corners), {}),
      make_array<double>(std::move(faces.uv), {2}), groups, make_array<int>(std::move(faces.lines), {2}));
}

using Uvs = nb::ndarray<const double, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;
using Groups = std::vector<std::tuple<std::string, bool, Indices>>;
using Lines = nb::ndarray<const int, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu>;

MeshFaces to_faces(const Indices& sizes, const Indices& corners, const std::optional<Uvs>& uv,
                   const Groups& groups, const Lines& lines) {
  MeshFaces faces{.sizes = to_indices(sizes), .corners = to_indices(corners)};
  for (std::size_t c = 0; uv && c < uv->shape(0); ++c)
    faces.uv.push_back({uv->data()[2 * c], uv->data()[2 * c + 1]});
  for (const auto& [name, is_object, of] : groups) faces.groups.push_back({name, is_object, to_indices(of)});
  for (std::size_t k = 0; k < lines.shape(0); ++k) faces.lines.push_back({lines(k, 0), lines(k, 1)});
  return faces;
}

using Floats = nb::ndarray<const float, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;

std::span<const float> to_span(const Floats& array) { return {array.data(), array.size()}; }

nb::ndarray<nb::numpy, float> to_rows(std::vector<float>&& numbers) {
  auto* own = new std::vector<float>(std::move(numbers));
  nb::capsule owner(own, [](void* p) noexcept { delete static_cast<std::vector<float>*>(p); });
  return nb::ndarray<nb::numpy, float>(own->data(), {own->size() / 3, 3}, owner);
}

/// Vertices, triangles, texture coordinates of their corners, the file's polygons, and warnings.
template <auto kRead>
nb::tuple read_arrays(const std::string& file) {
  std::optional<MeshFromFile> read;
  {
    const nb::gil_scoped_release release;
    read.emplace(kRead(file));
  }
  return nb::make_tuple(make_array(std::move(read->mesh.positions)),
                        make_array<int>(std::move(read->mesh.triangles), {3}),
                        make_array<double>(std::move(read->mesh.uv), {3, 2}),
                        polygon_arrays(std::move(read->faces)), std::move(read->warnings));
}

using WriteMesh = void (*)(const std::string&, const TriangleMesh&);
using WritePolygons = void (*)(const std::string&, const std::vector<Vec3>&, const MeshFaces&);

template <WriteMesh kWrite>
void write_arrays(const std::string& file, const Vectors& vertices, const Triangles& faces,
                  const std::optional<CornerUvs>& uv) {
  const TriangleMesh mesh = to_mesh(vertices, faces, uv);
  const nb::gil_scoped_release release;
  kWrite(file, mesh);
}

template <WritePolygons kWrite>
void write_polygons(const std::string& file, const Vectors& vertices, const Indices& sizes,
                    const Indices& corners, const std::optional<Uvs>& uv, const Groups& groups,
                    const Lines& lines) {
  const std::vector<Vec3> positions = to_vectors(vertices);
  const MeshFaces faces = to_faces(sizes, corners, uv, groups, lines);
  const nb::gil_scoped_release release;
  kWrite(file, positions, faces);
}

/// The functions of a kind of file: read_NAME, write_NAME, write_NAME_polygons.
template <auto kRead, WriteMesh kWrite, WritePolygons kWritePolygons>
void bind_files(nb::module_& m, const std::string& name) {
  m.def(("read_" + name).c_str(), read_arrays<kRead>,
        nb::sig(("def read_" + name +
                 "(file: str) -> tuple[NDArray[numpy.float64], NDArray[numpy.int32], NDArray[numpy.float64], "
                 "tuple[NDArray[numpy.int32], NDArray[numpy.int32], NDArray[numpy.float64], "
                 "list[tuple[str, bool, NDArray[numpy.int32]]], NDArray[numpy.int32]], list[str]]")
                    .c_str()));
  m.def(("write_" + name).c_str(), write_arrays<kWrite>);
  m.def(("write_" + name + "_polygons").c_str(), write_polygons<kWritePolygons>, nb::arg(), nb::arg(),
        nb::arg(), nb::arg(), nb::arg().none(), nb::arg(), nb::arg(),
        nb::sig(
            ("def write_" + name +
             "_polygons(file: str, vertices: NDArray[numpy.float64], sizes: NDArray[numpy.int32], "
             "corners: NDArray[numpy.int32], uv: NDArray[numpy.float64] | None, "
             "groups: list[tuple[str, bool, NDArray[numpy.int32]]], lines: NDArray[numpy.int32], /) -> None")
                .c_str()));
}

void bind_gltf(nb::module_& m) {
  m.def(
      "read_gltf",
      [](const std::string& file, const std::string& node, const std::string& clip, double scale) {
        std::optional<BodyFromFile> read;
        {
          const nb::gil_scoped_release release;
          read.emplace(read_gltf(file, {.node = node, .clip = clip, .scale = scale}));
        }
        BodyFromFile& body = *read;
        return nb::make_tuple(
            make_array(std::move(body.mesh.positions)), make_array<int>(std::move(body.mesh.triangles), {3}),
            make_array<double>(std::move(body.mesh.uv), {3, 2}),
            body.motion.is_empty() ? nb::object(nb::none()) : nb::cast(std::move(body.motion)),
            std::move(body.clip), std::move(body.warnings));
      },
      nb::sig("def read_gltf(file: str, node: str, clip: str, scale: float) -> tuple[NDArray[numpy.float64], "
              "NDArray[numpy.int32], NDArray[numpy.float64], VertexMotion | None, str, list[str]]"));
}

void bind_meshes(nb::module_& m) {
  bind_files<read_obj, write_obj, write_obj>(m, "obj");
  bind_files<read_mesh, write_mesh, write_mesh>(m, "mesh");
  m.def(
      "triangulate",
      [](const Vectors& corners, const Indices& counts) {
        return make_array<int>(triangulate(to_vectors(corners), to_indices(counts)), {3});
      },
      nb::sig("def triangulate(corners: NDArray[numpy.float64], counts: NDArray[numpy.int32]) -> "
              "NDArray[numpy.int32]"));
  m.def(
      "vertex_normals",
      [](const Triangles& triangles, const Floats& positions) {
        return to_rows(vertex_normals(to_triangles(triangles), to_span(positions)));
      },
      nb::sig("def vertex_normals(triangles: NDArray[numpy.int32], positions: NDArray[numpy.float32]) -> "
              "NDArray[numpy.float32]"));
}

void bind_point_caches(nb::module_& m) {
  nb::class_<PointCacheFile>(m, "PointCacheFile")
      .def(nb::init<const std::string&>())
      .def_prop_ro("num_points", &PointCacheFile::num_points)
      .def_prop_ro("num_frames", &PointCacheFile::num_frames)
      .def_prop_ro("times", &PointCacheFile::times)
      .def(
          "frame", [](const PointCacheFile& file, int k) { return to_rows(file.frame(k)); },
          nb::sig("def frame(self, k: int) -> NDArray[numpy.float32]"));
  nb::class_<PointCacheWriter>(m, "PointCacheWriter")
      .def(nb::init<const std::string&, int, const std::vector<float>&>())
      .def(
          "add_frame",
          [](PointCacheWriter& writer, const Floats& positions) { writer.add_frame(to_span(positions)); },
          nb::sig("def add_frame(self, positions: NDArray[numpy.float32]) -> None"))
      .def("finish", &PointCacheWriter::finish);
}

void bind_convert(nb::module_& m) {
  m.def(
      "convert",
      [](const std::string& in, const std::string& out, std::optional<double> fps, bool up_is_z, double scale,
         int first_frame, std::optional<int> last_frame, const std::string& mesh) {
        std::optional<Converted> done;
        {
          const nb::gil_scoped_release release;
          done.emplace(convert(in, out,
                               {.fps = fps,
                                .up_is_z = up_is_z,
                                .scale = scale,
                                .first_frame = first_frame,
                                .last_frame = last_frame,
                                .mesh = mesh}));
        }
        return std::pair(done->files, done->notes);
      },
      nb::arg("file"), nb::arg("out"), nb::arg("fps").none(), nb::arg("up_is_z"), nb::arg("scale"),
      nb::arg("first_frame"), nb::arg("last_frame").none(), nb::arg("mesh"));
}

void bind_rest(nb::module_& m) {
  m.def(
      "rest_from_uv",
      [](const Vectors& vertices, const Triangles& faces, const std::optional<CornerUvs>& uv,
         std::optional<double> scale) {
        return make_array<double>(rest_from_uv(to_mesh(vertices, faces, uv), scale), {3, 3});
      },
      nb::arg("vertices"), nb::arg("faces"), nb::arg("uv").none(), nb::arg("scale").none());
}

void bind_crossings(nb::module_& m) {
  m.def(
      "find_crossings",
      [](const std::vector<std::tuple<Vectors, Triangles, bool>>& surfaces) {
        std::vector<Surface> read;
        for (const auto& [positions, triangles, is_cloth] : surfaces)
          read.push_back({to_vectors(positions), to_triangles(triangles), is_cloth});
        std::vector<std::array<int, 4>> rows;
        const nb::gil_scoped_release release;
        for (const Crossing& c : find_crossings(read))
          rows.push_back({c.surface, c.triangle, c.other_surface, c.other_triangle});
        return rows;
      },
      nb::arg("surfaces"),
      nb::sig("def find_crossings(surfaces: Sequence[tuple[NDArray[numpy.float64], NDArray[numpy.int32], "
              "bool]]) -> "
              "list[list[int]]"));
}

}  // namespace

void bind_scene(nb::module_& m) {
  bind_errors(m);
  bind_scene_class(m);
  bind_gltf(m);
  bind_meshes(m);
  bind_rest(m);
  bind_point_caches(m);
  bind_convert(m);
  bind_crossings(m);
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
