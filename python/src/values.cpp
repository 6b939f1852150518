/// Fabrics, settings and shapes as Python classes: plain values with keyword arguments.

#include <cstdint>
#include <functional>
#include <map>

#include "casts.h"
#include "weft/parameters.h"

namespace weft::python {
namespace {

/// A class of plain numbers: its members become properties and keyword arguments of the constructor, with the
/// defaults of C++ and the texts of weft/parameters.h.
template <class T>
class ValueClass {
 public:
  ValueClass(nb::module_& m, const char* name, const char* doc) : class_(m, name), name_(name) {
    class_.attr("__doc__") = doc;
  }

  /// A number, vector or separate settings; `type` is Python's.
  template <class Member>
  ValueClass& member(const char* name, Member T::*field, const char* type, const std::string& doc) {
    return add({name, type, [field](T& value, nb::handle from) { value.*field = nb::cast<Member>(from); },
                [field](const T& value) { return nb::cast(value.*field); }},
               doc);
  }

  /// A member with a type that needs conversion.
  template <class Get, class Set>
  ValueClass& property(const char* name, Get get, Set set, const char* type, const std::string& doc) {
    return add({name, type, [set](T& value, nb::handle from) { set(value, nb::borrow(from)); },
                [get](const T& value) { return nb::object(nb::cast(get(value))); }},
               doc);
  }

  template <class Enum>
  ValueClass& choice(const char* name, Enum T::*field, const std::string& doc) {
    std::string type = "typing.Literal[";
    for (const std::string_view n : Names<Enum>::names)
      type += (type.back() == '[' ? "'" : ", '") + std::string(n) + "'";
    return add(
        {name, keep(type + "]"),
         [field](T& value, nb::handle from) { value.*field = value_of<Enum>(nb::cast<std::string>(from)); },
         [field](const T& value) { return nb::object(nb::cast(name_of(value.*field))); }},
        doc);
  }

  /// The constructor and the methods of every value.
  nb::class_<T>& finish() {
    std::string sig = "def __init__(self, *";
    const T usual;
    for (const Field& field : fields_)
      sig += ", " + std::string(field.name) + ": " + field.type + " = " +
             nb::cast<std::string>(nb::repr(field.get(usual)));
    class_.def(
        "__init__",
        [fields = fields_](T* self, nb::kwargs given) {
          new (self) T();
          set_all(fields, *self, given);
        },
        nb::sig(keep(sig + ") -> None")));
    class_.def(
        "_replace",
        [fields = fields_](const T& self, nb::kwargs given) {
          T changed = self;
          set_all(fields, changed, given);
          return changed;
        },
        nb::sig(keep("def _replace(self, **changes: object) -> " + name_)),
        "A copy with some values changed.");
    class_.def(
        "_asdict",
        [fields = fields_](const T& self) {
          nb::dict values;
          for (const Field& field : fields) values[field.name] = field.get(self);
          return values;
        },
        nb::sig("def _asdict(self) -> dict[str, typing.Any]"), "The values by their names.");
    class_.def("__repr__", [fields = fields_, name = name_](const T& self) {
      std::string text = name + "(";
      for (const Field& field : fields)
        text += (text.back() == '(' ? "" : ", ") + std::string(field.name) + "=" +
                nb::cast<std::string>(nb::repr(field.get(self)));
      return text + ")";
    });
    class_.def(
        "__eq__",
        [fields = fields_](const T& self, nb::handle other) {
          if (!nb::isinstance<T>(other)) return false;
          const T& that = nb::cast<const T&>(other);
          for (const Field& field : fields)
            if (!field.get(self).equal(field.get(that))) return false;
          return true;
        },
        nb::sig("def __eq__(self, other: object, /) -> bool"));
    class_.def("__hash__", [name = name_](const T&) -> std::size_t {
      throw nb::type_error(("unhashable type: '" + name + "', which can be changed").c_str());
    });
    class_.def(
        "__getstate__",
        [fields = fields_](const T& self) {
          nb::dict values;
          for (const Field& field : fields) values[field.name] = field.get(self);
          return values;
        },
        nb::sig("def __getstate__(self) -> dict[str, typing.Any]"));
    class_.def(
        "__setstate__",
        [fields = fields_](T& self, const nb::dict& values) {
          new (&self) T();
          set_all(fields, self, values);
        },
        nb::sig("def __setstate__(self, values: dict[str, typing.Any], /) -> None"));
    return class_;
  }

