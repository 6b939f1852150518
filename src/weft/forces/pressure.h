#pragma once
/// Gauge pressure of gas inside closed cloth: in excess of the air outside.
///
///     E(V) = −p V                                 kept pressure p
///     E(V) = a V₀ (u − 1 − ln u),  u = V / V₀     sealed gas, isothermal (Boyle): excess a (1/u − 1)
///     V = Σ xa·(xb × xc) / 6                      over the triangles a b c
///
/// with the outside's pressure a, and V₀ = Gas::sealed_volume. Each particle's force is excess · ∂V/∂x. Of the
/// Hessian only E″ ∂V ∂Vᵀ is positive semidefinite: excess · ∂²V turns forces with the surface, and is left out.

#include <memory>
#include <span>

#include "weft/forces/term.h"
#include "weft/mesh/solid.h"
#include "weft/model/cloth_model.h"
#include "weft/model/cloth_state.h"

namespace weft::engine {

inline constexpr double kAirPressure = 101325;  // outside: standard atmosphere [Pa]

/// Sealed gas that has this excess at this volume > 0. `pressure` > −kAirPressure [Pa, m³].
Gas seal_gas(double pressure, double volume);

/// E [J]: infinite for sealed gas without a volume.
double gas_energy(const Gas& gas, double volume);

/// Excess over the outside: −E′ [Pa].
double gas_excess(const Gas& gas, double volume);

/// E″ ≥ 0 [Pa/m³].
double gas_stiffness(const Gas& gas, double volume);

/// Adds the volume's gradient by add(v, part) [m²]: at each vertex a third of its triangles' vector areas.
template <class At, class Add>
void add_volume_gradient(std::span<const Triangle> triangles, const At& at, const Add& add) {
  for (const auto& [a, b, c] : triangles) {
    const Vec3 third = (at(b) - at(a)).cross(at(c) - at(a)) / 6;
    for (const int v : {a, b, c}) add(v, third);
  }
}

/// Null without gas. Of its Hessian it has the part of rank one.
std::unique_ptr<Term> make_gas_term(const ClothModel& model, const ClothState& state);

}  // namespace weft::engine
