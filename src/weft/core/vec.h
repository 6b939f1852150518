#pragma once
/// Small vectors and matrices (double precision) used everywhere outside the fast kernels.

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace weft::engine {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;

}  // namespace weft::engine