 private:
  struct Field {
    const char* name;
    const char* type;
    std::function<void(T&, nb::handle)> set;
    std::function<nb::object(const T&)> get;
  };

  ValueClass& add(Field field, const std::string& doc) {
    const std::string head = "def " + std::string(field.name) + "(self";
    class_.def_prop_rw(
        field.name, [get = field.get](const T& value) { return get(value); },
        [field](T& value, nb::object from) { set(field, value, from); },
        nb::for_getter(nb::sig(keep(head + ") -> " + field.type))),
        nb::for_setter(nb::sig(keep(head + ", value: " + field.type + ", /) -> None"))), keep(doc));
    fields_.push_back(std::move(field));
    return *this;
  }

  static void set(const Field& field, T& value, nb::handle from) {
    try {
      field.set(value, from);
    } catch (const std::bad_cast&) {
      throw nb::type_error((std::string(field.name) + ": expected " + field.type + ", found " +
                            nb::cast<std::string>(nb::repr(from)))
                               .c_str());
    }
  }

  static void set_all(const std::vector<Field>& fields, T& value, const nb::dict& given) {
    for (auto [key, from] : given) {
      const std::string name = nb::cast<std::string>(key);
      const Field* found = nullptr;
      for (const Field& field : fields)
        if (name == field.name) found = &field;
      if (!found) {
        std::string names;
        for (const Field& field : fields) names += (names.empty() ? "" : ", ") + std::string(field.name);
        throw nb::type_error(("unknown argument \"" + name + "\"; there are " + names).c_str());
      }
      set(*found, value, from);
    }
  }

  /// Texts that live as long as the module.
  static const char* keep(const std::string& text) {
    static std::vector<std::unique_ptr<std::string>> texts;
    return texts.emplace_back(std::make_unique<std::string>(text))->c_str();
  }

