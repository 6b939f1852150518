#pragma once
/// Conversions between Python's and Weft's values, shared by the files of the extension module.

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "weft/run.h"
#include "weft/weft.h"

namespace nb = nanobind;

namespace nanobind::detail {

/// A vector: any sequence of three numbers in, a tuple out.
template <>
struct type_caster<weft::Vec3> {
  NB_TYPE_CASTER(weft::Vec3, io_name("collections.abc.Sequence[float]", "tuple[float, float, float]"))

  bool from_python(handle source, std::uint8_t, cleanup_list*) noexcept {
    if (!PySequence_Check(source.ptr()) || PySequence_Size(source.ptr()) != 3) {
      PyErr_Clear();
      return false;
    }
    double* const numbers[3] = {&value.x, &value.y, &value.z};
    for (Py_ssize_t k = 0; k < 3; ++k) {
      PyObject* item = PySequence_GetItem(source.ptr(), k);
      const double number = item ? PyFloat_AsDouble(item) : -1;
      Py_XDECREF(item);
      if (PyErr_Occurred()) {
        PyErr_Clear();
        return false;
      }
      *numbers[k] = number;
    }
    return true;
  }

  static handle from_cpp(const weft::Vec3& v, rv_policy, cleanup_list*) noexcept {
    return Py_BuildValue("(ddd)", v.x, v.y, v.z);
  }
};

}  // namespace nanobind::detail

namespace weft::python {

// Arguments, checked and converted to these types by the package's Python half.
using Vectors = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using Indices = nb::ndarray<const int, nb::shape<-1>, nb::c_contig, nb::device::cpu>;
using Triangles = nb::ndarray<const int, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using Matrix = nb::ndarray<const double, nb::shape<3, 3>, nb::c_contig, nb::device::cpu>;

using CornerUvs = nb::ndarray<const double, nb::shape<-1, 3, 2>, nb::c_contig, nb::device::cpu>;

std::vector<Vec3> to_vectors(const Vectors& array);
std::vector<int> to_indices(const Indices& array);
std::vector<Triangle> to_triangles(const Triangles& array);
TriangleMesh to_mesh(const Vectors& positions, const Triangles& triangles,
                     const std::optional<CornerUvs>& uv);
Pose to_pose(const Vec3& translation, const Matrix& rotation);

/// A new array that takes over the vector's memory; `shape` after the first dimension.
template <class Number, class Item>
nb::ndarray<nb::numpy, Number> make_array(std::vector<Item>&& items,
                                          std::initializer_list<std::size_t> shape) {
  auto* own = new std::vector<Item>(std::move(items));
  nb::capsule owner(own, [](void* p) noexcept { delete static_cast<std::vector<Item>*>(p); });
  std::vector<std::size_t> sizes = {own->size()};
  sizes.insert(sizes.end(), shape.begin(), shape.end());
  return nb::ndarray<nb::numpy, Number>(own->data(), sizes.size(), sizes.data(), owner);
}

inline nb::ndarray<nb::numpy, double> make_array(std::vector<Vec3>&& vectors) {
  return make_array<double>(std::move(vectors), {3});
}

/// Names of an enumeration's values, in their order.
template <class Enum>
struct Names;

template <>
struct Names<DampingKind> {
  static constexpr std::string_view what = "damping_kind";
  static constexpr std::array<std::string_view, 2> names = {"plain", "projected"};
};
template <>
struct Names<NewtonQuality> {
  static constexpr std::string_view what = "quality";
  static constexpr std::array<std::string_view, 3> names = {"fast", "default", "high"};
};
template <>
struct Names<SpringModel> {
  static constexpr std::string_view what = "model";
  static constexpr std::array<std::string_view, 3> names = {"basic", "simplified", "alternating"};
};
template <>
struct Names<Membrane> {
  static constexpr std::string_view what = "membrane";
  static constexpr std::array<std::string_view, 2> names = {"triangle", "springs"};
};
template <>
struct Names<Unfinished> {
  static constexpr std::string_view what = "unfinished";
  static constexpr std::array<std::string_view, 3> names = {"refuse", "resume", "discard"};
};
template <>
struct Names<ForceKind> {
  static constexpr std::string_view what = "kind";
  static constexpr std::array<std::string_view, 6> names = {"gravity", "elastic",  "damping",
                                                            "wind",    "external", "contact"};
};
template <>
struct Names<StepFault> {
  static constexpr std::string_view what = "fault";
  static constexpr std::array<std::string_view, 6> names = {"stretch",    "collapse", "energy",
                                                            "infeasible", "skipped",  "non_finite"};
};
template <>
struct Names<WarningCode> {
  static constexpr std::string_view what = "code";
  static constexpr std::array<std::string_view, 12> names = {
      "not_converged", "contact_skipped", "non_finite", "cap_reached", "yarn_strain", "flat_triangle",
      "energy_rise",   "crossings",       "passages",   "infeasible",  "open_seam",   "penetration"};
};
template <>
struct Names<InfeasibleKind> {
  static constexpr std::string_view what = "kind";
  static constexpr std::array<std::string_view, 2> names = {"passed", "caught"};
};

template <class Enum>
std::string_view name_of(Enum value) {
  return Names<Enum>::names[static_cast<std::size_t>(value)];
}

/// Throws InputError with all names if there is no such one.
template <class Enum>
Enum value_of(std::string_view name) {
  std::string all;
  for (std::size_t n = 0; n < Names<Enum>::names.size(); ++n) {
    if (Names<Enum>::names[n] == name) return static_cast<Enum>(n);
    all += (all.empty() ? "\"" : ", \"") + std::string(Names<Enum>::names[n]) + "\"";
  }
  throw InputError(std::string(Names<Enum>::what) + ": expected one of " + all + ", found \"" +
                   std::string(name) + "\"");
}

void bind_values(nb::module_& m);
void bind_reports(nb::module_& m);
void bind_world(nb::module_& m);
void bind_scene(nb::module_& m);
void bind_pictures(nb::module_& m);

}  // namespace weft::python
