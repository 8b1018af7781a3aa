// Superconvergent patch recovery: nodal stresses from stresses that are constant on triangles.
//
// Around an inner node a linear polynomial is fitted to the values at the triangles' centres; a boundary node takes the
// mean of the polynomials of the inner nodes next to it. Zienkiewicz and Zhu, Int. J. Numer. Meth. Engng 33 (1992)
// 1331.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <vector>

namespace restshape {

// Made for triangles that keep their corners; places and values may change from run to run.
class PatchRecovery {
 public:
    using Value = Eigen::Array4d;

    // cells (ne, 3): nodes of the corners; rows (ne, 3): where each cell has them in what is recovered, `count` rows.
    PatchRecovery(const int32_t* cells, const int32_t* rows, int ne, int count)
        : corners_(3 * static_cast<size_t>(ne)),
          nodes_(corners_.size()),
          first_(count + 1),
          around_(corners_.size()),
          patches_(count),
          centres_(ne) {
        follow(cells, rows);
    }

    // Takes as many cells with other corners: memory that was used before is found sooner than new one.
    void follow(const int32_t* cells, const int32_t* rows) {
        std::copy_n(rows, corners_.size(), corners_.begin());
        std::copy_n(cells, nodes_.size(), nodes_.begin());
        const int count = static_cast<int>(patches_.size());
        for (const int32_t row : corners_)
            if (row < 0 || row >= count) throw std::invalid_argument("cells have rows that do not exist");
        const auto [least, most] = std::minmax_element(nodes_.begin(), nodes_.end());
        if (!nodes_.empty() && *least < 0) throw std::invalid_argument("cells name nodes that do not exist");
        least_ = nodes_.empty() ? 0 : *most + 1;
        find_around();
    }

    int cells() const { return static_cast<int>(centres_.size()); }
    int rows() const { return static_cast<int>(patches_.size()); }
    int least_nodes() const { return least_; }

    // X (n, 2), values (ne, 4), out (rows, 4).
    void run(const double* X, const double* values, double* out) {
        for (int e = 0; e < cells(); ++e) {
            const double *p = X + 2 * node(3 * e), *q = X + 2 * node(3 * e + 1), *r = X + 2 * node(3 * e + 2);
            centres_[e] = {(p[0] + q[0] + r[0]) / 3.0, (p[1] + q[1] + r[1]) / 3.0};
        }
        for (int row = 0; row < rows(); ++row) {
            Patch& p = patches_[row];
            p.fitted = p.inner && fit(X, values, row);
            if (p.fitted) Eigen::Map<Value>(out + 4 * static_cast<size_t>(row)) = p.b[0];
        }
        for (int row = 0; row < rows(); ++row)
            if (!patches_[row].fitted) Eigen::Map<Value>(out + 4 * static_cast<size_t>(row)) = around(X, values, row);
    }

 private:
    struct Patch {
        Value b[3];  // the polynomial 1, x, y
        bool inner = false, fitted = false;
    };
    struct Place {
        double x, y;
    };

    size_t node(int corner) const { return static_cast<size_t>(nodes_[corner]); }

    // The corners of each row, and whether three or more triangles go all the way around: each neighbour follows and
    // precedes one.
    void find_around() {
        std::fill(first_.begin(), first_.end(), 0);
        balance_.assign(patches_.size(), 0);
        for (size_t k = 0; k < corners_.size(); k += 3) {
            const int32_t *row = corners_.data() + k, *node = nodes_.data() + k;
            int64_t square[3];
            for (int i = 0; i < 3; ++i) square[i] = static_cast<int64_t>(node[i]) * (node[i] + 1);
            for (int i = 0; i < 3; ++i) {
                balance_[row[i]] += square[(i + 1) % 3] - square[(i + 2) % 3];
                ++first_[row[i] + 1];
            }
        }
        for (size_t row = 0; row < patches_.size(); ++row) {
            patches_[row].inner = balance_[row] == 0 && first_[row + 1] >= 3;
            first_[row + 1] += first_[row];
        }
        // Backwards, each row's cells fill its place from the end, and are in ascending order.
        next_.assign(first_.begin() + 1, first_.end());
        for (int k = static_cast<int>(corners_.size()) - 1; k >= 0; --k) around_[--next_[corners_[k]]] = k;
    }

    // Least squares by the normal equations of the polynomial 1, x, y.
    bool fit(const double* X, const double* values, int row) {
        const double* here = X + 2 * node(around_[first_[row]]);
        Value b0 = Value::Zero(), b1 = Value::Zero(), b2 = Value::Zero();
        double m1 = 0, m2 = 0, m3 = 0, m4 = 0, m5 = 0;
        for (int k = first_[row]; k < first_[row + 1]; ++k) {
            const int e = around_[k] / 3;
            const double x = centres_[e].x - here[0], y = centres_[e].y - here[1];
            const Eigen::Map<const Value> value(values + 4 * static_cast<size_t>(e));
            m1 += x, m2 += y, m3 += x * x, m4 += x * y, m5 += y * y;
            b0 += value, b1 += x * value, b2 += y * value;
        }
        const double m0 = first_[row + 1] - first_[row];
        const double c00 = m3 * m5 - m4 * m4, c01 = m2 * m4 - m1 * m5, c02 = m1 * m4 - m2 * m3;
        const double det = m0 * c00 + m1 * c01 + m2 * c02;
        if (!(std::abs(det) > 1e-6 * m0 * m3 * m5)) return false;
        const double c11 = m0 * m5 - m2 * m2, c12 = m1 * m2 - m0 * m4, c22 = m0 * m3 - m1 * m1;
        const Value r0 = b0 / det, r1 = b1 / det, r2 = b2 / det;
        Patch& p = patches_[row];
        p.b[0] = c00 * r0 + c01 * r1 + c02 * r2;
        p.b[1] = c01 * r0 + c11 * r1 + c12 * r2;
        p.b[2] = c02 * r0 + c12 * r1 + c22 * r2;
        return true;
    }

    // The mean of the neighbours' polynomials; of the triangles around where no inner node is near.
    Value around(const double* X, const double* values, int row) const {
        Value sum = Value::Zero(), plain = Value::Zero();
        int count = 0;
        for (int k = first_[row]; k < first_[row + 1]; ++k) {
            const int e = around_[k] / 3, i = around_[k] % 3;
            plain += Eigen::Map<const Value>(values + 4 * static_cast<size_t>(e));
            for (int j = 1; j < 3; ++j) {
                const int corner = 3 * e + (i + j) % 3;
                const Patch& p = patches_[corners_[corner]];
                if (!p.fitted) continue;
                const double *to = X + 2 * node(3 * e + i), *from = X + 2 * node(corner);
                sum += p.b[0] + (to[0] - from[0]) * p.b[1] + (to[1] - from[1]) * p.b[2];
                ++count;
            }
        }
        if (count > 0) return sum / count;
        const int cells = first_[row + 1] - first_[row];
        return cells > 0 ? Value(plain / cells) : Value::Zero();
    }

    std::vector<int32_t> corners_, nodes_;  // (ne, 3) rows, and nodes
    std::vector<int64_t> balance_;
    std::vector<int> next_, first_, around_;  // corners k = 3 e + i of each row, from first to next first
    std::vector<Patch> patches_;              // of each row
    std::vector<Place> centres_;              // of each cell
    int32_t least_ = 0;
};

}  // namespace restshape
