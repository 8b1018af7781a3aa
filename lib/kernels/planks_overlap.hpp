// Planks that pass through each other: the fifteen separating axes of two boxes.
#pragma once

#include <utility>
#include <vector>

#include "planks_piece.hpp"

namespace restshape::planks {

// How deep two boxes overlap [m] along the axis of least depth (Gottschalk, Lin and Manocha, OBBTree, 1996);
// negative when they are apart.
inline double depth(const V3<double>& ca, const M3<double>& qa, const V3<double>& la, const V3<double>& cb,
                    const M3<double>& qb, const V3<double>& lb) {
    const V3<double> apart = cb - ca;
    const double ra = 0.25 * dot(la, la), rb = 0.25 * dot(lb, lb), far = dot(apart, apart);
    if (far > ra + rb + 2.0 * std::sqrt(ra * rb)) return std::sqrt(ra) + std::sqrt(rb) - std::sqrt(far);
    double least = 1e300;
    const auto test = [&](const V3<double>& axis) {
        const double size2 = dot(axis, axis);
        // Edges that are parallel give no axis of their own.
        if (size2 < 1e-12) return;
        double reach = 0.0;
        for (int k = 0; k < 3; ++k)
            reach += 0.5 * (la[k] * std::abs(dot(column(qa, k), axis)) + lb[k] * std::abs(dot(column(qb, k), axis)));
        least = std::min(least, (reach - std::abs(dot(apart, axis))) / std::sqrt(size2));
    };
    for (int k = 0; k < 3; ++k) test(column(qa, k)), test(column(qb, k));
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) test(cross(column(qa, a), column(qb, b)));
    return least;
}

// Pairs of planks without a joint that overlap by more than `allowed` [m].
inline std::vector<std::pair<int, int>> overlaps(const Piece& piece, const Shape<double>& shape, bool first_only) {
    const int n = piece.count();
    std::vector<char> joined(n * n, 0);
    for (const JointSpec& joint : piece.joints) joined[joint.i * n + joint.j] = joined[joint.j * n + joint.i] = 1;
    std::vector<std::pair<int, int>> found;
    for (int i = 0; i < n; ++i)
        for (int j = i + 1; j < n; ++j) {
            if (joined[i * n + j]) continue;
            if (depth(shape.centre[i], shape.axes[i], shape.size[i], shape.centre[j], shape.axes[j], shape.size[j]) >
                piece.settings.interference) {
                found.emplace_back(i, j);
                if (first_only) return found;
            }
        }
    return found;
}

}  // namespace restshape::planks