  nb::class_<T> class_;
  std::string name_;
  std::vector<Field> fields_;
};

/// The text and unit of a key of scene files.
std::string doc(const std::string& key, const char* form = "") {
  const Parameter& parameter = find_parameter(key, form);
  return parameter.description + (parameter.unit.empty() ? "" : " [" + parameter.unit + "]");
}

nb::object to_pairs(const std::vector<StretchPoint>& curve) {
  nb::list pairs;
  for (const StretchPoint& point : curve) pairs.append(nb::make_tuple(point.strain, point.tension));
  return pairs;
}

std::vector<StretchPoint> to_curve(nb::handle pairs) {
  std::vector<StretchPoint> curve;
  for (nb::handle pair : pairs) {
    if (nb::len(pair) != 2) throw InputError("a point of a stretch curve is a pair of strain and tension");
    curve.push_back({nb::cast<double>(pair[0]), nb::cast<double>(pair[1])});
  }
  return curve;
}

void bind_fabrics(nb::module_& m) {
  const auto curve = [](std::vector<StretchPoint> Fabric::*field) {
    return std::pair([field](const Fabric& f) { return to_pairs(f.*field); },
                     [field](Fabric& f, nb::object from) { f.*field = to_curve(from); });
  };
  const auto warp = curve(&Fabric::stretch_warp), weft = curve(&Fabric::stretch_weft);
  ValueClass<Fabric> fabric(
      m, "Fabric",
      "A fabric in SI units, independent of the mesh; the defaults are those of cotton shirting.");
  const auto number = [&](const char* name, double Fabric::*field) {
    fabric.member(name, field, "float", doc("cloth.fabric." + std::string(name), "fabric"));
  };
  number("density", &Fabric::density);
  number("c11", &Fabric::c11);
  number("c22", &Fabric::c22);
  number("c12", &Fabric::c12);
  number("g", &Fabric::g);
  number("bend_warp", &Fabric::bend_warp);
  number("bend_weft", &Fabric::bend_weft);
  number("bend_bias", &Fabric::bend_bias);
  number("bend_hysteresis_warp", &Fabric::bend_hysteresis_warp);
  number("bend_hysteresis_weft", &Fabric::bend_hysteresis_weft);
  number("bend_set", &Fabric::bend_set);
  number("damping", &Fabric::damping);
  number("thickness", &Fabric::thickness);
  number("friction", &Fabric::friction);
  number("strain_limit", &Fabric::strain_limit);
  number("strength", &Fabric::strength);
  constexpr const char* kCurve = "collections.abc.Sequence[tuple[float, float]]";
  fabric.property("stretch_warp", warp.first, warp.second, kCurve,
                  doc("cloth.fabric.stretch_warp", "fabric"));
  fabric.property("stretch_weft", weft.first, weft.second, kCurve,
                  doc("cloth.fabric.stretch_weft", "fabric"));
  fabric.finish();

  ValueClass<Springs> springs(m, "Springs", "Cloth made of springs, whose stiffness depends on the mesh.");
  const auto of_springs = [&](const char* name, double Springs::*field, const char* key) {
    springs.member(name, field, "float", doc("cloth.fabric." + std::string(key), "springs"));
  };
  of_springs("density", &Springs::density, "density");
  of_springs("structural", &Springs::structural, "spring_structural");
  of_springs("shear", &Springs::shear, "spring_shear");
  of_springs("bend", &Springs::bend, "spring_bend");
  of_springs("damping", &Springs::damping, "damping");
  springs.choice("damping_kind", &Springs::damping_kind, doc("cloth.fabric.damping_kind", "springs"));
  of_springs("thickness", &Springs::thickness, "thickness");
  of_springs("friction", &Springs::friction, "friction");
  springs.finish();

  m.def(
      "fabric_presets",
      [] {
        nb::list names;
        for (const FabricPreset& preset : fabric_presets())
          names.append(nb::make_tuple(preset.name, preset.title));
        return names;
      },
      nb::sig("def fabric_presets() -> list[tuple[str, str]]"), "Names and titles of all presets.");
  m.def(
      "find_fabric", [](const std::string& name) { return find_fabric(name); }, nb::arg("name"),
      "The fabric of a preset.");
  m.def(
      "fabric_sources",
      [](const std::string& name) {
        const FabricSources& s = find_fabric_preset(name).sources;
        nb::dict sources;
        sources["density"] = s.density;
        sources["stretch"] = s.stretch;
        sources["shear"] = s.shear;
        sources["bending"] = s.bending;
        sources["damping"] = s.damping;
        sources["thickness"] = s.thickness;
        sources["friction"] = s.friction;
        return sources;
      },
      nb::arg("name"), nb::sig("def fabric_sources(name: str) -> dict[str, str]"),
      "Sources of a preset's numbers.");
}

template <class Sheet>
void bind_sheet(nb::module_& m, const char* name, const char* text,
                std::initializer_list<std::pair<const char*, double Sheet::*>> numbers) {
  ValueClass<Sheet> sheet(m, name, text);
  for (const auto& [field, member] : numbers) sheet.member(field, member, "float", "");
  sheet.finish();
  m.def(
      "fabric_from", [](const Sheet& s) { return fabric_from(s); }, nb::arg("sheet"),
      "The fabric of a laboratory sheet, in SI units.");
}

void bind_sheets(nb::module_& m) {
  bind_sheet<KesSheet>(
      m, "KesSheet",
      "A sheet of the Kawabata Evaluation System (KES-F), in its printed units: weight [mg/cm²], "
      "thickness [mm], extension at 500 gf/cm [%], linearity LT [1], shear G [gf/(cm·degree)], bending "
      "B [gf·cm²/cm], its hysteresis 2HB [gf·cm/cm], friction MIU [1].",
      {{"weight", &KesSheet::weight},
       {"thickness", &KesSheet::thickness},
       {"extension_warp", &KesSheet::extension_warp},
       {"extension_weft", &KesSheet::extension_weft},
       {"linearity_warp", &KesSheet::linearity_warp},
       {"linearity_weft", &KesSheet::linearity_weft},
       {"shear", &KesSheet::shear},
       {"bend_warp", &KesSheet::bend_warp},
       {"bend_weft", &KesSheet::bend_weft},
       {"hysteresis_warp", &KesSheet::hysteresis_warp},
       {"hysteresis_weft", &KesSheet::hysteresis_weft},
       {"friction", &KesSheet::friction}});
  bind_sheet<FastSheet>(
      m, "FastSheet",
      "A sheet of SiroFAST, in its printed units: weight [g/m²], thickness T2 [mm], bending lengths "
      "[mm], extensions under 5 and 20 gf/cm and along the bias [%], friction [1].",
      {{"weight", &FastSheet::weight},
       {"thickness", &FastSheet::thickness},
       {"bending_length_warp", &FastSheet::bending_length_warp},
       {"bending_length_weft", &FastSheet::bending_length_weft},
       {"extension_5_warp", &FastSheet::extension_5_warp},
       {"extension_20_warp", &FastSheet::extension_20_warp},
       {"extension_5_weft", &FastSheet::extension_5_weft},
       {"extension_20_weft", &FastSheet::extension_20_weft},
       {"bias_extension", &FastSheet::bias_extension},
       {"friction", &FastSheet::friction}});
  bind_sheet<CloProperties>(
      m, "CloProperties",
      "Physical properties of CLO and Marvelous Designer: density [g/m²], thickness [mm], stretch "
      "and shear [g/s²], bending [g·mm²/s²], friction [1].",
      {{"density", &CloProperties::density},
       {"thickness", &CloProperties::thickness},
       {"stretch_warp", &CloProperties::stretch_warp},
       {"stretch_weft", &CloProperties::stretch_weft},
       {"shear", &CloProperties::shear},
       {"bend_warp", &CloProperties::bend_warp},
       {"bend_weft", &CloProperties::bend_weft},
       {"bend_bias", &CloProperties::bend_bias},
       {"friction", &CloProperties::friction}});
}

void bind_solver(nb::module_& m) {
  ValueClass<ExplicitSettings>(m, "ExplicitSettings", "Settings of the integrator `explicit`.")
      .member("substeps", &ExplicitSettings::substeps, "int", doc("solver.explicit.substeps"))
      .finish();
  ValueClass<PaperSettings>(m, "PaperSettings", "Settings of the integrators `paper` and `paper_fixed`.")
      .member("printed_damping_sign", &PaperSettings::printed_damping_sign, "bool",
              doc("solver.paper.damping_sign"))
      .finish();
  ValueClass<ImplicitEulerSettings>(m, "ImplicitEulerSettings",
                                    "Settings of the integrator `implicit_euler`.")
      .member("tolerance", &ImplicitEulerSettings::tolerance, "float", doc("solver.tolerance"))
      .member("iterations", &ImplicitEulerSettings::iterations, "int", doc("solver.iterations"))
      .finish();
  ValueClass<NewtonSettings>(m, "NewtonSettings", "Settings of the integrator `newton`.")
      .member("iterations", &NewtonSettings::iterations, "int", doc("solver.iterations"))
      .choice("quality", &NewtonSettings::quality, doc("solver.quality"))
      .finish();
  ValueClass<XpbdSettings>(m, "XpbdSettings", "Settings of the integrator `xpbd`.")
      .member("substeps", &XpbdSettings::substeps, "int", doc("solver.xpbd.substeps"))
      .finish();
  ValueClass<IntegratorSettings>(m, "IntegratorSettings", "An integrator and its settings.")
      .member("integrator", &IntegratorSettings::integrator, "str", doc("solver.integrator"))
      .member("explicit_euler", &IntegratorSettings::explicit_euler, "ExplicitSettings", "")
      .member("paper", &IntegratorSettings::paper, "PaperSettings", "")
      .member("implicit_euler", &IntegratorSettings::implicit_euler, "ImplicitEulerSettings", "")
      .member("newton", &IntegratorSettings::newton, "NewtonSettings", "")
      .member("xpbd", &IntegratorSettings::xpbd, "XpbdSettings", "")
      .member("is_double", &IntegratorSettings::is_double, "bool", doc("solver.precision"))
      .finish();
  ValueClass<StepDivision>(m, "StepDivision",
                           "Division of steps that end with excess stretch, collapse or energy.")
      .member("enabled", &StepDivision::enabled, "bool | None", doc("solver.adaptive"))
      .member("shortest", &StepDivision::shortest, "float", "Shortest part of a step, > 0 [s]")
      .finish();
  ValueClass<ContactSettings>(m, "ContactSettings",
                              "Contact of cloth with colliders, itself and other cloth.")
      .member("enabled", &ContactSettings::enabled, "bool", doc("solver.contact"))
      .member("tracks_points", &ContactSettings::tracks_points, "bool",
              "Whether `World.contacts` returns the contacts of the last step.")
      .finish();
  m.def(
      "integrator_names",
      [] {
        nb::list names;
        for (const std::string_view name : integrator_names()) names.append(nb::cast(name));
        return names;
      },
      nb::sig("def integrator_names() -> list[str]"), "Names of all integrators.");
}

void bind_wind(nb::module_& m) {
  ValueClass<Air>(m, "Air", "Aerodynamic drag and lift per triangle.")
      .member("density", &Air::density, "float", doc("wind.air.density"))
      .member("drag", &Air::drag, "float", doc("wind.air.drag"))
      .member("lift", &Air::lift, "float", doc("wind.air.lift"))
      .finish();
  ValueClass<Gusts>(m, "Gusts", "Velocity fluctuation of the air: smooth noise in space and time.")
      .member("strength", &Gusts::strength, "float", doc("wind.gusts.strength"))
      .member("length", &Gusts::length, "float", doc("wind.gusts.length"))
      .member("time", &Gusts::time, "float", doc("wind.gusts.time"))
      .member("seed", &Gusts::seed, "int", doc("wind.gusts.seed"))
      .finish();
  ValueClass<WindKey>(m, "WindKey", "Velocity of the air at a time; linear between keys.")
      .member("time", &WindKey::time, "float", "[s]")
      .member("velocity", &WindKey::velocity, "collections.abc.Sequence[float]", "[m/s]")
      .finish();
  ValueClass<Wind>(m, "Wind", "Motion of the air, and its forces on cloth.")
      .member("velocity", &Wind::velocity, "collections.abc.Sequence[float]", doc("wind.velocity"))
      .member("keys", &Wind::keys, "collections.abc.Sequence[WindKey]", doc("wind.keys"))
      .member("drag", &Wind::drag, "float", doc("wind.drag"))
      .member("air", &Wind::air, "Air", doc("wind.air"))
      .member("gusts", &Wind::gusts, "Gusts", doc("wind.gusts"))
      .finish();
}

void bind_shapes(nb::module_& m) {
  ValueClass<KeyFrame>(m, "KeyFrame", "Displacement from the initial pose at a time.")
      .member("time", &KeyFrame::time, "float", "[s]")
      .member("translation", &KeyFrame::translation, "collections.abc.Sequence[float]", "[m]")
      .member("angles_deg", &KeyFrame::angles_deg, "collections.abc.Sequence[float]",
              "About fixed x, then y, then z [degrees]")
      .finish();
  ValueClass<Grid> grid(m, "Grid", "Rectangular cloth as a grid of particles in the plane y = 0.");
  grid.member("size_x", &Grid::size_x, "float", "Length along x, > 0 [m]")
      .member("size_z", &Grid::size_z, "float", "Length along z, > 0 [m]")
      .member("cells_x", &Grid::cells_x, "int", "Cells along x, at least 1")
      .member("cells_z", &Grid::cells_z, "int", "Cells along z, at least 1");
  grid.finish()
      .def_prop_ro(
          "num_particles",
          [](const Grid& g) { return (std::int64_t{1} + g.cells_x) * (std::int64_t{1} + g.cells_z); },
          "(cells_x + 1) · (cells_z + 1)")
      .def(
          "index",
          [](const Grid& g, int i, int j) {
            if (i < 0 || i > g.cells_x || j < 0 || j > g.cells_z)
              throw InputError("index: expected a column from 0 to " + std::to_string(g.cells_x) +
                               " and a row from 0 to " + std::to_string(g.cells_z) + ", found " +
                               std::to_string(i) + " and " + std::to_string(j));
            return i + j * (std::int64_t{1} + g.cells_x);
          },
          nb::arg("i"), nb::arg("j"), "The particle at column i along x and row j along z.");
  ValueClass<Sphere>(m, "Sphere", "A solid ball.")
      .member("center", &Sphere::center, "collections.abc.Sequence[float]", "[m]")
      .member("radius", &Sphere::radius, "float", "> 0 [m]")
      .finish();
  ValueClass<Plane>(m, "Plane", "A half space: everything below the plane is solid.")
      .member("point", &Plane::point, "collections.abc.Sequence[float]", "[m]")
      .member("normal", &Plane::normal, "collections.abc.Sequence[float]",
              "Upwards out of the solid, of length 1")
      .finish();
  ValueClass<Capsule>(m, "Capsule", "All points within a radius of the segment from a to b.")
      .member("a", &Capsule::a, "collections.abc.Sequence[float]", "[m]")
      .member("b", &Capsule::b, "collections.abc.Sequence[float]", "[m]")
      .member("radius", &Capsule::radius, "float", "> 0 [m]")
      .finish();
  ValueClass<OrientedBox> box(m, "Box",
                              "A solid box; turn it with the argument `rotation` of `World.add_collider`.");
  box.member("center", &OrientedBox::center, "collections.abc.Sequence[float]", "[m]")
      .member("half_size", &OrientedBox::half_size, "collections.abc.Sequence[float]",
              "Along x, y and z, > 0 [m]")
      .finish();
  m.def(
      "rotation_from_angles",
      [](const Vec3& angles) {
        const Mat3 r = rotation_from_angles_deg(angles);
        return make_array<double>(std::vector<Vec3>{r.row0, r.row1, r.row2}, {3});
      },
      nb::arg("angles_deg"), "The rotation about fixed x, then y, then z, as a matrix.");
  m.def(
      "rotation_from_quaternion",
      [](double w, double x, double y, double z) {
        const Mat3 r = rotation_from_quaternion(w, x, y, z);
        return make_array<double>(std::vector<Vec3>{r.row0, r.row1, r.row2}, {3});
      },
      nb::arg("w"), nb::arg("x"), nb::arg("y"), nb::arg("z"), "The rotation of a quaternion, as a matrix.");
}

std::string_view kind_name(ParameterKind kind) {
  constexpr std::string_view kNames[] = {"flag",  "number", "whole_number", "text",
                                         "file",  "choice", "numbers",      "whole_numbers",
                                         "texts", "pairs",  "table",        "tables"};
  return kNames[static_cast<int>(kind)];
}

void bind_parameters(nb::module_& m) {
  m.def(
      "parameters",
      [] {
        nb::list all;
        for (const Parameter& p : parameters()) {
          nb::dict entry;
          entry["key"] = p.key;
          entry["unit"] = p.unit;
          entry["default"] = p.default_value;
          entry["min"] = p.min;
          entry["max"] = p.max;
          entry["kind"] = kind_name(p.kind);
          entry["form"] = p.form;
          entry["choices"] = p.choices;
          entry["required"] = p.required;
          entry["description"] = p.description;
          all.append(entry);
        }
        return all;
      },
      nb::sig("def parameters() -> list[dict[str, typing.Any]]"), "All keys of scene files.");
}

}  // namespace

void bind_values(nb::module_& m) {
  bind_fabrics(m);
  bind_sheets(m);
  bind_solver(m);
  bind_wind(m);
  bind_shapes(m);
  bind_parameters(m);
}

}  // namespace weft::python
