// Extends displacements of the boundary into a triangle mesh by Laplace's equation.
#pragma once

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <vector>

namespace restshape {

// Linear triangles; the factor serves any number of boundary values. With equal weights linear functions are
// reproduced.
class HarmonicExtension {
 public:
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

    HarmonicExtension(const double* X, std::int32_t node_count, const std::int32_t* cells, std::int32_t cell_count,
                      const std::int32_t* boundary, std::int32_t boundary_count)
        : node_count_(node_count),
          boundary_count_(boundary_count),
          cells_(cells, cells + 3 * cell_count),
          number_(node_count, 0),
          weights_(Eigen::VectorXd::Ones(cell_count)) {
        for (std::int32_t b = 0; b < boundary_count; ++b) number_[boundary[b]] = -1 - b;
        for (auto& number : number_) {
            if (number >= 0) number = free_count_++;
        }
        shapes_.resize(cell_count);
        for (std::int32_t e = 0; e < cell_count; ++e) shapes_[e] = shape_of(X, cells + 3 * e);
        assemble();
        if (free_count_) factor_.analyzePattern(stiffness_);
        factorise();
    }

    // Values (n, k) at all nodes from values (nb, k) at the boundary nodes.
    Rows solve(const Eigen::Ref<const Rows>& values) const {
        Rows inside(free_count_, values.cols());
        if (free_count_) {
            const Eigen::MatrixXd load = pull_ * values;
            inside = factor_.solve(load);
        }
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

    // Weights each triangle by the size of a field's gradient in it, so that strain spreads away from where it gathers.
    // A linear field has one gradient everywhere, and is reproduced still.
    void stiffen(const Eigen::Ref<const Rows>& field) {
        constexpr double least = 1e-2;  // keeps the stiffness well conditioned where nothing is strained
        for (std::size_t e = 0; e < shapes_.size(); ++e) {
            const std::int32_t* n = cells_.data() + 3 * e;
            double sum = 0.0;
            for (int i = 0; i < 3; ++i) {
                const auto jump = field.row(n[(i + 1) % 3]) - field.row(n[(i + 2) % 3]);
                sum += shapes_[e].half_cotangents[i] * jump.squaredNorm();
            }
            weights_[e] = std::sqrt(std::max(0.0, sum / shapes_[e].area));
        }
        const double largest = weights_.maxCoeff();
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

    static Shape shape_of(const double* X, const std::int32_t* n) {
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

    void assemble() {
        entries_.clear();
        pulls_.clear();
        for (std::size_t e = 0; e < shapes_.size(); ++e) {
            for (int i = 0; i < 3; ++i) {
                const double w = weights_[e] * shapes_[e].half_cotangents[i];
                const std::int32_t a = number_[cells_[3 * e + (i + 1) % 3]], b = number_[cells_[3 * e + (i + 2) % 3]];
                if (a >= 0) entries_.emplace_back(a, a, w);
                if (b >= 0) entries_.emplace_back(b, b, w);
                if (a >= 0 && b >= 0) entries_.emplace_back(std::max(a, b), std::min(a, b), -w);
                if (a >= 0 && b < 0) pulls_.emplace_back(a, -1 - b, w);
                if (b >= 0 && a < 0) pulls_.emplace_back(b, -1 - a, w);
            }
        }
        stiffness_.resize(free_count_, free_count_);
        stiffness_.setFromTriplets(entries_.begin(), entries_.end());
        pull_.resize(free_count_, boundary_count_);
        pull_.setFromTriplets(pulls_.begin(), pulls_.end());
    }

    void factorise() {
        if (!free_count_) return;
        factor_.factorize(stiffness_);
        if (factor_.info() != Eigen::Success) throw std::runtime_error("the mesh has a triangle without area");
    }

    std::int32_t node_count_, boundary_count_, free_count_ = 0;
    std::vector<std::int32_t> cells_, number_;
    std::vector<Shape> shapes_;
    Eigen::VectorXd weights_;
    std::vector<Eigen::Triplet<double, std::int32_t>> entries_, pulls_;
    Eigen::SparseMatrix<double> stiffness_;
    Eigen::SparseMatrix<double, Eigen::RowMajor> pull_;
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> factor_;
};

}  // namespace restshape
