// How much nodes count in a mean over facets, by their length, or over triangles, by their area.
#pragma once

#include <cmath>
#include <cstdint>

namespace restshape {

struct Place {
    double x, y;
    friend Place operator-(Place a, Place b) { return {a.x - b.x, a.y - b.y}; }
    friend Place operator+(Place a, Place b) { return {a.x + b.x, a.y + b.y}; }
    friend Place operator*(double c, Place a) { return {c * a.x, c * a.y}; }
};
inline double cross(Place a, Place b) { return a.x * b.y - a.y * b.x; }

// Lengths that stand for the nodes of a facet: both ends, and of second order the middle, by Simpson's rule.
inline void facet_weights(const Place* P, int nodes, double* w) {
    const Place chord = P[1] - P[0];
    if (nodes == 2) {
        w[0] = w[1] = 0.5 * std::hypot(chord.x, chord.y);
        return;
    }
    const Place bend = 2.0 * (P[0] + P[1] - 2.0 * P[2]), tangents[3] = {chord - bend, chord + bend, chord};
    constexpr double simpson[3] = {1.0 / 6, 1.0 / 6, 4.0 / 6};
    for (int i = 0; i < 3; ++i) w[i] = simpson[i] * std::hypot(tangents[i].x, tangents[i].y);
}

// Areas that stand for the nodes of a triangle; of second order its corners count nothing.
inline void cell_weights(const Place* P, int nodes, double* w) {
    const double third = cross(P[1] - P[0], P[2] - P[0]) / 6.0;
    for (int i = 0; i < 3; ++i) w[i] = nodes == 3 ? third : 0.0;
    if (nodes == 3) return;
    for (int k = 0; k < 3; ++k) {
        // At the middle of a side: the tangents along it and towards the corner beyond.
        const int first = k, second = (k + 1) % 3, beyond = (k + 2) % 3;
        const Place across =
            2.0 * (P[3 + second] + P[3 + beyond] - P[3 + k]) - P[beyond] - 0.5 * (P[first] + P[second]);
        w[3 + k] = cross(P[second] - P[first], across) / 6.0;
    }
}

}  // namespace restshape
