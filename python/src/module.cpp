/// The extension module weft._core: Weft's public C++ interface, for the Python half of the package.

#include "casts.h"

namespace weft::python {

std::vector<Vec3> to_vectors(const Vectors& array) {
  std::vector<Vec3> result(array.shape(0));
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = {array(i, 0), array(i, 1), array(i, 2)};
  return result;
}

std::vector<int> to_indices(const Indices& array) { return {array.data(), array.data() + array.shape(0)}; }

std::vector<Triangle> to_triangles(const Triangles& array) {
  std::vector<Triangle> result(array.shape(0));
  for (std::size_t t = 0; t < result.size(); ++t) result[t] = {array(t, 0), array(t, 1), array(t, 2)};
  return result;
}

TriangleMesh to_mesh(const Vectors& positions, const Triangles& triangles,
                     const std::optional<CornerUvs>& uv) {
  TriangleMesh mesh{.positions = to_vectors(positions), .triangles = to_triangles(triangles)};
  if (!uv) return mesh;
  for (std::size_t t = 0; t < uv->shape(0); ++t) {
    CornerUv& corners = mesh.uv.emplace_back();
    for (std::size_t c = 0; c < 3; ++c) corners[c] = {(*uv)(t, c, 0), (*uv)(t, c, 1)};
  }
  return mesh;
}

Pose to_pose(const Vec3& translation, const Matrix& rotation) {
  const auto row = [&](std::size_t r) { return Vec3{rotation(r, 0), rotation(r, 1), rotation(r, 2)}; };
  return {.translation = translation, .rotation = {row(0), row(1), row(2)}};
}

}  // namespace weft::python

NB_MODULE(_core, m) {
  using namespace weft::python;
  m.attr("__doc__") = "Weft's public C++ interface. Use the package weft, which explains it.";
  m.attr("version") = std::to_string(WEFT_VERSION_MAJOR) + "." + std::to_string(WEFT_VERSION_MINOR) + "." +
                      std::to_string(WEFT_VERSION_PATCH);
  nb::exception<weft::InputError>(m, "InputError", PyExc_ValueError).attr("__doc__") =
      "Invalid input. The message is a full sentence: the error, its place, and the expected value.";
  bind_values(m);
  bind_reports(m);
  bind_world(m);
  bind_scene(m);
  bind_pictures(m);
}
