#pragma once
/// Bullet's soft body as a method, if libbullet-dev is installed.

#include "lab/accuracy/method.h"

namespace weft::engine::lab {

/// Settings with several numbers of substeps; empty if Weft was built without Bullet.
std::vector<MethodSettings> list_bullet_entries();

/// Links with the springs' rest lengths. The stiffness 0…1 of a link is equivalent to the spring's k: Bullet
/// corrects by C kLST/W, XPBD by C/(W + 1/(h²k)). One position iteration per substep, no collisions, no drag,
/// no damping.
std::unique_ptr<Method> make_bullet_method(const MethodSettings& entry, const HungCloth& cloth);

}  // namespace weft::engine::lab
