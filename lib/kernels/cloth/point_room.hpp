// Contact of points with a body, without those that are known to be far from it: their distance is kept from where they
// were.
#pragma once

#include <cstddef>
#include <vector>

#include "cloth/contact.hpp"

namespace restshape {

class PointRoom {
 public:
    PointRoom(const Body& body, std::size_t count) : body_(body), known_(count) {}

    std::size_t count() const { return known_.size(); }
    // Distances that have been taken.
    std::size_t looks() const { return looks_; }

    // `add_contact` of a point, which adds nothing where that is known.
    double add(std::size_t i, const double* x, double area, double stiffness, double thickness, bool curved,
               double* potential) {
        Known& own = known_[i];
        double square = 0.0;
        for (int a = 0; a < 3; ++a) square += (x[a] - own.at[a]) * (x[a] - own.at[a]);
        const double room = certain * (own.distance - thickness) / body_.slope();
        if (room > 0.0 && square < room * room) return 0.0;
        ++looks_;
        const Distance d = body_.distance(x, curved);
        std::copy(x, x + 3, own.at);
        own.distance = d.value;
        return add_penalty(d, area, stiffness, thickness, curved, potential);
    }

 private:
    // Of a distance on a grid slopes are measured, not proven.
    static constexpr double certain = 0.9;
    struct Known {
        double at[3] = {0, 0, 0}, distance = 0.0;
    };

    Body body_;
    std::vector<Known> known_;
    std::size_t looks_ = 0;
};

}  // namespace restshape
