// Loads on the nodes of a new mesh whose solutions are the projections of a motion on the mesh before: sums over points
// of the new cells, several points of a cell at once. Source: docs/theory/solids.md.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <vector>

#include "fem/pack.hpp"
#include "fem/shapes.hpp"

namespace restshape {

// Triangles of so many nodes, with a displacement.
struct DisplacedCells {
    const double *X, *u;  // (n, 2)
    const int32_t* cells;
    std::ptrdiff_t count;
};

// The points of all cells of a new mesh: reference coordinates, weights that sum to 1, and for each point of the first
// cell, then of the others, the cell of the mesh before and the values of its basis there.
struct CellPoints {
    const double *at, *weight;
    std::ptrdiff_t count;
    const int32_t* found;
    const double* values;
};

template <int nodes>
using TriangleBasis = std::conditional_t<nodes == 6, Quadratic<2>, Linear<2>>;

// The basis at the points of a cell, in packs; points beyond the last repeat it, without weight.
template <int nodes>
class PackedBasis {
 public:
    struct At {
        Pack value[nodes], slope[nodes][2], weight;
        std::ptrdiff_t point[pack_lanes];
    };

    explicit PackedBasis(const CellPoints& points) : packs_((points.count + pack_lanes - 1) / pack_lanes) {
        for (std::size_t k = 0; k < packs_.size(); ++k)
            for (int lane = 0; lane < pack_lanes; ++lane) {
                const std::ptrdiff_t wanted = pack_lanes * static_cast<std::ptrdiff_t>(k) + lane;
                const std::ptrdiff_t q = std::min(wanted, points.count - 1);
                double value[nodes], slope[nodes][2];
                TriangleBasis<nodes>::values(points.at + 2 * q, value);
                TriangleBasis<nodes>::slopes(points.at + 2 * q, slope);
                for (int i = 0; i < nodes; ++i) {
                    packs_[k].value[i][lane] = value[i];
                    for (int a = 0; a < 2; ++a) packs_[k].slope[i][a][lane] = slope[i][a];
                }
                packs_[k].weight[lane] = wanted == q ? points.weight[q] : 0.0;
                packs_[k].point[lane] = q;
            }
    }

    const std::vector<At>& packs() const { return packs_; }

 private:
    std::vector<At> packs_;
};

// Slopes of x, y, u and v along both directions of a cell, in this order.
struct Slopes8 {
    alignas(64) double along[8] = {};
};

// Those at the corners of each cell, of which all others are mixtures; of first order they are the same everywhere.
template <int nodes>
class CornerSlopes {
 public:
    static constexpr int corners = nodes == 6 ? 3 : 1;

    explicit CornerSlopes(const DisplacedCells& old) : slopes_(static_cast<std::size_t>(corners) * old.count) {
        constexpr double at[3][2] = {{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}};
        double slope[corners][nodes][2];
        for (int k = 0; k < corners; ++k) TriangleBasis<nodes>::slopes(at[k], slope[k]);
        for (std::ptrdiff_t e = 0; e < old.count; ++e) {
            Slopes8* own = slopes_.data() + corners * e;
            for (int i = 0; i < nodes; ++i) {
                const std::size_t node = 2 * static_cast<std::size_t>(old.cells[nodes * e + i]);
                const double at_node[4] = {old.X[node], old.X[node + 1], old.u[node], old.u[node + 1]};
                for (int k = 0; k < corners; ++k)
                    for (int a = 0; a < 2; ++a)
                        for (int c = 0; c < 4; ++c) own[k].along[4 * a + c] += slope[k][i][a] * at_node[c];
            }
        }
    }

    // Those at a point of a cell where the basis has these values.
    Slopes8 at(std::int32_t cell, const double* value) const {
        const Slopes8* own = slopes_.data() + corners * static_cast<std::size_t>(cell);
        if constexpr (corners == 1) return own[0];
        // Of a side's middle half counts to either end.
        Slopes8 sum;
        for (int k = 0; k < corners; ++k) {
            const double part = value[k] + 0.5 * (value[3 + k] + value[3 + (k + 2) % 3]);
            for (int c = 0; c < 8; ++c) sum.along[c] += part * own[k].along[c];
        }
        return sum;
    }

 private:
    std::vector<Slopes8> slopes_;
};

// The gradient of a displacement at several points.
struct PackedGradient {
    Pack area, xx, xy, yx, yy;  // twice the area; u by x and y, v by x and y

