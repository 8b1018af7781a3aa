// Whether contacts with Coulomb friction can balance a load: a load's nearest point in the cone of what they can give.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "piece.hpp"

namespace restshape::planks {

using Wrench = Eigen::Matrix<double, 6, 1>;

struct Support {
    double unbalanced_load = 0.0;    // what remains of the load, in parts of it
    std::vector<V3<double>> forces;  // [load's unit] on the planks, at each contact
};

// The forces in the friction cones of contacts that come nearest to a load, within a tolerance in parts of it.
// load: force and moment about the origin that the contacts must give; lengths in units of the piece's size.
Support balance(const std::vector<V3<double>>& points, const std::vector<V3<double>>& normals,
                const std::vector<double>& mu, const Wrench& load, double tolerance);

}  // namespace restshape::planks
