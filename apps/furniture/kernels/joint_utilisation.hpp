// The forces of a joint from its openings, and the utilisation of its fasteners' strength.
#pragma once

#include <cmath>
#include <limits>

#include "shape.hpp"

namespace restshape::planks {

template <class T>
struct JointForce {
    T tension, shear_x, shear_y, bending, twist_x, twist_n;  // [N], [N m]
};

// The joint forces in the frame of each joint, from its openings d (6).
template <class T>
JointForce<T> joint_force(const JointShape<T>& joint, const T* d, const Settings& settings) {
    const V3<T> ht = scaled(V3<T>{d[0], d[1], d[2]}, 1.0 / settings.eps_t);
    const V3<T> hr = scaled(V3<T>{d[3], d[4], d[5]}, 1.0 / settings.eps_r);
    return {dot(ht, joint.n), dot(ht, joint.x), dot(ht, joint.y), dot(hr, joint.y), dot(hr, joint.x), dot(hr, joint.n)};
}

// What the fasteners of a joint bear of its forces, in parts of their strength (docs/theory/furniture.md). `line` is of
// the moment that bends it along its line, about the end of that; `twist` of the one about its normal.
struct JointUtilisation {
    double pull, shear, line, twist;
};

// Of the moment that one fastener bears about its line: a fainter twist of it is not looked at.
constexpr double faint_twist = 0.01;

inline JointUtilisation joint_utilisation(const JointForce<double>& f, const JointShape<double>& joint,
                                          const JointSpec& spec, double lever) {
    const double n = joint.nails, length = joint.length, turn = std::abs(f.twist_n);
    const double alone = turn > faint_twist * 0.5 * lever * spec.pull ? std::numeric_limits<double>::infinity() : 0.0;
    return {(2.0 * std::abs(f.bending) / lever + f.tension) / n / spec.pull,
            std::hypot(f.shear_x, f.shear_y) / n / spec.shear,
            (6.0 * std::abs(f.twist_x) / (length * (2.0 * n + 1.0)) + f.tension / n) / spec.pull,
            n > 1.0 ? 6.0 * turn / (length * (n + 1.0)) / spec.shear : alone};
}

}  // namespace restshape::planks
