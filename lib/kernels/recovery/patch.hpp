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
          node_of_(count),
          inner_(count),
          fitted_(count),
          centres_(ne) {
        follow(cells, rows);
    }

    // Takes as many cells with other corners: memory that was used before is found sooner than new one.
    void follow(const int32_t* cells, const int32_t* rows) {
        std::copy_n(rows, corners_.size(), corners_.begin());
        std::copy_n(cells, nodes_.size(), nodes_.begin());
        for (const int32_t row : corners_)
            if (row < 0 || row >= this->rows()) throw std::invalid_argument("cells have rows that do not exist");
        const auto [least, most] = std::minmax_element(nodes_.begin(), nodes_.end());
        if (!nodes_.empty() && *least < 0) throw std::invalid_argument("cells name nodes that do not exist");
        least_ = nodes_.empty() ? 0 : *most + 1;
        find_around();
    }

    int cells() const { return static_cast<int>(centres_.size()); }
    int rows() const { return static_cast<int>(inner_.size()); }
    int least_nodes() const { return least_; }

    // X (n, 2), values (ne, 4), out (rows, 4).
    void run(const double* X, const double* values, double* out) {
        for (int e = 0; e < cells(); ++e) {
            const double *p = X + 2 * node(3 * e), *q = X + 2 * node(3 * e + 1), *r = X + 2 * node(3 * e + 2);
            centres_[e] = {(p[0] + q[0] + r[0]) / 3.0, (p[1] + q[1] + r[1]) / 3.0};
        }
        for (int row = 0; row < rows(); ++row) {
            Moments m;
            fitted_[row] = inner_[row] && take(X, values, row, m);
            if (fitted_[row]) Eigen::Map<Value>(out + 4 * static_cast<size_t>(row)) = m.here();
        }
        for (int row = 0; row < rows(); ++row)
            if (!fitted_[row]) Eigen::Map<Value>(out + 4 * static_cast<size_t>(row)) = around(X, values, row);
    }

 private:
    struct Place {
        double x, y;
    };

    // Least squares by the normal equations of the polynomial 1, x, y, from the node of a row on.
    struct Moments {
        Value b0 = Value::Zero(), b1 = Value::Zero(), b2 = Value::Zero();
        double count = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
        double c00 = 0, c01 = 0, c02 = 0, inverse = 0;

        // At the node.
        Value here() const { return (c00 * inverse) * b0 + (c01 * inverse) * b1 + (c02 * inverse) * b2; }

        // So far from it.
        Value at(double along, double across) const {
            const double c11 = count * yy - y * y, c12 = x * y - count * xy, c22 = count * xx - x * x;
            const Value along_x = (c01 * inverse) * b0 + (c11 * inverse) * b1 + (c12 * inverse) * b2;
            const Value along_y = (c02 * inverse) * b0 + (c12 * inverse) * b1 + (c22 * inverse) * b2;
            return here() + along * along_x + across * along_y;
        }
    };

    // Of the cells around a row; whether they have one polynomial.
    bool take(const double* X, const double* values, int row, Moments& m) const {
        const int first = first_[row], end = first_[row + 1];
        const double* here = X + 2 * static_cast<size_t>(node_of_[row]);
        for (int k = first; k < end; ++k) {
            const int e = around_[k];
            const double x = centres_[e].x - here[0], y = centres_[e].y - here[1];
            const Eigen::Map<const Value> value(values + 4 * static_cast<size_t>(e));
            m.x += x, m.y += y, m.xx += x * x, m.xy += x * y, m.yy += y * y;
            m.b0 += value, m.b1 += x * value, m.b2 += y * value;
        }
        m.count = end - first;
        m.c00 = m.xx * m.yy - m.xy * m.xy, m.c01 = m.y * m.xy - m.x * m.yy, m.c02 = m.x * m.xy - m.y * m.xx;
        const double det = m.count * m.c00 + m.x * m.c01 + m.y * m.c02;
        m.inverse = 1.0 / det;
        return std::abs(det) > 1e-6 * m.count * m.xx * m.yy;
    }

    // The corner of a cell that has a row.
    int corner_of(int e, int row) const {
        const int32_t* corners = corners_.data() + 3 * e;
        return corners[0] == row ? 0 : corners[1] == row ? 1 : 2;
    }
    size_t node(int corner) const { return static_cast<size_t>(nodes_[corner]); }

    // The corners of each row, and whether three or more triangles go all the way around: each neighbour follows and
    // precedes one.
    void find_around() {
        std::fill(first_.begin(), first_.end(), 0);
        balance_.assign(inner_.size(), 0);
        for (size_t k = 0; k < corners_.size(); k += 3) {
            const int32_t *row = corners_.data() + k, *node = nodes_.data() + k;
            int64_t square[3];
            for (int i = 0; i < 3; ++i) square[i] = static_cast<int64_t>(node[i]) * (node[i] + 1);
            for (int i = 0; i < 3; ++i) {
                balance_[row[i]] += square[(i + 1) % 3] - square[(i + 2) % 3];
                ++first_[row[i] + 1];
            }
        }
        for (size_t row = 0; row < inner_.size(); ++row) {
            inner_[row] = balance_[row] == 0 && first_[row + 1] >= 3;
            first_[row + 1] += first_[row];
        }
        // Backwards, each row's cells fill its place from the end, and are in ascending order.
        next_.assign(first_.begin() + 1, first_.end());
        for (int k = static_cast<int>(corners_.size()) - 1; k >= 0; --k) around_[--next_[corners_[k]]] = k / 3;
        for (size_t k = 0; k < corners_.size(); ++k) node_of_[corners_[k]] = nodes_[k];
    }

    // The mean of the neighbours' polynomials; of the triangles around where no inner node is near.
    Value around(const double* X, const double* values, int row) const {
        Value sum = Value::Zero(), plain = Value::Zero();
        int count = 0;
        for (int k = first_[row]; k < first_[row + 1]; ++k) {
            const int e = around_[k], i = corner_of(e, row);
            plain += Eigen::Map<const Value>(values + 4 * static_cast<size_t>(e));
            for (int j = 1; j < 3; ++j) {
                const int corner = 3 * e + (i + j) % 3;
                if (!fitted_[corners_[corner]]) continue;
                // Few rows have none of their own: those next to them are made again, not kept.
                Moments m;
                take(X, values, corners_[corner], m);
                const double *to = X + 2 * node(3 * e + i), *from = X + 2 * node(corner);
                sum += m.at(to[0] - from[0], to[1] - from[1]);
                ++count;
            }
        }
        if (count > 0) return sum / count;
        const int cells = first_[row + 1] - first_[row];
        return cells > 0 ? Value(plain / cells) : Value::Zero();
    }

    std::vector<int32_t> corners_, nodes_;  // (ne, 3) rows, and nodes
    std::vector<int64_t> balance_;
    std::vector<int> next_, first_, around_;  // cells of each row, from first to next first
    std::vector<int32_t> node_of_;            // of each row
    std::vector<uint8_t> inner_, fitted_;     // of each row: cells all the way around, and a polynomial of its own
    std::vector<Place> centres_;              // of each cell
    int32_t least_ = 0;
};

}  // namespace restshape
