// Ends of planks that nothing holds, and what they missed.
#pragma once

#include <utility>
#include <vector>

#include "vector.hpp"

namespace restshape::planks {

// Planks as they lie: what ends are looked at among.
struct LyingPlanks {
    std::vector<V3<double>> centre, size;
    std::vector<M3<double>> axes;
    std::vector<std::pair<int, int>> joined;  // planks that joints connect: whose end, at whose face
    std::vector<int> joined_side;             // of each of these, the side of the end
    std::vector<char> held;                   // whether something holds a side (6 a plank)
    V3<double> floor_point, floor_normal;
};

// Which ends count as near [m]: how far joints reach; how far before an end, beside a face and in or behind it is
// looked; what is flush, and rounding at an edge. The least slant is a cosine.
struct Nearness {
    double reach, far, aside, beyond, flush, edge, least_slant;
};

// An end `side` (0 to 3) of a plank that nothing holds, before plank `other`, -1: the floor.
struct FreeEnd {
    int plank, side, other;
    double gap;                     // how far along the plank's line the face is [m]; negative behind it
    double aside = 0.0;             // how far the centre line of the end passes beside the face [m]
    bool tilted = false;            // the end's edge does not lie along the face
    V3<double> way{0.0, 0.0, 0.0};  // how the plank goes sideways for all of the end to lie on the face [m]
    bool edge = false;              // it meets an edge of the other plank
};

// The free ends along the longer sides of some planks, of each end the nearest thing that it missed.
std::vector<FreeEnd> free_ends(const LyingPlanks& lying, const Nearness& near, const std::vector<int>& planks);

}  // namespace restshape::planks
