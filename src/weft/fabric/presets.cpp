#include "weft/fabric.h"

#include <algorithm>

#include "weft/core/nearest_name.h"
#include "weft/error.h"
#include "weft/laboratory.h"

namespace weft {
namespace {

constexpr const char* kDefaultDamping = "Fabric's default: not measured";
constexpr const char* kDefaultThickness = "Fabric's default: not measured";
constexpr const char* kFriction =
    "typical of cloth on cloth, 0.2 (silk) to 0.6 (wool); not measured on this fabric";
constexpr const char* kFeng =
    "between the 5 % and 25 % quantiles of 618 fabrics (Feng et al. 2022: 0.030 and 0.103 kg/m², 1.1e-6 and "
    "4.1e-6 N·m)";

FabricPreset make_silk() {
  Fabric f{.density = 0.069,
           .c11 = 2800,
           .c22 = 2000,
           .c12 = 0,
           .g = 14,
           .bend_warp = 2.5e-6,
           .bend_weft = 2.0e-6,
           .bend_bias = 2.0e-6,
           .thickness = 0.15e-3,
           .friction = 0.2};
  return {"silk",
          "Silk habotai, 16 momme",
          f,
          {.density = "16 momme; 1 momme = 4.34 g/m² by definition",
           .stretch = "typical (recalled): KES-F extensions of 4 and 5.5 % at linearity 0.7",
           .shear = "typical (recalled): KES-F 0.25 gf/(cm·degree); silk weaves shear very easily at small "
                    "angles (Matsudaira, Kanazawa University)",
           .bending = kFeng,
           .damping = kDefaultDamping,
           .thickness = "typical of the weight",
           .friction = "typical: silk slides easiest of the natural fibres"},
          {.weave = Weave::plain, .thread = 0.25e-3, .translucency = 0.4, .sheen = 0.25, .gloss = 0.5}};
}

FabricPreset make_cotton_shirting() {
  return {"cotton_shirting",
          "Cotton poplin for shirts",
          Fabric(),
          {.density = "typical of poplin, 110 to 130 g/m²",
           .stretch = "typical (recalled): KES-F extensions of 4 and 8 % at linearity 0.7",
           .shear = "typical (recalled): KES-F 0.8 gf/(cm·degree)",
           .bending = "between the 25 % and 50 % quantiles of 618 fabrics (Feng et al. 2022: 4.1e-6 and "
                      "13.9e-6 N·m), as its weight is",
           .damping = "typical of published scenes (ARCSim: 1e-3 to 3e-2 s)",
           .thickness = "typical, with the gap between two layers",
           .friction = "typical of cotton on cotton"},
          {.weave = Weave::plain, .thread = 0.25e-3, .translucency = 0.3, .sheen = 0.25, .gloss = 0.05}};
}

FabricPreset make_wool_suiting() {
  const Fabric f = fabric_from(FastSheet{.weight = 168,
                                         .thickness = 0.6,
                                         .bending_length_warp = 15.0,
                                         .bending_length_weft = 14.5,
                                         .extension_5_warp = 0.67,
                                         .extension_20_warp = 1.87,
                                         .extension_5_weft = 0.40,
                                         .extension_20_weft = 1.87,
                                         .bias_extension = 4.7,
                                         .friction = 0.45});
  const std::string sheet = "FAST sheet of a plain-woven pure wool of 168 g/m² (a published student report)";
  return {"wool_suiting",
          "Plain-woven wool for summer suits",
          f,
          {.density = sheet,
           .stretch = sheet + ": E5 0.67 and 0.40 %, E20 1.87 and 1.87 %",
           .shear = sheet + ": EB5 4.7 %",
           .bending = sheet + ": bending lengths 15.0 and 14.5 mm; bias their geometric mean",
           .damping = kDefaultDamping,
           .thickness = "typical of the weight",
           .friction = "typical: wool is rougher than cotton"},
          {.weave = Weave::plain, .thread = 0.4e-3, .translucency = 0.15, .sheen = 0.45, .gloss = 0.03}};
}

FabricPreset make_denim() {
  const Fabric f = fabric_from(KesSheet{.weight = 40.7,
                                        .thickness = 1.066,
                                        .extension_warp = 5.515,
                                        .extension_weft = 5.515,
                                        .linearity_warp = 0.712,
                                        .linearity_weft = 0.712,
                                        .shear = 2.180,
                                        .bend_warp = 0.172,
                                        .bend_weft = 0.172,
                                        .hysteresis_warp = 0.139,
                                        .hysteresis_weft = 0.139,
                                        .friction = 0.5});
  const std::string sheet =
      "KES-F sheet of a denim (Journal of Textiles 2016, 4614168, table 5, sample A; mean of warp and weft)";
  return {"denim",
          "Denim for jeans, 12 oz",
          f,
          {.density = "12 oz/yd²; 1 oz/yd² = 33.906 g/m²",
           .stretch = sheet + ": EMT 5.515 %, LT 0.712",
           .shear = sheet + ": G 2.18 gf/(cm·degree)",
           .bending = sheet + ": B 0.172 gf·cm²/cm, 2HB 0.139 gf·cm/cm; bias the same",
           .damping = kDefaultDamping,
           .thickness = sheet,
           .friction = "typical: denim is rougher than shirting"},
          {.weave = Weave::twill,
           .thread = 0.4e-3,
           .translucency = 0.05,
           .sheen = 0.3,
           .gloss = 0.03,
           .weft_shade = 2.5}};
}

FabricPreset make_leather() {
  // Isotropic: c = Eh/(1 − ν²), c12 = ν c, g = Eh/(2 (1 + ν)) with Eh = 2000 N/m, ν = 0.35.
  Fabric f{.density = 0.52,
           .c11 = 2279,
           .c22 = 2279,
           .c12 = 798,
           .g = 741,
           .bend_warp = 22e-6,
           .bend_weft = 22e-6,
           .bend_bias = 22e-6,
           .thickness = 0.8e-3,
           .friction = 0.5};
  const std::string elastic =
      "typical: isotropic, 2.5 MPa at small strain times 0.8 mm, Poisson's ratio 0.35 (recalled)";
  return {"leather",
          "Sheep nappa for garments, 0.8 mm",
          f,
          {.density = "typical: 650 kg/m³ times 0.8 mm",
           .stretch = elastic,
           .shear = elastic,
           .bending = "the stiffest of four sheep garment leathers, 9.2 to 22 (Memon et al., Materials 14, "
                      "2021, 4553; unit taken as µN·m)",
           .damping = kDefaultDamping,
           .thickness = "middle of four sheep garment leathers, 0.64 to 0.96 mm (Memon et al. 2021)",
           .friction = "typical of leather on leather"},
          {.translucency = 0, .sheen = 0.05, .gloss = 0.6}};
}

/// Looks of the fabrics of Wang et al., from their names; the source shows no weave.
constexpr FabricLook kJersey = {.weave = Weave::knit, .thread = 0.7e-3, .translucency = 0.2, .sheen = 0.4};
constexpr FabricLook kThickKnit = {
    .weave = Weave::knit, .thread = 1.2e-3, .translucency = 0.1, .sheen = 0.55};
constexpr FabricLook kSwim = {
    .weave = Weave::knit, .thread = 0.4e-3, .translucency = 0.15, .sheen = 0.3, .gloss = 0.3};
constexpr FabricLook kTwill = {.weave = Weave::twill, .thread = 0.35e-3, .translucency = 0.1, .sheen = 0.3};
constexpr FabricLook kSatin = {
    .weave = Weave::satin, .thread = 0.2e-3, .translucency = 0.15, .sheen = 0.2, .gloss = 0.7};
constexpr FabricLook kPlain = {.weave = Weave::plain, .thread = 0.3e-3, .translucency = 0.2, .sheen = 0.25};

/// A row of Wang et al.: bending in 1e-6 N·m at zero curvature, at 0, 45 and 90° from warp.
FabricPreset measured(std::string name, std::string title, double density, double c11, double c22, double c12,
                      double g, double bend_0, double bend_45, double bend_90, const FabricLook& look) {
  const std::string wang = "measured: Wang, O'Brien, Ramamoorthi 2011";
  FabricPreset preset{std::move(name),
                      std::move(title),
                      {.density = density,
                       .c11 = c11,
                       .c22 = c22,
                       .c12 = c12,
                       .g = g,
                       .bend_warp = 1e-6 * bend_0,
                       .bend_weft = 1e-6 * bend_90,
                       .bend_bias = 1e-6 * bend_45},
                      {.density = wang,
                       .stretch = wang + ", at small strain",
                       .shear = wang,
                       .bending = wang + ", at zero curvature",
                       .damping = kDefaultDamping,
                       .thickness = kDefaultThickness,
                       .friction = kFriction},
                      look};
  return preset;
}

FabricPreset make_navy_sparkle_sweat() {
  FabricPreset preset = measured("navy_sparkle_sweat", "Sweater: navy sparkle", 0.224, 25.0, 6.5, 0, 17.6,
                                 14.87, 10.02, 11.41, kThickKnit);
  preset.sources.stretch +=
      "; c12 was measured as -39.8 N/m, which makes no positive definite matrix: 0 here, as in ARCSim";
  return preset;
}

std::vector<FabricPreset> make_presets() {
  return {
      make_silk(),
      make_cotton_shirting(),
      make_wool_suiting(),
      make_denim(),
      make_leather(),
      measured("gray_interlock", "T-shirt: gray interlock", 0.187, 33.2, 69.0, -29.4, 36.9, 5.80, 6.19, 3.57,
               kJersey),
      measured("11oz_black_denim", "Jeans: 11 oz black denim", 0.324, 410.7, 2027.8, 20.5, 53.4, 16.05, 18.35,
               24.24, kTwill),
      measured("white_dots_on_black", "Tablecloth: white dots on black", 0.128, 4004, 4055, 0.7, 19.2, 12.93,
               10.16, 7.82, kPlain),
      measured("royal_target", "Trousers: royal target", 0.220, 4033, 4070, 18.3, 104.8, 31.35, 27.00, 31.35,
               kTwill),
      measured("tango_red_jet_set", "Jacket: tango red jet set", 0.113, 86.1, 342.8, 108.7, 14.3, 3.57, 5.49,
               5.09, kSatin),
      measured("camel_ponte_roma", "Jacket: camel ponte roma", 0.284, 62.3, 88.1, -25.6, 31.9, 9.09, 8.25,
               9.29, kJersey),
      measured("ivory_rib_knit", "Underwear: ivory rib knit", 0.276, 85.7, 130.3, -0.5, 83.2, 11.56, 7.50,
               8.06, kThickKnit),
      measured("pink_ribbon_brown", "Blanket: pink ribbon brown", 0.228, 303, 489.7, 212.1, 30.3, 29.27,
               21.88, 14.94, kThickKnit),
      make_navy_sparkle_sweat(),
      measured("white_swim_solid", "Swimsuit: white swim solid", 0.204, 95.9, 209.2, 13.7, 60.8, 15.06, 14.70,
               12.75, kSwim),
  };
}

/// Canonical spelling of names: lower case, "_" between words.
std::string to_plain(std::string_view name) {
  std::string plain(name);
  for (char& c : plain) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    if (c == '-' || c == ' ') c = '_';
  }
  return plain;
}

}  // namespace

const std::vector<FabricPreset>& fabric_presets() {
  static const std::vector<FabricPreset> presets = make_presets();
  return presets;
}

const FabricPreset& find_fabric_preset(std::string_view name) {
  const std::string plain = to_plain(name);
  std::vector<std::string> names;
  std::string list;
  for (const FabricPreset& preset : fabric_presets()) {
    if (preset.name == plain) return preset;
    names.push_back(preset.name);
    list += (list.empty() ? "" : ", ") + preset.name;
  }
  const std::string message = "unknown fabric \"" + std::string(name) + "\"";
  const std::string nearest = engine::find_nearest(plain, names);
  throw InputError(nearest.empty() ? message + "; available: " + list
                                   : message + "; did you mean \"" + nearest + "\"?");
}

const Fabric& find_fabric(std::string_view name) { return find_fabric_preset(name).fabric; }

}  // namespace weft
