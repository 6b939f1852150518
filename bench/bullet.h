#pragma once
/// Bullet's soft body as a contestant, where libbullet-dev is installed.

#include "weft/lab/contestant.h"

namespace weft::engine::bench {

/// At several numbers of substeps; empty where Weft was built without Bullet.
std::vector<ContestantSettings> list_bullet_entries();

/// Links with the springs' rest lengths, and per link the stiffness 0…1 that stands for the spring's k:
/// Bullet pushes ends apart by C kLST/W, XPBD by C/(W + 1/(h²k)). One position iteration per substep, no
/// collisions, no drag, no damping.
std::unique_ptr<Contestant> make_bullet_contestant(const ContestantSettings& entry, const HungCloth& cloth);

}  // namespace weft::engine::bench
