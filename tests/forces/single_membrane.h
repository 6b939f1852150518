#pragma once
/// A single triangle as a patch.

#include "weft/forces/membrane_patch.h"

namespace weft::engine::test {

inline MembranePatch make_single_patch(const RestTriangle& rest) {
  return make_single_patches({{{0, 1, 2}, rest}})[0];
}

inline PatchCorners to_patch(const TriangleCorners& x) { return {x[0], x[1], x[2], Vec3::Zero()}; }

inline double membrane_energy(const RestTriangle& rest, const MembraneLaw& law, const TriangleCorners& x) {
  return patch_energy(make_single_patch(rest), PatchLaw(law, {}), to_patch(x));
}

inline TriangleCorners membrane_force(const RestTriangle& rest, const MembraneLaw& law,
                                      const TriangleCorners& x) {
  const PatchCorners force = patch_force(make_single_patch(rest), PatchLaw(law, {}), to_patch(x));
  return {force[0], force[1], force[2]};
}

/// Blocks of the Hessian.
struct MembraneHessian {
  MembranePatch patch;
  PatchHessian hessian;
};

inline MembraneHessian membrane_hessian(const RestTriangle& rest, const MembraneLaw& law,
                                        const TriangleCorners& x) {
  const MembranePatch patch = make_single_patch(rest);
  return {patch, patch_hessian(patch, PatchLaw(law, {}), to_patch(x))};
}

inline Mat3 membrane_block(const MembraneHessian& h, int a, int b, StressFilter filter) {
  return patch_block(h.patch, h.hessian, a, b, filter);
}

}  // namespace weft::engine::test
