// A triangulation that mends itself by Delaunay flips, in the arrays of its mesh.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "mesh/quality.hpp"

namespace restshape {

// Works on arrays that belong to the mesh: cells (ne, 3) counterclockwise, cell_edges (ne, 3) where edge i lies
// opposite to corner i, edge_nodes (n_edges, 2). A flipped edge keeps its number, and so a node at its middle would
// follow it.
class Triangulation {
 public:
    Triangulation(std::int32_t* cells, std::int32_t* cell_edges, std::ptrdiff_t cell_count, std::int32_t* edge_nodes,
                  std::ptrdiff_t edge_count, const std::uint8_t* fixed)
        : cells_(cells),
          cell_edges_(cell_edges),
          edge_nodes_(edge_nodes),
          fixed_(fixed, fixed + edge_count),
          edge_cells_(edge_count, {-1, -1}),
          queued_(edge_count, 0),
          touched_(cell_count, 0) {
        for (std::int32_t cell = 0; cell < cell_count; ++cell) {
            for (int i = 0; i < 3; ++i) {
                const std::int32_t edge = cell_edges_[3 * cell + i];
                if (edge < 0 || edge >= edge_count)
                    throw std::invalid_argument("cell_edges names an edge that is not there");
                auto& sides = edge_cells_[edge];
                if (sides[1] >= 0) throw std::invalid_argument("a mesh edge has more than two triangles");
                sides[sides[0] < 0 ? 0 : 1] = cell;
            }
        }
    }

    // Flips edges whose two opposite angles sum to more than pi, and then those around them, until none is left;
    // returns how many flips. It begins at the edges of triangles whose quality is below `quality_floor`: at 1 or more,
    // at all. Every flip enlarges the smallest of six angles, so it ends; `max_passes` x edges bounds it under
    // rounding.
    std::ptrdiff_t flip_delaunay(const double* X, int max_passes, double quality_floor) {
        changed_.clear();
        queue_.clear();
        const auto count = static_cast<std::int32_t>(touched_.size());
        for (std::int32_t first = 0; first < count; first += block) {
            const std::int32_t end = std::min(first + block, count);
            if (quality_floor < 1.0 && !low_quality(X, first, end, quality_floor)) continue;
            for (std::int32_t cell = first; cell < end; ++cell)
                if (quality_floor >= 1.0 || low_quality(X, cell, cell + 1, quality_floor))
                    for (int i = 0; i < 3; ++i) push(cell_edges_[3 * cell + i]);
        }
        const auto limit = static_cast<std::ptrdiff_t>(max_passes) * static_cast<std::ptrdiff_t>(edge_cells_.size());
        std::ptrdiff_t flips = 0;
        for (std::size_t next = 0; next < queue_.size(); ++next) {
            const std::int32_t edge = queue_[next];
            queued_[edge] = 0;
            if (flips < limit && flip_if_better(X, edge)) ++flips;
        }
        for (const std::int32_t cell : changed_) touched_[cell] = 0;
        std::sort(changed_.begin(), changed_.end());
        return flips;
    }

    // Triangles that the last call changed, in ascending order.
    const std::vector<std::int32_t>& changed_cells() const { return changed_; }

    // The two triangles of every edge; -1 where there is none.
    const std::vector<std::array<std::int32_t, 2>>& edge_cells() const { return edge_cells_; }

 private:
    static constexpr std::int32_t block = 64;  // triangles that are judged together

    void push(std::int32_t edge) {
        if (fixed_[edge] || queued_[edge] || edge_cells_[edge][1] < 0) return;
        queued_[edge] = 1;
        queue_.push_back(edge);
    }

    void touch(std::int32_t cell) {
        if (!touched_[cell]) changed_.push_back(cell);
        touched_[cell] = 1;
    }

    int corner_opposite(std::int32_t cell, std::int32_t edge) const {
        const std::int32_t* edges = cell_edges_ + 3 * cell;
        return edges[0] == edge ? 0 : edges[1] == edge ? 1 : 2;
    }

    void hand_over(std::int32_t edge, std::int32_t from, std::int32_t to) {
        auto& sides = edge_cells_[edge];
        sides[sides[0] == from ? 0 : 1] = to;
    }

    // Whether one of these triangles has less quality than the threshold (docs/theory/levels-of-reuse.md).
    bool low_quality(const double* X, std::int32_t first, std::int32_t end, double quality_floor) const {
        return check_cells(X, cells_ + 3 * first, end - first, 0.0, quality_floor).low_quality > 0;
    }

    // Opposite angles alpha, delta of the quadrilateral a b d c with diagonal b c: flip when sin(alpha + delta) < 0 by
    // more than rounding, and the two new triangles have area, so that the quadrilateral is strictly convex.
    static bool improves(const double* a, const double* b, const double* d, const double* c) {
        const double bax = b[0] - a[0], bay = b[1] - a[1], cax = c[0] - a[0], cay = c[1] - a[1];
        const double bdx = b[0] - d[0], bdy = b[1] - d[1], cdx = c[0] - d[0], cdy = c[1] - d[1];
        const double sin_a = bax * cay - cax * bay, cos_a = bax * cax + bay * cay;
        const double sin_d = cdx * bdy - bdx * cdy, cos_d = bdx * cdx + bdy * cdy;
        const double ab = bax * bax + bay * bay, ac = cax * cax + cay * cay;
        const double db = bdx * bdx + bdy * bdy, dc = cdx * cdx + cdy * cdy;
        constexpr double tolerance = 1e-10;
        const double sum = sin_a * cos_d + cos_a * sin_d;
        if (!(sum < -tolerance * std::sqrt(ab * ac * db * dc))) return false;
        const double dax = d[0] - a[0], day = d[1] - a[1];
        const double area_b = bax * day - dax * bay, area_c = dax * cay - cax * day;
        const double smallest = tolerance * (dax * dax + day * day);
        return area_b > smallest && area_c > smallest;
    }

    bool flip_if_better(const double* X, std::int32_t edge) {
        const std::int32_t left = edge_cells_[edge][0], right = edge_cells_[edge][1];
        const int i = corner_opposite(left, edge), j = corner_opposite(right, edge);
        std::int32_t *n = cells_ + 3 * left, *m = cells_ + 3 * right;
        std::int32_t *f = cell_edges_ + 3 * left, *g = cell_edges_ + 3 * right;
        const std::int32_t a = n[i], b = n[(i + 1) % 3], c = n[(i + 2) % 3], d = m[j];
        if (!improves(X + 2 * a, X + 2 * b, X + 2 * d, X + 2 * c)) return false;
        const std::int32_t ca = f[(i + 1) % 3], ab = f[(i + 2) % 3];
        const std::int32_t bd = g[(j + 1) % 3], dc = g[(j + 2) % 3];
        n[0] = a, n[1] = b, n[2] = d;
        f[0] = bd, f[1] = edge, f[2] = ab;
        m[0] = a, m[1] = d, m[2] = c;
        g[0] = dc, g[1] = ca, g[2] = edge;
        edge_nodes_[2 * edge] = std::min(a, d);
        edge_nodes_[2 * edge + 1] = std::max(a, d);
        hand_over(bd, right, left);
        hand_over(ca, left, right);
        touch(left), touch(right);
        push(ab), push(bd), push(dc), push(ca);
        return true;
    }

    std::int32_t *cells_, *cell_edges_, *edge_nodes_;
    std::vector<std::uint8_t> fixed_;
    std::vector<std::array<std::int32_t, 2>> edge_cells_;
    std::vector<std::uint8_t> queued_, touched_;
    std::vector<std::int32_t> queue_, changed_;
};

}  // namespace restshape
