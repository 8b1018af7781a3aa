// What a part stands on, and what it weighs there, about the middle of its contacts.
#pragma once

#include "parts.hpp"
#include "shape.hpp"
#include "support.hpp"

namespace restshape::planks {

class Footing {
 public:
    Footing(const Piece& piece, const Shape<double>& shape, const Part& part);

    // Forces of its contacts that balance the loads of a case, within a tolerance, in parts of these. It begins with
    // forces that are near; without any it is sought from nothing.
    Support support(int load_case, double tolerance, const std::vector<ConeForce>& near = {}) const;

    // Puts these forces [N] in the places of its contacts among all.
    void put(const Support& support, int load_case, std::vector<V3<double>>& forces) const;

 private:
    const Piece& P;
    const Shape<double>& S;
    std::vector<char> mine_;      // of each plank, whether it belongs to the part
    std::vector<size_t> number_;  // of each of its contacts among all
    Contacts contacts_;
    V3<double> middle_{0.0, 0.0, 0.0};
    double reach_ = 1e-9;

    struct Sum {
        V3<double> force{0.0, 0.0, 0.0}, moment{0.0, 0.0, 0.0};
        double size = 0.0;
    };
    Sum own_;  // of the part's own weight

    void add(Sum& sum, const V3<double>& at, const V3<double>& force) const;

    // The loads of a case in parts of what their sizes add up to, which is the other one [N].
    std::pair<Wrench, double> load(int load_case) const;
};

}  // namespace restshape::planks
