// Derivatives with respect to the design: A dx = db - dA x for all modes with one factor, and what follows from them.
#pragma once

#include <Eigen/Core>
#include <array>

#include "state.hpp"

namespace restshape::planks {

using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr int lanes = 8;
using Design = Dual<lanes>;

// Values and derivatives (modes in rows) of what limits are set on.
struct Derivatives {
    Rows x, bending, tension, shear_x, shear_y, normal, length;
};

class DesignDerivative {
 public:
    // directions: (m, 8 n) changes of the design parameters, [m] and [rad] a unit of the mode.
    DesignDerivative(const State& state, const double* directions, int m)
        : S(state), n_(8 * state.piece.count()), directions_(directions), m_(m) {}

    // The geometry must be that of the piece as it is, and the state of the case its equilibrium.
    Derivatives solve(int load_case);

    // Derivatives (m, rows) of the rows of stability of the piece as it is; their values in `values`, none without
    // directions.
    Rows stability(int load_case, std::vector<double>& values);

 private:
    State S;
    int n_;
    const double* directions_;
    int m_;
    Shape<Design> shape_;
    std::vector<Design> gamma_;

    int used(int first) const { return std::min(lanes, m_ - first); }

    void shape(int first);
};

// For each plank the design parameters that change the piece and keep all joints closed and all feet on the ground;
// of those that make the same change, the first among lengths, moves and turns (figure 6.13 of the thesis).
std::vector<std::array<int, 2>> valid_freedoms(const Piece& piece, double step);

}  // namespace restshape::planks
