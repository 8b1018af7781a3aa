// Triangles in stock: where a shape is wide and the size even, those of a square that fits to copies of itself, refined
// once a process. What a mesher would make there for every shape anew.
//
// They are fitted to the box around the boundary, so that a mesh hangs on the shape alone.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "mesh/order.hpp"
#include "mesh/size.hpp"

namespace restshape {

struct MeshInput {
    const double* points;  // (point_count, 2), boundary and embedded points
    std::ptrdiff_t point_count;
    const std::int32_t* segments;  // (segment_count, 2), material on the left of border segments
    const std::uint8_t* border;    // whether a segment bounds the material, else it lies inside
    std::ptrdiff_t segment_count;
};

// Twice the area on the left of the border.
inline double doubled_area(const MeshInput& input) {
    double found = 0.0;
    for (std::ptrdiff_t i = 0; i < input.segment_count; ++i) {
        if (!input.border[i]) continue;
        const double *a = input.points + 2 * input.segments[2 * i], *b = input.points + 2 * input.segments[2 * i + 1];
        found +=
            (a[0] - input.points[0]) * (b[1] - input.points[1]) - (b[0] - input.points[0]) * (a[1] - input.points[1]);
    }
    return found;
}

// A meshed square of SIDE x SIDE sizes with nodes at each size along its sides. Of these nodes it owns those on the
// lower and the left side; the others are its neighbours'.
struct Tile {
    static constexpr std::int32_t SIDE = 15;
    // A node or a cell of this square, or of the one so many squares to the right and upwards.
    struct Place {
        std::int32_t number, right, up;
    };

    std::vector<double> X;                          // of the own nodes
    std::vector<std::array<Place, 3>> cells, next;  // corners; the cells opposite to them
    std::vector<std::int32_t> first, bucket;        // of each node the start of its neighbours; of each unit square
    std::vector<Place> neighbours;
    std::vector<std::int32_t> in_bucket;  // nodes by unit square
    double longest = 0.0;

    // Nodes (n, 2) and triangles of the square.
    Tile(const std::vector<double>& nodes, const std::vector<std::int32_t>& triangles) {
        std::vector<Place> place_of;
        std::map<std::pair<double, double>, std::int32_t> own;
        for (std::size_t i = 0; i < nodes.size(); i += 2)
            if (nodes[i] < SIDE && nodes[i + 1] < SIDE) {
                own[{nodes[i], nodes[i + 1]}] = static_cast<std::int32_t>(X.size() / 2);
                X.push_back(nodes[i]), X.push_back(nodes[i + 1]);
            }
        for (std::size_t i = 0; i < nodes.size(); i += 2) {
            const bool right = nodes[i] >= SIDE, up = nodes[i + 1] >= SIDE;
            place_of.push_back({own.at({right ? 0.0 : nodes[i], up ? 0.0 : nodes[i + 1]}), right, up});
        }
        for (std::size_t c = 0; c < triangles.size(); c += 3)
            cells.push_back({place_of[triangles[c]], place_of[triangles[c + 1]], place_of[triangles[c + 2]]});
        join(), sort_into_buckets();
    }

 private:
    // Sides by their first node, by their second one and how far that lies off.
    void join() {
        std::map<std::array<std::int32_t, 4>, Place> left;  // the cell, seen from the square of the first node
        const auto side = [&](const std::array<Place, 3>& cell, int k) {
            return std::pair(cell[(k + 1) % 3], cell[(k + 2) % 3]);
        };
        for (std::size_t c = 0; c < cells.size(); ++c)
            for (int k = 0; k < 3; ++k) {
                const auto [a, b] = side(cells[c], k);
                left[{a.number, b.number, b.right - a.right, b.up - a.up}] = {static_cast<std::int32_t>(c), -a.right,
                                                                              -a.up};
                const double x = X[2 * b.number] - X[2 * a.number] + SIDE * (b.right - a.right);
                const double y = X[2 * b.number + 1] - X[2 * a.number + 1] + SIDE * (b.up - a.up);
                longest = std::max(longest, std::hypot(x, y));
            }
        next.resize(cells.size());
        for (std::size_t c = 0; c < cells.size(); ++c)
            for (int k = 0; k < 3; ++k) {
                const auto [a, b] = side(cells[c], k);
                const Place other = left.at({b.number, a.number, a.right - b.right, a.up - b.up});
                next[c][k] = {other.number, other.right + b.right, other.up + b.up};
            }
        first.assign(1, 0);
        auto at = left.begin();
        for (std::int32_t node = 0; node < static_cast<std::int32_t>(X.size() / 2); ++node) {
            for (; at != left.end() && at->first[0] == node; ++at)
                neighbours.push_back({at->first[1], at->first[2], at->first[3]});
            first.push_back(static_cast<std::int32_t>(neighbours.size()));
        }
    }

