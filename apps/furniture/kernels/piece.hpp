// A piece of furniture: planks, nail joints, feet and loads.
#pragma once

#include <vector>

#include "vector.hpp"

namespace restshape::planks {

// Sides of a plank: -x, +x, -y, +y are its ends, -z and +z its faces.
inline int axis_of(int side) { return side / 2; }
inline double sign_of(int side) { return side % 2 ? 1.0 : -1.0; }

constexpr int freedoms = 8;  // of a plank: moves along its axes, turns about them, its two lengths

struct JointSpec {
    int i, side, j, face;
    double spacing, pull, shear;  // of a nail [m], [N], [N]
};
struct FootSpec {
    int plank, side, plane;
};
struct PlaneSpec {
    V3<double> point, normal;
    double mu;
};
struct LoadSpec {
    int plank;
    V3<double> place;  // in parts of the plank's size, from its centre
};

struct Settings {
    double eps_t = 1e-9, eps_r = 1e-9, eps_floor = 1e-9;
    double shift = 1e-9;          // of the diagonal, in parts of the stiffness
    double least_slant = 0.25;    // cosine between a plank and the normal of what its end meets
    double gap = 1e-6;            // of a closed joint [m]
    double least_overlap = 0.01;  // of a joint's length [m]
    double interference = 1e-4;   // of planks, that counts as touching [m]
    bool moments = false;         // those along a joint's line and about its normal count in durability
};

// What is wrong with the geometry, in the order of the tests.
enum class Fault { none = 0, slant = 1, length = 2, gap = 3, overlap = 4, foot = 5, behind = 6 };

// A fault and what has it: the end (4 plank + side) of slant and behind, the plank of length, else the joint or foot.
struct Flawed {
    Fault fault;
    int where;
};

struct Piece {
    std::vector<V3<double>> centre, size;
    std::vector<M3<double>> axes;
    std::vector<double> density;
    std::vector<JointSpec> joints;
    std::vector<FootSpec> feet;
    std::vector<PlaneSpec> planes;
    std::vector<LoadSpec> loads;
    std::vector<std::vector<V3<double>>> cases;  // the force of each load in each case
    V3<double> gravity{0.0, 0.0, -9.80665};
    Settings settings;

    // For each end of a plank the joint (k) or foot (-2 - k) that holds it, or -1.
    std::vector<int> held;

    int count() const { return static_cast<int>(centre.size()); }

    void find_held() {
        held.assign(4 * centre.size(), -1);
        const auto take = [this](int plank, int side, int by) {
            if (side < 4 && held[4 * plank + side] == -1) held[4 * plank + side] = by;
        };
        for (size_t k = 0; k < joints.size(); ++k) take(joints[k].i, joints[k].side, static_cast<int>(k));
        for (size_t k = 0; k < feet.size(); ++k) take(feet[k].plank, feet[k].side, -2 - static_cast<int>(k));
    }
};

}  // namespace restshape::planks
