// Extends displacements of the boundary into a triangle mesh by Laplace's equation.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <vector>

#include "algebra/scalar_cholesky.hpp"

namespace restshape {

// Linear triangles; the factor serves any number of boundary values. With equal weights linear functions are
// reproduced. Of a part of a mesh the border, nodes that it shares with other parts, is no pivot of the factor:
// `reduce` gives what is left for it, `complete` takes what others have found there.
class HarmonicExtension {
 public:
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

    HarmonicExtension(const double* X, std::int32_t node_count, const std::int32_t* cells, std::int32_t cell_count,
                      const std::int32_t* boundary, std::int32_t boundary_count, const std::int32_t* border = nullptr,
                      std::int32_t border_count = 0)
        : node_count_(node_count),
          boundary_count_(boundary_count),
          border_count_(border_count),
          X_(X, X + 2 * static_cast<std::size_t>(node_count)),
          cells_(cells, cells + 3 * static_cast<std::size_t>(cell_count)),
          number_(node_count, 0),
          weights_(Eigen::VectorXd::Ones(cell_count)) {
        for (std::int32_t b = 0; b < boundary_count; ++b) number_[boundary[b]] = -1 - b;
        for (std::int32_t b = 0; b < border_count; ++b) number_[border[b]] = 1;
        for (auto& number : number_) {
            if (number == 0) number = free_count_++;
        }
        for (std::int32_t b = 0; b < border_count; ++b) number_[border[b]] = free_count_++;
        make_pattern();
        assemble();
        if (free_count_) factor_.analyse(stiffness_, border_count_);
        factorise();
    }

    // Values (n, k) at all nodes from values (nb, k) at the boundary nodes.
    Rows solve(const Eigen::Ref<const Rows>& values) const {
        const Rows load = pull_ * values;
        Rows inside(free_count_, values.cols());
        each_columns(values.cols(), [&](auto width, Eigen::Index first) {
            constexpr int columns = decltype(width)::value;
            const Rows own = load.middleCols(first, columns);
            Rows found(free_count_, columns);
            factor_.template solve<columns>(own.data(), found.data());
            inside.middleCols(first, columns) = found;
        });
        return everywhere(values, inside);
    }

    // The Schur complement (m, m) of the border.
    Rows complement() const {
        Rows found = Rows::Zero(border_count_, border_count_);
        if (free_count_) factor_.complement(found.data());
        return found;
    }

    // What boundary values (nb, k) leave as loads (m, k) for the border.
    Rows reduce(const Eigen::Ref<const Rows>& values) {
        const Rows load = pull_ * values;
        reduced_.resize(free_count_, values.cols());
        each_columns(values.cols(), [&](auto width, Eigen::Index first) {
            constexpr int columns = decltype(width)::value;
            const Rows own = load.middleCols(first, columns);
            const auto left = factor_.template forward<columns>(own.data());
            for (std::int32_t k = 0; k < free_count_; ++k) reduced_.row(k).segment(first, columns) = left[k].matrix();
        });
        return reduced_.bottomRows(border_count_);
    }

    // Values (n, k) at all nodes from the same values (nb, k) and those (m, k) of the border.
    Rows complete(const Eigen::Ref<const Rows>& values, const Eigen::Ref<const Rows>& border) {
        reduced_.bottomRows(border_count_) = border;
        each_columns(values.cols(), [&](auto width, Eigen::Index first) {
            constexpr int columns = decltype(width)::value;
            ScalarCholesky::Fields<columns> x(free_count_);
            for (std::int32_t k = 0; k < free_count_; ++k) x[k] = reduced_.row(k).segment(first, columns).array();
            factor_.template backward<columns>(x);
            for (std::int32_t k = 0; k < free_count_; ++k)
                reduced_.row(k).segment(first, columns) = x[factor_.place(k)].matrix();
        });
        Rows all = everywhere(values, reduced_);
        reduced_.resize(0, 0);
        return all;
    }

    // Weights each triangle by the size of a field's gradient in it, so that strain spreads away from where it gathers.
    // A linear field has one gradient everywhere, and is reproduced still. Gives the largest size.
    double weigh(const Eigen::Ref<const Rows>& field) {
        for (std::size_t e = 0; e < triangles(); ++e) {
            const std::int32_t* n = cells_.data() + 3 * e;
            const Shape shape = shape_of(e);
            double sum = 0.0;
            for (int i = 0; i < 3; ++i) {
                const auto jump = field.row(n[(i + 1) % 3]) - field.row(n[(i + 2) % 3]);
                sum += shape.half_cotangents[i] * jump.squaredNorm();
            }
            weights_[e] = std::sqrt(std::max(0.0, sum / shape.area));
        }
        return cells_.empty() ? 0.0 : weights_.maxCoeff();
    }

    // Factorises with these weights over the largest one, of all parts.
    void stiffen(double largest) {
        constexpr double least = 1e-2;  // keeps the stiffness well conditioned where nothing is strained
        if (!(largest > 0.0)) {
            weights_.setOnes();
            return;
        }
        weights_ = weights_ / largest + Eigen::VectorXd::Constant(weights_.size(), least);
        assemble();
        factorise();
    }

 private:
    struct Shape {
        double half_cotangents[3];  // minus the off-diagonal of the element stiffness, by opposite corner
        double area;
    };

    std::size_t triangles() const { return cells_.size() / 3; }