    void sort_into_buckets() {
        const auto count = static_cast<std::int32_t>(X.size() / 2);
        const auto of = [&](std::int32_t i) {
            return static_cast<std::int32_t>(X[2 * i + 1]) * SIDE + static_cast<std::int32_t>(X[2 * i]);
        };
        bucket = bucket_starts(SIDE * SIDE, count, of);
        auto free = bucket;
        in_bucket.resize(count);
        for (std::int32_t i = 0; i < count; ++i) in_bucket[free[of(i)]++] = i;
    }
};

// Copies of a tile in a shape. Its triangles all of whose corners have all their neighbours in the shape are done; the
// others are the mesher's.
class Stock {
 public:
    static constexpr double SPACING = 1.02;  // squares of a tile over the size: as many triangles as refinement makes
    static constexpr double MARGIN = 0.6;    // least distance of nodes from the boundary over the size
    static constexpr double EVEN = 0.99;     // least size over the background's
    static constexpr double WIDE = 0.05;  // cosine of angles that the mesher's triangles may not pass opposite to ours
    static constexpr double FEWEST = 2000.0;  // squares in a shape below which most lie near its boundary
    static constexpr double SPARSE = 64.0;    // boxes that are larger than their shape by this get none

    std::vector<double> X;             // (n, 2): loose nodes, then those on the border of the triangles, then the rest
    std::vector<std::int32_t> cells;   // triangles, by rows of X
    std::vector<std::int32_t> border;  // pairs of rows, the triangles on the right
    std::vector<std::pair<std::int32_t, std::int32_t>> behind;  // of each pair its triangle, and the corner opposite
    std::int32_t outer = 0;                                     // nodes that are loose or on the border of triangles

    Stock(const Tile& tile, const MeshInput& input, const SizeField& field) : tile_(tile) {
        if (tile.cells.empty() || !lay(input, field.background())) return;
        find_near(input);
        find_inside(input, field);
        find_triangles();
        leave_obtuse();
        collect();
    }

 private:
    using Place = Tile::Place;
    enum : std::uint8_t { NEAR = 1, OUTSIDE = 2, INSIDE = 4, DEEP = 8 };

    // Fits whole numbers of sizes into the box; returns whether there is room for triangles.
    bool lay(const MeshInput& input, double size) {
        double high[2];
        for (int k = 0; k < 2; ++k) low_[k] = high[k] = input.points[k];
        for (std::ptrdiff_t i = 0; i < 2 * input.point_count; ++i) {
            low_[i % 2] = std::min(low_[i % 2], input.points[i]);
            high[i % 2] = std::max(high[i % 2], input.points[i]);
        }
        const double square = SPACING * size, across = (high[0] - low_[0]) / square, up = (high[1] - low_[1]) / square;
        const double wanted = 0.5 * doubled_area(input) / (square * square);
        if (!(wanted >= FEWEST && across >= 4.0 && up >= 4.0 && across * up <= std::min(SPARSE * wanted, 5e8)))
            return false;
        const double count[2] = {std::rint(across), std::rint(up)};
        for (int k = 0; k < 2; ++k) {
            step_[k] = (high[k] - low_[k]) / count[k];
            squares_[k] = static_cast<std::int32_t>(count[k]);
            tiles_[k] = (squares_[k] + Tile::SIDE - 1) / Tile::SIDE;
        }
        const double longest = tile_.longest * std::max(step_[0], step_[1]);
        // A boundary that crossed a side would be nearer to one of its ends than half of it.
        margin_ = std::max(MARGIN * size, 0.5 * (1.0 + 1e-9) * longest);
        own_ = static_cast<std::int32_t>(tile_.X.size() / 2);
        kind_.assign(static_cast<std::size_t>(tiles_[0] + 1) * (tiles_[1] + 1) * own_, 0);
        leave_box();
        return true;
    }