    // Of slopes of x, y, u, v along one direction, then along the other.
    explicit PackedGradient(const Pack* s) : area(s[0] * s[5] - s[4] * s[1]) {
        xx = (s[2] * s[5] - s[6] * s[1]) / area, xy = (s[6] * s[0] - s[2] * s[4]) / area;
        yx = (s[3] * s[5] - s[7] * s[1]) / area, yy = (s[7] * s[0] - s[3] * s[4]) / area;
    }
};

inline double sum_of(const Pack& a) {
    double sum = 0.0;
    for (int lane = 0; lane < pack_lanes; ++lane) sum += a[lane];
    return sum;
}

// Adds to `forces` (n, 2) those of the strains that the new displacement lacks beside that of the mesh before.
//
// moduli: Lame's two and the thickness of each new cell, or of all where `stride` is 0. means: (count of old cells) of
// the dilatation, where the elements take its mean over a cell; else null.
template <int nodes>
void add_lacking_forces(const DisplacedCells& old, const DisplacedCells& fresh, const CellPoints& points,
                        const double* moduli, int stride, const double* means, double* forces) {
    const CornerSlopes<nodes> before(old);
    const PackedBasis<nodes> basis(points);
    const auto& packs = basis.packs();
    // Of each pack of points: slopes of the new mesh, what is lacking, half the area by weight, the dilatation lacking.
    struct Found {
        Pack slope[8], xx, yy, shear, part, dilatation;
    };
    std::vector<Found> found(packs.size());
    for (std::ptrdiff_t e = 0; e < fresh.count; ++e) {
        const int32_t* cell = fresh.cells + nodes * e;
        double there_mean = 0.0, here_mean = 0.0, area = 0.0;
        for (std::size_t k = 0; k < packs.size(); ++k) {
            const auto& p = packs[k];
            Found& f = found[k];
            Pack there[8 / pack_lanes][pack_lanes], dilatation{};
            for (int lane = 0; lane < pack_lanes; ++lane) {
                const std::ptrdiff_t point = points.count * e + p.point[lane];
                const Slopes8 own = before.at(points.found[point], points.values + nodes * point);
                for (int part = 0; part < 8 / pack_lanes; ++part)
                    std::memcpy(&there[part][lane], own.along + part * pack_lanes, sizeof(Pack));
                if (means) dilatation[lane] = means[points.found[point]];
            }
            for (auto& part : there) transpose(part);
            for (Pack& s : f.slope) s = Pack{};
            for (int i = 0; i < nodes; ++i) {
                const std::size_t node = 2 * static_cast<std::size_t>(cell[i]);
                const double own[4] = {fresh.X[node], fresh.X[node + 1], fresh.u[node], fresh.u[node + 1]};
                for (int a = 0; a < 2; ++a)
                    for (int c = 0; c < 4; ++c) f.slope[4 * a + c] += own[c] * p.slope[i][a];
            }
            const PackedGradient was(there[0]), is(f.slope);
            f.xx = was.xx - is.xx, f.yy = was.yy - is.yy, f.shear = was.xy - is.xy + was.yx - is.yx;
            f.part = p.weight * is.area, f.dilatation = f.xx + f.yy;
            if (means) {
                area += sum_of(f.part);
                there_mean += sum_of(f.part * dilatation), here_mean += sum_of(f.part * (is.xx + is.yy));
            }
        }
        const double *own = moduli + stride * e, lame = own[0], shear = own[1], half = 0.5 * own[2];
        Pack sum[nodes][2] = {};
        for (std::size_t k = 0; k < packs.size(); ++k) {
            const auto& p = packs[k];
            Found& f = found[k];
            if (means) f.dilatation = Pack{} + (there_mean - here_mean) / area;
            // Of stresses over twice the area, times the work's share: its slopes below are those of that area.
            const Pack work = half * p.weight, pressure = lame * f.dilatation;
            const Pack xx = work * (pressure + 2.0 * shear * f.xx), yy = work * (pressure + 2.0 * shear * f.yy);
            const Pack xy = work * shear * f.shear;
            const Pack *a = f.slope, *b = f.slope + 4;
            const Pack along[2][2] = {{xx * b[1] - xy * b[0], xy * b[1] - yy * b[0]},
                                      {xy * a[0] - xx * a[1], yy * a[0] - xy * a[1]}};
            for (int i = 0; i < nodes; ++i)
                for (int c = 0; c < 2; ++c) sum[i][c] += p.slope[i][0] * along[0][c] + p.slope[i][1] * along[1][c];
        }
        for (int i = 0; i < nodes; ++i)
            for (int c = 0; c < 2; ++c) forces[2 * static_cast<std::size_t>(cell[i]) + c] += sum_of(sum[i][c]);
    }
}

// Adds to `momenta` (n, 2) those of velocities v (n, 2) of the mesh before; density: mass an area of each new cell, or
// of all where `stride` is 0.
inline void add_momenta(const int32_t* old_cells, const double* v, const double* X, const int32_t* cells,
                        std::ptrdiff_t count, const CellPoints& points, const double* density, int stride,
                        double* momenta) {
    constexpr int nodes = 6;
    const PackedBasis<nodes> basis(points);
    for (std::ptrdiff_t e = 0; e < count; ++e) {
        const int32_t* cell = cells + nodes * e;
        Pack sum[nodes][2] = {};
        for (const auto& p : basis.packs()) {
            Pack velocity[2] = {}, slope[2][2] = {};
            for (int lane = 0; lane < pack_lanes; ++lane) {
                const std::ptrdiff_t point = points.count * e + p.point[lane];
                const int32_t* from = old_cells + nodes * static_cast<std::size_t>(points.found[point]);
                const double* value = points.values + nodes * point;
                double x = 0.0, y = 0.0;
                for (int i = 0; i < nodes; ++i) {
                    const std::size_t node = 2 * static_cast<std::size_t>(from[i]);
                    x += value[i] * v[node], y += value[i] * v[node + 1];
                }
                velocity[0][lane] = x, velocity[1][lane] = y;
            }
            for (int i = 0; i < nodes; ++i)
                for (int c = 0; c < 2; ++c) {
                    const double place = X[2 * static_cast<std::size_t>(cell[i]) + c];
                    for (int a = 0; a < 2; ++a) slope[a][c] += place * p.slope[i][a];
                }
            const Pack area = slope[0][0] * slope[1][1] - slope[1][0] * slope[0][1];
            const Pack mass = 0.5 * density[stride * e] * p.weight * area;
            for (int i = 0; i < nodes; ++i)
                for (int c = 0; c < 2; ++c) sum[i][c] += p.value[i] * mass * velocity[c];
        }
        for (int i = 0; i < nodes; ++i)
            for (int c = 0; c < 2; ++c) momenta[2 * static_cast<std::size_t>(cell[i]) + c] += sum_of(sum[i][c]);
    }
}

}  // namespace restshape
