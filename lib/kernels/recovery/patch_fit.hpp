// A linear polynomial through values at places around a node, by least squares.
#pragma once

#include <cmath>

#include "fem/pack.hpp"

namespace restshape {

// By the normal equations of 1, x, y, from the node on; a number of one node, or of several, a lane each.
template <class Number, int components>
struct PatchFit {
    Number b0[components] = {}, b1[components] = {}, b2[components] = {};
    Number count{}, x{}, y{}, xx{}, xy{}, yy{};
    Number c00{}, c01{}, c02{}, det{}, inverse{};

    [[gnu::always_inline]] void add(const Number& along, const Number& across, const Number (&value)[components]) {
        x += along, y += across, xx += along * along, xy += along * across, yy += across * across;
        for (int i = 0; i < components; ++i) b0[i] += value[i], b1[i] += along * value[i], b2[i] += across * value[i];
    }

    [[gnu::always_inline]] void solve(const Number& places) {
        count = places;
        c00 = xx * yy - xy * xy, c01 = y * xy - x * yy, c02 = x * xy - y * xx;
        det = count * c00 + x * c01 + y * c02;
        inverse = 1.0 / det;
    }

    // Whether there is one: the places do not lie on a line. Of several nodes, a mark in each lane.
    auto known() const { return (det > 1e-6 * count * xx * yy) | (-det > 1e-6 * count * xx * yy); }

    // At the node.
    [[gnu::always_inline]] Number here(int i) const {
        return (c00 * inverse) * b0[i] + (c01 * inverse) * b1[i] + (c02 * inverse) * b2[i];
    }

    // Its derivatives along the axes.
    [[gnu::always_inline]] Number by_x(int i) const {
        const Number c11 = count * yy - y * y, c12 = x * y - count * xy;
        return (c01 * inverse) * b0[i] + (c11 * inverse) * b1[i] + (c12 * inverse) * b2[i];
    }
    [[gnu::always_inline]] Number by_y(int i) const {
        const Number c12 = x * y - count * xy, c22 = count * xx - x * x;
        return (c02 * inverse) * b0[i] + (c12 * inverse) * b1[i] + (c22 * inverse) * b2[i];
    }
};

}  // namespace restshape
