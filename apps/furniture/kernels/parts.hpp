// What hangs together in a piece, and what holds it.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "piece.hpp"

namespace restshape::planks {

using Motion = Eigen::Matrix<double, 6, 1>;  // a small displacement and rotation

// Planks that joints connect: what holds them to the ground, and motions that nothing holds.
struct Part {
    std::vector<int> planks;
    int carrier = -1;  // the plank that free motions are held at
    bool grounded = false;
    std::vector<Motion> free;  // of the carrier
};

std::vector<Part> parts_of(const Piece& piece);

// Motions that a stiffness (6 x 6) leaves free, by its eigenvectors; `reach` [m] is how far from their point it acts.
std::vector<Motion> free_motions(const Eigen::Matrix<double, 6, 6>& stiffness, double reach);

}  // namespace restshape::planks
