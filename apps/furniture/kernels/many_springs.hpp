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
    // largest utilisation of each joint over all cases. Each equilibrium is found from rest. It ends at the first
    // springs with a flaw of `ending`.
    struct Found {
        std::vector<int> flaws;
        std::vector<std::vector<double>> utilisations;
        std::vector<bool> sprung;  // as `DesignCheck` has it
    };
    Found test(const double* gamma, int ending);

    // Whether some of the springs alone let a piece at design parameters (8 a plank) bear its loads, by reason of a
    // joint whose utilisation differs by more than `spread`. Each equilibrium is found from the last one with the same
    // springs, and fewer where that will do.
    bool decide(const double* gamma, double spread);

    // Lets the next ones be found from rest.
    void forget();

    long steps() const { return model_.steps(); }
    int joints() const { return static_cast<int>(model_.piece().joints.size()); }
    int parameters() const { return freedoms * model_.piece().count(); }

 private:
    Furniture model_;
    std::vector<Springs> springs_;
    std::vector<int> order_;  // in which springs are tried to decide: first those that did so last

    std::vector<std::vector<CaseState>> known_;  // with each of the springs

    void set(const Springs& springs) { model_.set_compliance(springs.eps_t, springs.eps_r, springs.eps_floor); }
};

}  // namespace restshape::planks
