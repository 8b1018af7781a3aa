// What springs of other compliances make of a piece: its equilibria with each of them, on one geometry.
#pragma once

#include "furniture.hpp"

namespace restshape::planks {

// Compliances of joints and of the floor.
struct Springs {
    double eps_t, eps_r, eps_floor;
};

class ManySprings {
 public:
    ManySprings(Piece piece, std::vector<Springs> springs);

    // What a full test at design parameters (8 a plank) finds with each of the springs: its flaws, as bits, and the
    // largest utilisation of each joint over all cases. It ends at the first springs with a flaw of `ending`.
    struct Found {
        std::vector<int> flaws;
        std::vector<std::vector<double>> utilisations;
    };
    Found test(const double* gamma, int ending);

    // Starts the next test from rest.
    void forget();

    int joints() const { return static_cast<int>(model_.piece().joints.size()); }
    int parameters() const { return freedoms * model_.piece().count(); }

 private:
    Furniture model_;
    std::vector<Springs> springs_;
    std::vector<std::vector<CaseState>> states_;  // of each of the springs
};

}  // namespace restshape::planks
