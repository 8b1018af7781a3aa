// Signed distance of a closed surface, interpolated on even grids by cubic B-splines: its second derivatives are
// continuous. Near the surface bricks of a fine grid are stored, elsewhere in a box a coarse grid alone.
//
// Source: docs/theory/cloth.md.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

namespace restshape {

// What the grid gives at a place, second derivatives as xx yy zz yz xz xy.
struct GridValue {
    double value, gradient[3], hessian[6];
};

class GridDistance {
 public:
    static constexpr int cells = 8, nodes = cells + 3;  // of a brick along each axis
    static constexpr int outside = -1;                  // in the table of bricks: farther from the body than the band

    struct Layout {
        double origin[3];  // corner of the first brick
        double spacing;    // of the fine grid
        int bricks[3];
        double low[3], high[3];  // box of the surface itself
        double band;             // within which there are bricks
        double slope;            // bound on gradients, from those that are measured
        double thin;             // half of how thick the body is where it is thin
        double sharpest;         // smallest radius of curvature
        double slack;            // by which the coarse grid is too large outside, at most
    };

    // table: numbers of bricks, z running fastest, `outside`, or less inside. fine: coefficients of bricks, x fastest.
    // coarse: those of the coarse grid, z fastest, of which one layer lies around the box. bent: of bricks, how much
    // the distance curves downwards at most.
    GridDistance(const Layout& layout, std::vector<int32_t> table, std::vector<float> fine, std::vector<double> coarse,
                 std::vector<double> bent)
        : layout_(layout),
          table_(std::move(table)),
          fine_(std::move(fine)),
          coarse_(std::move(coarse)),
          bent_(std::move(bent)) {
        std::size_t bricks = 1, lattice = 1;
        for (int n : layout_.bricks) {
            if (n < 1) throw std::invalid_argument("a grid has at least one brick along each axis");
            bricks *= n, lattice *= n + 3;
        }
        const int32_t count = static_cast<int32_t>(bent_.size());
        if (table_.size() != bricks || coarse_.size() != lattice)
            throw std::invalid_argument("the table or the coarse grid has the wrong size");
        if (fine_.size() != bent_.size() * nodes * nodes * nodes)
            throw std::invalid_argument("the bricks have the wrong size");
        if (!(layout_.spacing > 0)) throw std::invalid_argument("the spacing must be positive");
        if (std::any_of(table_.begin(), table_.end(), [count](int32_t k) { return k >= count; }))
            throw std::invalid_argument("the table names a brick that is not there");
    }

    const Layout& layout() const { return layout_; }

    // Whether a place is easily seen to be farther away than so much.
    bool beyond(const double* y, double far) const {
        for (int a = 0; a < 3; ++a)
            if (y[a] > layout_.high[a] + far || y[a] < layout_.low[a] - far) return true;
        int at[3];
        return far < layout_.band && brick_of(y, at) && number(at) == outside;
    }

    // Beyond the box it is the distance from the box of the surface, which is no more than that from the surface.
    GridValue at(const double* y, bool curved) const {
        int brick[3];
        if (!brick_of(y, brick)) return from_box(y);
        const int32_t own = number(brick);
        if (own >= 0) return fine(y, brick, own, curved);
        GridValue found = coarse(y, brick, curved);
        if (own == outside) found.value = std::max(found.value - layout_.slack, layout_.band);
        return found;
    }

    // How much the distance curves downwards within a radius of a place, at most; infinite where it is not known.
    double bent(const double* y, double radius) const {
        constexpr double unknown = std::numeric_limits<double>::infinity();
        if (radius > cells * layout_.spacing) return unknown;
        int low[3], high[3], at[3];
        for (int a = 0; a < 3; ++a) {
            low[a] = index(y[a] - radius, a), high[a] = index(y[a] + radius, a);
            if (low[a] < 0 || high[a] >= layout_.bricks[a]) return unknown;
        }
        double most = 0.0;
        for (at[0] = low[0]; at[0] <= high[0]; ++at[0])
            for (at[1] = low[1]; at[1] <= high[1]; ++at[1])
                for (at[2] = low[2]; at[2] <= high[2]; ++at[2]) {
                    const int32_t own = number(at);
                    if (own < 0) return unknown;
                    most = std::max(most, bent_[own]);
                }
        return most;
    }

 private:
    int index(double place, int axis) const {
        return static_cast<int>(std::floor((place - layout_.origin[axis]) / (cells * layout_.spacing)));
    }
    bool brick_of(const double* y, int* at) const {
        for (int a = 0; a < 3; ++a) {
            const double place = (y[a] - layout_.origin[a]) / (cells * layout_.spacing);
            if (!(place >= 0.0 && place < layout_.bricks[a])) return false;
            at[a] = static_cast<int>(place);
        }
        return true;
    }
    int32_t number(const int* at) const {
        return table_[(static_cast<std::size_t>(at[0]) * layout_.bricks[1] + at[1]) * layout_.bricks[2] + at[2]];
    }

    GridValue from_box(const double* y) const {
        GridValue found{0.0, {0, 0, 0}, {0, 0, 0, 0, 0, 0}};
        double square = 0.0;
        for (int a = 0; a < 3; ++a) {
            found.gradient[a] = y[a] - std::clamp(y[a], layout_.low[a], layout_.high[a]);
            square += found.gradient[a] * found.gradient[a];
        }
        found.value = std::sqrt(square);
        for (double& g : found.gradient) g /= found.value;
        return found;
    }

