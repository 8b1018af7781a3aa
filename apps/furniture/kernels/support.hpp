// Whether contacts with Coulomb friction can balance a load: a load's nearest point in the cone of what they can give.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "piece.hpp"

namespace restshape::planks {

using Wrench = Eigen::Matrix<double, 6, 1>;

// Contacts of a part with the ground; lengths in units of the part's size.
struct Contacts {
    std::vector<V3<double>> points, normals;
    std::vector<double> mu;
};

// A force of unit normal part inside the friction cone of a contact, and its weight in a sum.
struct ConeForce {
    int contact;
    V3<double> force;
    double weight;
};

struct Support {
    double unbalanced_load = 0.0;   // what remains of the load, in parts of it
    std::vector<ConeForce> forces;  // [load's unit] on the planks: those of a contact add up
    int fits = 0;                   // least squares that it took
};

// The forces in the friction cones of contacts that come nearest to a load, within a tolerance in parts of it.
// load: force and moment about the origin that the contacts must give.
Support balance(const Contacts& contacts, const Wrench& load, double tolerance);

// The same from forces that were found for contacts and loads near these. It is sought as above from none, and where
// the search from there proves neither that forces balance the load, nor that none do.
Support balance_from(const std::vector<ConeForce>& near, const Contacts& contacts, const Wrench& load,
                     double tolerance);

}  // namespace restshape::planks
