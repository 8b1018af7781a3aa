// The geometry of a piece at any values of its design parameters.
#pragma once

#include <vector>

#include "piece.hpp"

namespace restshape::planks {

template <class T>
struct JointShape {
    V3<T> p, n, x, y, arm_i, arm_j;
    T length;
    double nails;
    Fault fault;
};

template <class T>
struct Contact {
    int plank;
    V3<T> point, arm;
    V3<double> normal;
    double mu;
};

template <class T>
struct Shape {
    std::vector<V3<T>> centre, size;
    std::vector<M3<T>> axes;
    std::vector<T> mass;
    std::vector<JointShape<T>> joints;
    std::vector<Contact<T>> contacts;  // four of each foot
    std::vector<V3<T>> load_arms;
    std::vector<Fault> foot_faults;
    std::vector<Flawed> faults;

    Fault fault() const { return faults.empty() ? Fault::none : faults.front().fault; }
    // Whether an end or a length cannot be had, so that what follows has no numbers.
    bool invalid() const {
        for (const Flawed& one : faults)
            if (one.fault == Fault::slant || one.fault == Fault::behind || one.fault == Fault::length) return true;
        return false;
    }
};

}  // namespace restshape::planks