    GridValue fine(const double* y, const int* brick, int32_t own, bool curved) const {
        int cell[3];
        double t[3];
        for (int a = 0; a < 3; ++a) {
            const double place = (y[a] - layout_.origin[a]) / layout_.spacing - brick[a] * cells;
            cell[a] = std::clamp(static_cast<int>(place), 0, cells - 1);
            t[a] = place - cell[a];
        }
        const float* c = fine_.data() + static_cast<std::size_t>(own) * nodes * nodes * nodes +
                         (cell[2] * nodes + cell[1]) * nodes + cell[0];
        // x runs fastest.
        const double turned[3] = {t[0], t[1], t[2]};
        return spline(c, std::size_t(1), std::size_t(nodes), std::size_t(nodes) * nodes, turned, layout_.spacing,
                      curved);
    }

    GridValue coarse(const double* y, const int* brick, bool curved) const {
        const double wide = cells * layout_.spacing;
        const std::size_t along = layout_.bricks[2] + 3, plane = along * (layout_.bricks[1] + 3);
        double t[3];
        for (int a = 0; a < 3; ++a) t[a] = (y[a] - layout_.origin[a]) / wide - brick[a];
        const double* c = coarse_.data() + brick[0] * plane + brick[1] * along + brick[2];
        return spline(c, plane, along, std::size_t(1), t, wide, curved);
    }

    // Weights of four coefficients for a share t of a cell: of the value, the first and the second derivative.
    static void weights(double t, double inverse, double w[3][4]) {
        const double s = 1.0 - t;
        w[0][0] = s * s * s / 6, w[0][1] = (4 - 3 * t * t * (2 - t)) / 6;
        w[0][2] = (4 - 3 * s * s * (2 - s)) / 6, w[0][3] = t * t * t / 6;
        w[1][0] = -0.5 * s * s * inverse, w[1][1] = (1.5 * t - 2) * t * inverse;
        w[1][2] = (2 - 1.5 * s) * s * inverse, w[1][3] = 0.5 * t * t * inverse;
        const double square = inverse * inverse;
        w[2][0] = s * square, w[2][1] = (3 * t - 2) * square;
        w[2][2] = (3 * s - 2) * square, w[2][3] = t * square;
    }

    template <class C>
    static GridValue spline(const C* c, std::size_t sx, std::size_t sy, std::size_t sz, const double* t, double spacing,
                            bool curved) {
        double wx[3][4], wy[3][4], wz[3][4];
        weights(t[0], 1.0 / spacing, wx), weights(t[1], 1.0 / spacing, wy), weights(t[2], 1.0 / spacing, wz);
        return curved ? summed<C, 3>(c, sx, sy, sz, wx, wy, wz) : summed<C, 2>(c, sx, sy, sz, wx, wy, wz);
    }

    using Row = Eigen::Array<double, 4, 1>;  // four coefficients along x

    template <class C>
    static Row row_at(const C* from, std::size_t step) {
        if (step == 1) return Eigen::Map<const Eigen::Array<C, 4, 1>>(from).template cast<double>();
        return {double(from[0]), double(from[step]), double(from[2 * step]), double(from[3 * step])};
    }

    // Value and derivatives below an order, of products of weights along y, then along z, then along x.
    template <class C, int orders>
    static GridValue summed(const C* c, std::size_t sx, std::size_t sy, std::size_t sz, const double (&wx)[3][4],
                            const double (&wy)[3][4], const double (&wz)[3][4]) {
        Row sums[orders][orders];  // by the derivatives along y and along z
        for (int n = 0; n < orders; ++n)
            for (int o = 0; n + o < orders; ++o) sums[n][o].setZero();
        for (int k = 0; k < 4; ++k) {
            const Row rows[4] = {row_at(c + k * sz, sx), row_at(c + k * sz + sy, sx), row_at(c + k * sz + 2 * sy, sx),
                                 row_at(c + k * sz + 3 * sy, sx)};
            for (int n = 0; n < orders; ++n) {
                const Row line = (wy[n][0] * rows[0] + wy[n][1] * rows[1]) + (wy[n][2] * rows[2] + wy[n][3] * rows[3]);
                for (int o = 0; n + o < orders; ++o) sums[n][o] += wz[o][k] * line;
            }
        }
        const auto sum = [&](int m, int n, int o) {
            const Row& r = sums[n][o];
            return (wx[m][0] * r[0] + wx[m][1] * r[1]) + (wx[m][2] * r[2] + wx[m][3] * r[3]);
        };
        GridValue found{sum(0, 0, 0), {sum(1, 0, 0), sum(0, 1, 0), sum(0, 0, 1)}, {0, 0, 0, 0, 0, 0}};
        if constexpr (orders > 2) {
            const double h[6] = {sum(2, 0, 0), sum(0, 2, 0), sum(0, 0, 2), sum(0, 1, 1), sum(1, 0, 1), sum(1, 1, 0)};
            std::copy(h, h + 6, found.hessian);
        }
        return found;
    }

    Layout layout_;
    std::vector<int32_t> table_;
    std::vector<float> fine_;
    std::vector<double> coarse_, bent_;
};

}  // namespace restshape
