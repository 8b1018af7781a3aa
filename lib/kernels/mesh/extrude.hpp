// Bodies over a plane mesh: columns of nodes over its nodes, three tetrahedra in each prism over its triangles.
#pragma once

#include <algorithm>
#include <cstdint>

#include "fem/shapes.hpp"

namespace restshape {

// Columns of `levels` nodes over plane nodes: z runs from -datum h to (1 - datum) h, where h is the thickness.
// The map is linear, so that it takes velocities to velocities as well.
inline void extrude_nodes(const double* plane, const double* thickness, std::ptrdiff_t count, int levels, double datum,
                          double* X) {
    const double step = 1.0 / (levels - 1);
    for (std::ptrdiff_t i = 0; i < count; ++i)
        for (int k = 0; k < levels; ++k, X += 3) {
            X[0] = plane[2 * i];
            X[1] = plane[2 * i + 1];
            X[2] = (k * step - datum) * thickness[i];
        }
}

// Splits prisms by the places of their plane nodes in some order, so that neighbours agree on the diagonals of the
// sides between them: each goes up from the node of the smaller place, in every other layer down. Two layers are thus
// mirror images. Source: Dompierre, Labbe, Vallet and Camarero, How to subdivide pyramids, prisms and hexahedra into
// tetrahedra (1999).
class PrismSplit {
 public:
    // Plane cells have 3 or 6 nodes; tetrahedra of the same order come out.
    PrismSplit(int plane_nodes, int layers) : quadratic_(plane_nodes == 6), layers_(layers) {}

    int nodes() const { return quadratic_ ? 10 : 4; }
    int levels() const { return quadratic_ ? 2 * layers_ + 1 : layers_ + 1; }

    // Writes the 3 * layers tetrahedra over one plane cell; `places` are those of all plane nodes.
    void split(const std::int32_t* cell, const std::int32_t* places, std::int32_t* out) const {
        int order[3] = {0, 1, 2};
        std::sort(order, order + 3, [cell, places](int a, int b) { return places[cell[a]] < places[cell[b]]; });
        const bool even = (order[1] - order[0] + 3) % 3 == 1;
        for (int layer = 0; layer < layers_; ++layer)
            for (int t = 0; t < 3; ++t, out += nodes()) write(cell, order, layer, t, even == (layer % 2 == 0), out);
    }

 private:
    struct Corner {
        int place, level;  // in the plane cell; in half layers
    };

    void write(const std::int32_t* cell, const int (&order)[3], int layer, int t, bool upright,
               std::int32_t* out) const {
        // Corners by rank of their places, and whether at the end of the diagonals' way.
        static constexpr int tets[3][4][2] = {
            {{0, 0}, {1, 0}, {2, 0}, {2, 1}}, {{0, 0}, {1, 0}, {2, 1}, {1, 1}}, {{0, 0}, {0, 1}, {1, 1}, {2, 1}}};
        Corner corner[4];
        for (int i = 0; i < 4; ++i) {
            const int above = layer % 2 == 0 ? tets[t][i][1] : 1 - tets[t][i][1];
            corner[i] = {order[tets[t][i][0]], 2 * (layer + above)};
        }
        if (!upright) std::swap(corner[2], corner[3]);
        for (int i = 0; i < 4; ++i) out[i] = node(cell, corner[i], corner[i]);
        if (!quadratic_) return;
        for (int m = 0; m < 6; ++m)
            out[4 + m] = node(cell, corner[Quadratic<3>::sides[m][0]], corner[Quadratic<3>::sides[m][1]]);
    }

    // The node in the middle of two corners.
    std::int32_t node(const std::int32_t* cell, Corner a, Corner b) const {
        static constexpr int middle[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
        const int half_layers = (a.level + b.level) / 2;
        return cell[middle[a.place][b.place]] * levels() + (quadratic_ ? half_layers : half_layers / 2);
    }

    bool quadratic_;
    int layers_;
};

}  // namespace restshape
