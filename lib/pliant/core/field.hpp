#pragma once

#include <Eigen/Core>

namespace pliant {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// One vector per node or vertex: #rows x 3, each component contiguous.
using Field = Eigen::Matrix<double, Eigen::Dynamic, 3>;

}  // namespace pliant
