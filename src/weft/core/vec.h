#pragma once
/// Small vectors and matrices (double precision) used everywhere outside the fast kernels.

#ifndef EIGEN_DONT_VECTORIZE
#error \
    "Eigen sums vectors in another order where it vectorises: compile all of Weft with EIGEN_DONT_VECTORIZE"
#endif

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace weft::engine {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;

}  // namespace weft::engine
