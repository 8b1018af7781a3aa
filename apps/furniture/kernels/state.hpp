// What derivatives and the mixed form read of a piece: its geometry and the state of each load case.
#pragma once

#include <vector>

#include "law.hpp"
#include "shape.hpp"

namespace restshape::planks {

class Equilibrium;

struct CaseState {
    std::vector<double> x;     // 6 a plank
    Law law = Law::bilateral;  // that x is an equilibrium of
    bool found = false;
    bool close = false;            // it took the stiffness of close looks
    bool sprung = false;           // springs that also pull took the place of one-sided contacts that were not solved
    double unbalanced_load = 0.0;  // the part of the load that contacts cannot balance
};

struct State {
    const Piece& piece;
    Equilibrium& equilibrium;
    const Shape<double>& shape;
    const std::vector<CaseState>& cases;
};

}  // namespace restshape::planks