    // Tiles at the right and at the top reach beyond the box.
    void leave_box() {
        for (std::int32_t j = 0; j <= tiles_[1]; ++j)
            for (std::int32_t i = 0; i <= tiles_[0]; ++i) {
                const double across = squares_[0] - i * Tile::SIDE, up = squares_[1] - j * Tile::SIDE;
                if (across >= Tile::SIDE && up >= Tile::SIDE) continue;
                std::uint8_t* kind = kind_.data() + node(i, j, 0);
                for (std::int32_t k = 0; k < own_; ++k)
                    if (tile_.X[2 * k] > across || tile_.X[2 * k + 1] > up) kind[k] = OUTSIDE;
            }
    }

    std::int32_t node(std::int32_t i, std::int32_t j, std::int32_t number) const {
        return (j * (tiles_[0] + 1) + i) * own_ + number;
    }
    double at(std::int32_t v, int axis) const {
        const std::int32_t square = v / own_, wide = tiles_[0] + 1;
        const std::int32_t before = axis ? square / wide : square % wide;
        return low_[axis] + (before * Tile::SIDE + tile_.X[2 * (v % own_) + axis]) * step_[axis];
    }

    // Marks the nodes that are nearer to the boundary than the margin.
    void find_near(const MeshInput& input) {
        std::vector<std::uint8_t> joined(input.point_count, 0);
        for (std::ptrdiff_t i = 0; i < input.segment_count; ++i) {
            const std::int32_t a = input.segments[2 * i], b = input.segments[2 * i + 1];
            joined[a] = joined[b] = 1;
            mark_near(input.points + 2 * a, input.points + 2 * b);
        }
        for (std::ptrdiff_t i = 0; i < input.point_count; ++i)
            if (!joined[i]) mark_near(input.points + 2 * i, input.points + 2 * i);
    }

    void mark_near(const double* a, const double* b) {
        const double dx = b[0] - a[0], dy = b[1] - a[1], square = dx * dx + dy * dy;
        const double inverse = square > 0.0 ? 1.0 / square : 0.0;
        const auto [i, i_end] = unit_squares(std::min(a[0], b[0]), std::max(a[0], b[0]), 0);
        const auto [j, j_end] = unit_squares(std::min(a[1], b[1]), std::max(a[1], b[1]), 1);
        for (std::int32_t row = j; row < j_end; ++row)
            for (std::int32_t column = i; column < i_end; ++column) {
                const std::int32_t local = row % Tile::SIDE * Tile::SIDE + column % Tile::SIDE;
                const std::int32_t base = node(column / Tile::SIDE, row / Tile::SIDE, 0);
                for (std::int32_t k = tile_.bucket[local]; k < tile_.bucket[local + 1]; ++k) {
                    const std::int32_t v = base + tile_.in_bucket[k];
                    const double x = at(v, 0) - a[0], y = at(v, 1) - a[1];
                    const double t = std::clamp((x * dx + y * dy) * inverse, 0.0, 1.0);
                    const double u = x - t * dx, w = y - t * dy;
                    if (u * u + w * w < margin_ * margin_) kind_[v] = NEAR;
                }
            }
    }

    // Numbers of the unit squares of one axis that may have nodes within the margin of an interval.
    std::pair<std::int32_t, std::int32_t> unit_squares(double from, double to, int axis) const {
        const double first = std::floor((from - margin_ - low_[axis]) / step_[axis]);
        const double last = std::floor((to + margin_ - low_[axis]) / step_[axis]);
        // Nodes at the far side of the last tile have a square of their own.
        const double all = Tile::SIDE * tiles_[axis] + 1;
        return {static_cast<std::int32_t>(std::clamp<double>(first, 0.0, all)),
                static_cast<std::int32_t>(std::clamp<double>(last + 1.0, 0.0, all))};
    }