    // Found again where it is wanted: kept ones would be as much as a third of the factor. In one place, so that it is
    // rounded alike wherever it is wanted.
    [[gnu::noinline]] Shape shape_of(std::size_t e) const {
        const std::int32_t* n = cells_.data() + 3 * e;
        const double* X = X_.data();
        Shape shape{};
        for (int i = 0; i < 3; ++i) {
            const double *o = X + 2 * n[i], *a = X + 2 * n[(i + 1) % 3], *b = X + 2 * n[(i + 2) % 3];
            const double ux = a[0] - o[0], uy = a[1] - o[1], vx = b[0] - o[0], vy = b[1] - o[1];
            const double twice_area = ux * vy - vx * uy;
            shape.half_cotangents[i] = 0.5 * (ux * vx + uy * vy) / twice_area;
            shape.area = 0.5 * twice_area;
        }
        return shape;
    }

    // Calls `use` for columns together, whose number the compiler knows, with the first of them.
    template <class Use>
    void each_columns(Eigen::Index count, const Use& use) const {
        if (!free_count_) return;
        if (count == 4) {
            use(std::integral_constant<int, 4>{}, 0);
        } else if (count == 2) {
            use(std::integral_constant<int, 2>{}, 0);
        } else {
            for (Eigen::Index k = 0; k < count; ++k) use(std::integral_constant<int, 1>{}, k);
        }
    }

    // Values at all nodes from those at the boundary, and at free nodes.
    Rows everywhere(const Eigen::Ref<const Rows>& values, const Rows& inside) const {
        Rows all(node_count_, values.cols());
        for (std::int32_t i = 0; i < node_count_; ++i) {
            if (number_[i] < 0) {
                all.row(i) = values.row(-1 - number_[i]);
            } else {
                all.row(i) = inside.row(number_[i]);
            }
        }
        return all;
    }

    // Numbers of both ends of a side of a cell, negative at the boundary.
    std::pair<std::int32_t, std::int32_t> ends(std::size_t e, int i) const {
        return {number_[cells_[3 * e + (i + 1) % 3]], number_[cells_[3 * e + (i + 2) % 3]]};
    }

    // The lower triangle by columns, the diagonal first, and where in it the sides of the cells are: sorted by counts,
    // for the cells have each entry twice at most.
    void make_pattern() {
        std::vector<std::int32_t> first(free_count_ + 1, 0);
        const auto each_side = [this](auto&& visit) {
            for (std::size_t e = 0; e < triangles(); ++e) {
                for (int i = 0; i < 3; ++i) {
                    const auto [a, b] = ends(e, i);
                    if (a >= 0 && b >= 0) visit(static_cast<std::int32_t>(3 * e + i), std::min(a, b), std::max(a, b));
                }
            }
        };
        each_side([&](std::int32_t, std::int32_t column, std::int32_t) { ++first[column + 1]; });
        for (std::int32_t k = 0; k < free_count_; ++k) first[k + 1] += first[k];
        std::vector<std::pair<std::int32_t, std::int32_t>> sides(first.back());  // row, side
        std::vector<std::int32_t> next(first.begin(), first.end() - 1);
        each_side([&](std::int32_t side, std::int32_t column, std::int32_t row) {
            sides[next[column]++] = {row, side};
        });
        slots_.assign(cells_.size(), -1);
        stiffness_.resize(free_count_, free_count_);
        stiffness_.reserve(static_cast<Eigen::Index>(sides.size()) + free_count_);
        std::int32_t count = 0;
        for (std::int32_t column = 0; column < free_count_; ++column) {
            stiffness_.startVec(column);
            stiffness_.insertBack(column, column) = 0.0;
            std::sort(sides.begin() + first[column], sides.begin() + first[column + 1]);
            ++count;
            std::int32_t last = -1;
            for (std::int32_t k = first[column]; k < first[column + 1]; ++k) {
                if (sides[k].first != last) {
                    stiffness_.insertBack(last = sides[k].first, column) = 0.0;
                    ++count;
                }
                slots_[sides[k].second] = count - 1;
            }
        }
        stiffness_.finalize();
    }

    void assemble() {
        double* values = stiffness_.valuePtr();
        const auto* columns = stiffness_.outerIndexPtr();
        std::fill(values, values + stiffness_.nonZeros(), 0.0);
        pulls_.clear();
        for (std::size_t e = 0; e < triangles(); ++e) {
            const Shape shape = shape_of(e);
            for (int i = 0; i < 3; ++i) {
                const double w = weights_[e] * shape.half_cotangents[i];
                const auto [a, b] = ends(e, i);
                if (a >= 0) values[columns[a]] += w;
                if (b >= 0) values[columns[b]] += w;
                if (a >= 0 && b >= 0) values[slots_[3 * e + i]] -= w;
                if (a >= 0 && b < 0) pulls_.emplace_back(a, -1 - b, w);
                if (b >= 0 && a < 0) pulls_.emplace_back(b, -1 - a, w);
            }
        }
        pull_.resize(free_count_, boundary_count_);
        pull_.setFromTriplets(pulls_.begin(), pulls_.end());
    }

    void factorise() {
        if (!free_count_) return;
        if (!factor_.factorise(stiffness_)) throw std::runtime_error("the mesh has a triangle without area");
    }

    std::int32_t node_count_, boundary_count_, border_count_, free_count_ = 0;
    std::vector<double> X_;
    std::vector<std::int32_t> cells_, number_;
    Eigen::VectorXd weights_;
    std::vector<std::int32_t> slots_;  // of each cell's sides in the stiffness; -1: an end is at the boundary
    std::vector<Eigen::Triplet<double, std::int32_t>> pulls_;
    Eigen::SparseMatrix<double> stiffness_;
    Eigen::SparseMatrix<double, Eigen::RowMajor> pull_;
    ScalarCholesky factor_;
    Rows reduced_;  // loads at the factor's places, between `reduce` and `complete`
};

}  // namespace restshape
