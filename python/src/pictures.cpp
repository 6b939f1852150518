/// Pictures of worlds and recorded runs.

#include <nanobind/stl/array.h>

#include "locked_world.h"
#include "weft/pictures.h"

namespace weft::python {
namespace {

nb::tuple to_arrays(Rendering&& picture) {
  const auto height = static_cast<std::size_t>(picture.height),
             width = static_cast<std::size_t>(picture.width);
  const auto shaped = [&]<class Number>(std::vector<Number>&& values, std::vector<std::size_t> shape) {
    auto* own = new std::vector<Number>(std::move(values));
    nb::capsule owner(own, [](void* p) noexcept { delete static_cast<std::vector<Number>*>(p); });
    return nb::ndarray<nb::numpy, Number>(own->data(), shape.size(), shape.data(), owner);
  };
  const bool has_color = !picture.rgb.empty();
  return nb::make_tuple(shaped(std::move(picture.rgb), {has_color ? height : 0, width, 3}),
                        shaped(std::move(picture.depth), {height, width}),
                        shaped(std::move(picture.ids), {height, width}));
}

Camera to_camera(const Vec3& position, const Vec3& target, double fov_deg, int width, int height) {
  return {.position = position, .target = target, .fov_deg = fov_deg, .width = width, .height = height};
}

RenderOptions to_options(bool color, bool shadows, int samples,
                         std::vector<std::array<double, 3>> cloth_colors, std::optional<double> ground,
                         std::optional<int> smooth) {
  return {.color = color,
          .shadows = shadows,
          .samples = samples,
          .cloth_colors = std::move(cloth_colors),
          .ground = ground,
          .smooth = smooth};
}

}  // namespace

void bind_pictures(nb::module_& m) {
  nb::exception<GraphicsError>(m, "GraphicsError", PyExc_RuntimeError).attr("__doc__") =
      "There is no EGL or OpenGL 3.3 for pictures in colour; the message says what to install.";
  nb::class_<RenderOptions>(m, "RenderOptions")
      .def("__init__", [](RenderOptions* self, bool color, bool shadows, int samples,
                          std::vector<std::array<double, 3>> cloth_colors, std::optional<double> ground,
                          std::optional<int> smooth) {
        new (self) RenderOptions(to_options(color, shadows, samples, std::move(cloth_colors), ground, smooth));
      });
  nb::class_<Camera> camera(m, "CameraValues");
  camera
      .def("__init__",
           [](Camera* self, const Vec3& position, const Vec3& target, double fov_deg, int width, int height) {
             new (self) Camera(to_camera(position, target, fov_deg, width, height));
           })
      .def_ro("position", &Camera::position)
      .def_ro("target", &Camera::target)
      .def_ro("fov_deg", &Camera::fov_deg)
      .def_ro("width", &Camera::width)
      .def_ro("height", &Camera::height);
  nb::class_<Recording>(m, "AnimationFile")
      .def("__init__",
           [](Recording* self, const std::string& file) {
             const nb::gil_scoped_release release;
             new (self) Recording(file);
           })
      .def_prop_ro("num_frames", &Recording::num_frames);
  m.def("frame_camera", [](LockedWorld& own, const Camera& like) {
    return with(own, [&](const World& w) { return frame_camera(w, like); });
  });
  m.def("frame_camera",
        [](const Recording& recording, const Camera& like) { return frame_camera(recording, like); });
  nb::class_<OffscreenRenderer>(m, "Renderer")
      .def("__init__", [](OffscreenRenderer* self) { new (self) OffscreenRenderer(); })
      .def(
          "render",
          [](OffscreenRenderer& renderer, LockedWorld& own, const Camera& view,
             const RenderOptions& options) {
            return to_arrays(with(own, [&](const World& w) { return renderer.render(w, view, options); }));
          },
          nb::sig("def render(self, world: World, camera: CameraValues, options: RenderOptions) -> "
                  "tuple[NDArray[numpy.uint8], NDArray[numpy.float32], NDArray[numpy.int32]]"))
      .def(
          "render_frame",
          [](OffscreenRenderer& renderer, const Recording& recording, int frame, const Camera& view,
             const RenderOptions& options) {
            std::optional<Rendering> picture;
            {
              const nb::gil_scoped_release release;
              picture.emplace(renderer.render(recording, frame, view, options));
            }
            return to_arrays(std::move(*picture));
          },
          nb::sig(
              "def render_frame(self, animation: AnimationFile, frame: int, camera: CameraValues, options: "
              "RenderOptions) -> tuple[NDArray[numpy.uint8], NDArray[numpy.float32], NDArray[numpy.int32]]"));
  m.def("write_picture",
        [](const std::string& file,
           const nb::ndarray<const std::uint8_t, nb::shape<-1, -1, 3>, nb::c_contig, nb::device::cpu>& rgb) {
          Rendering picture{.width = static_cast<int>(rgb.shape(1)),
                            .height = static_cast<int>(rgb.shape(0))};
          picture.rgb.assign(rgb.data(), rgb.data() + rgb.size());
          const nb::gil_scoped_release release;
          write_picture(file, picture);
        });
  m.def("write_video", [](const std::string& file, const Recording& recording, const Camera& view,
                          const RenderOptions& options, int every) {
    const nb::gil_scoped_release release;
    write_video(file, recording, view, options, every);
  });
}

}  // namespace weft::python