    // No side between nodes that are not near crosses the boundary: what hangs together is inside or outside as a
    // whole.
    void find_inside(const MeshInput& input, const SizeField& field) {
        std::vector<std::int32_t> waiting, whole;
        const double even = EVEN * field.background();
        for (std::int32_t start = 0; start < static_cast<std::int32_t>(kind_.size()); ++start) {
            if (kind_[start]) continue;
            const std::uint8_t kind = within(input, at(start, 0), at(start, 1)) ? INSIDE : OUTSIDE;
            kind_[start] = kind;
            waiting.assign(1, start), whole.clear();
            while (!waiting.empty()) {
                const std::int32_t v = waiting.back();
                waiting.pop_back();
                if (kind == INSIDE) whole.push_back(v);
                each_neighbour(v, [&](std::int32_t other) {
                    if (!kind_[other]) kind_[other] = kind, waiting.push_back(other);
                    return true;
                });
            }
            if (field.uniform()) continue;
            for (const std::int32_t v : whole)
                if (field.at(at(v, 0), at(v, 1)) < even) kind_[v] = NEAR;
        }
    }

    // By the crossings of the border with a ray.
    static bool within(const MeshInput& input, double x, double y) {
        bool inside = false;
        for (std::ptrdiff_t i = 0; i < input.segment_count; ++i) {
            if (!input.border[i]) continue;
            const double *a = input.points + 2 * input.segments[2 * i],
                         *b = input.points + 2 * input.segments[2 * i + 1];
            if ((a[1] <= y) != (b[1] <= y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0])) inside = !inside;
        }
        return inside;
    }

    // Calls with each neighbour until that returns false; returns whether none did, and none lies off the tiles.
    template <class Use>
    bool each_neighbour(std::int32_t v, const Use& use) const {
        const std::int32_t square = v / own_, number = v % own_, wide = tiles_[0] + 1;
        const std::int32_t i = square % wide, j = square / wide;
        bool all = true;
        for (std::int32_t k = tile_.first[number]; k < tile_.first[number + 1]; ++k) {
            const Place& to = tile_.neighbours[k];
            const std::int32_t column = i + to.right, row = j + to.up;
            if (column < 0 || row < 0 || column >= wide || row > tiles_[1])
                all = false;
            else if (!use(node(column, row, to.number)))
                return false;
        }
        return all;
    }

    void find_triangles() {
        for (std::int32_t v = 0; v < static_cast<std::int32_t>(kind_.size()); ++v)
            if (kind_[v] == INSIDE && each_neighbour(v, [&](std::int32_t other) { return kind_[other] & INSIDE; }))
                kind_[v] |= DEEP;
        const auto count = static_cast<std::int32_t>(tile_.cells.size());
        done_.assign(static_cast<std::size_t>(tiles_[0]) * tiles_[1] * count, 0);
        for (std::int32_t j = 0; j < tiles_[1]; ++j)
            for (std::int32_t i = 0; i < tiles_[0]; ++i)
                for (std::int32_t c = 0; c < count; ++c) {
                    std::uint8_t deep = DEEP;
                    for (const Place& p : tile_.cells[c]) deep &= kind_[node(i + p.right, j + p.up, p.number)];
                    done_[(static_cast<std::size_t>(j) * tiles_[0] + i) * count + c] = deep;
                }
    }

    bool done(std::int32_t i, std::int32_t j, std::int32_t cell) const {
        if (i < 0 || j < 0 || i >= tiles_[0] || j >= tiles_[1]) return false;
        return done_[(static_cast<std::size_t>(j) * tiles_[0] + i) * tile_.cells.size() + cell];
    }

    // The mesher would split a side in whose circle a node lies: triangles behind such sides are left to it.
    void leave_obtuse() {
        const auto count = static_cast<std::int32_t>(tile_.cells.size());
        for (bool again = true; again;) {
            again = false;
            for (std::int32_t j = 0; j < tiles_[1]; ++j)
                for (std::int32_t i = 0; i < tiles_[0]; ++i)
                    for (std::int32_t c = 0; c < count; ++c) {
                        if (!done(i, j, c) || !sees_obtuse(i, j, c)) continue;
                        done_[(static_cast<std::size_t>(j) * tiles_[0] + i) * count + c] = 0;
                        again = true;
                    }
        }
    }

    // Whether a triangle that is not done has a wide angle opposite to a side of this one.
    bool sees_obtuse(std::int32_t i, std::int32_t j, std::int32_t cell) const {
        for (int k = 0; k < 3; ++k) {
            const Place& other = tile_.next[cell][k];
            const std::int32_t column = i + other.right, row = j + other.up;
            if (done(column, row, other.number)) continue;
            const auto& corners = tile_.cells[other.number];
            std::int32_t v[3];
            for (int l = 0; l < 3; ++l) v[l] = node(column + corners[l].right, row + corners[l].up, corners[l].number);
            const Place &a = tile_.cells[cell][(k + 1) % 3], &b = tile_.cells[cell][(k + 2) % 3];
            const std::int32_t ends[2] = {node(i + a.right, j + a.up, a.number), node(i + b.right, j + b.up, b.number)};
            for (const std::int32_t p : v) {
                if (p == ends[0] || p == ends[1]) continue;
                double dot = 0.0, squares[2] = {0.0, 0.0};
                for (int axis = 0; axis < 2; ++axis) {
                    const double u = at(ends[0], axis) - at(p, axis), w = at(ends[1], axis) - at(p, axis);
                    dot += u * w, squares[0] += u * u, squares[1] += w * w;
                }
                if (dot < WIDE * std::sqrt(squares[0] * squares[1])) return true;
            }
        }
        return false;
    }

    // Gathers the triangles and their border, and numbers the nodes.
    void collect() {
        enum : std::int32_t { LOOSE = -1, CORNER = -2, ON_BORDER = -3 };
        std::vector<std::int32_t> row_of(kind_.size(), LOOSE);
        const auto count = static_cast<std::int32_t>(tile_.cells.size());
        for (std::int32_t j = 0; j < tiles_[1]; ++j)
            for (std::int32_t i = 0; i < tiles_[0]; ++i)
                for (std::int32_t c = 0; c < count; ++c) {
                    if (!done(i, j, c)) continue;
                    std::int32_t corner[3];
                    for (int k = 0; k < 3; ++k) {
                        const Place& p = tile_.cells[c][k];
                        cells.push_back(corner[k] = node(i + p.right, j + p.up, p.number));
                        row_of[corner[k]] = std::min<std::int32_t>(row_of[corner[k]], CORNER);
                    }
                    for (int k = 0; k < 3; ++k) {
                        const Place& other = tile_.next[c][k];
                        if (done(i + other.right, j + other.up, other.number)) continue;
                        behind.emplace_back(static_cast<std::int32_t>(cells.size() / 3) - 1, k);
                        for (const std::int32_t end : {corner[(k + 2) % 3], corner[(k + 1) % 3]})
                            border.push_back(end), row_of[end] = ON_BORDER;
                    }
                }
        std::vector<std::pair<std::int64_t, std::int32_t>> loose;
        std::vector<std::int32_t> in_order;
        const int bits = static_cast<int>(std::ceil(std::log2(std::max(squares_[0], squares_[1]) + 1.0)));
        for (std::int32_t v = 0; v < static_cast<std::int32_t>(kind_.size()); ++v)
            if (kind_[v] & INSIDE && row_of[v] == LOOSE)
                loose.emplace_back(hilbert_key(unit_square(v, 0), unit_square(v, 1), bits), v);
        std::sort(loose.begin(), loose.end());
        for (const auto& [key, v] : loose) in_order.push_back(v);
        for (const std::int32_t which : {ON_BORDER, CORNER}) {
            for (std::int32_t v = 0; v < static_cast<std::int32_t>(kind_.size()); ++v)
                if (row_of[v] == which) in_order.push_back(v);
            if (which == ON_BORDER) outer = static_cast<std::int32_t>(in_order.size());
        }
        for (const std::int32_t v : in_order) {
            row_of[v] = static_cast<std::int32_t>(X.size() / 2);
            X.push_back(at(v, 0)), X.push_back(at(v, 1));
        }
        for (std::int32_t& v : cells) v = row_of[v];
        for (std::int32_t& v : border) v = row_of[v];
    }

    std::uint32_t unit_square(std::int32_t v, int axis) const {
        return static_cast<std::uint32_t>((at(v, axis) - low_[axis]) / step_[axis]);
    }

    const Tile& tile_;
    double low_[2], step_[2], margin_ = 0.0;
    std::int32_t squares_[2] = {0, 0}, tiles_[2] = {0, 0}, own_ = 0;
    std::vector<std::uint8_t> kind_, done_;
};

}  // namespace restshape
