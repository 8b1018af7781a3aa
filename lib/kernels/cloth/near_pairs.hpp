// Which parts of a sheet may come near each other on a straight way: edges and edges, triangles and nodes.
//
// Source: docs/theory/cloth.md.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "cloth/box_tree.hpp"
#include "cloth/part_distance.hpp"

namespace restshape {

// Pairs without a common node that are within a reach of each other, and ways on which none of them meets.
class NearPairs {
 public:
    using Pairs = std::vector<std::array<int32_t, 2>>;

    NearPairs(const int32_t* edges, int n_edges, const int32_t* cells, int n_cells, const int32_t* nodes, int n_nodes,
              const double* X)
        : edges_(edges, n_edges, 2, X), cells_(cells, n_cells, 3, X), nodes_(nodes, n_nodes, 1, X) {
        for (int i = 0; i < n_edges; ++i) {
            const double *a = X + 2 * edges[2 * i], *b = X + 2 * edges[2 * i + 1];
            length_ += std::hypot(a[0] - b[0], a[1] - b[1]) / n_edges;
        }
    }

    // Nodes that are sewn together are as one: of one number of `of`, or, with a node to the middle of an edge, of two
    // numbers that are a pair of `sewn`. Pairs of parts with such nodes are none, like those with a common node.
    void sew(const int32_t* of, const int32_t* sewn, int count) {
        of_.assign(of, of + nodes_.count());
        start_of_.assign(nodes_.count() + 1, 0);
        sewn_.resize(2 * static_cast<size_t>(count));
        for (int k = 0; k < 2 * count; ++k) ++start_of_[sewn[k] + 1];
        std::partial_sum(start_of_.begin(), start_of_.end(), start_of_.begin());
        std::vector<int32_t> next(start_of_.begin(), start_of_.end() - 1);
        for (int k = 0; k < 2 * count; ++k) sewn_[next[sewn[k]]++] = sewn[k ^ 1];
        home_.clear();
        start_.clear();
    }

    // At one place, from what is known around it, or on the last way, where that holds all of it.
    void search(const Point3* at, double reach, Pairs& edge_edge, Pairs& cell_node) {
        if (const double off = off_home(at, nullptr); reach <= home_reach_ && off < INFINITY) {
            within(home_edges_, reach + 2.0 * off, [&](int i, int j) { add_edges(at, reach, i, j, edge_edge); });
            within(home_cells_, reach + 2.0 * off, [&](int i, int j) { add_cell(at, reach, i, j, cell_node); });
        } else if (holds(at, reach)) {
            for (const auto& [i, j] : near_edges_) add_edges(at, reach, i, j, edge_edge);
            for (const auto& [i, j] : near_cells_) add_cell(at, reach, i, j, cell_node);
        } else {
            fit(at, nullptr, 0.5 * reach);
            edges_.with_itself([&](int i, int j) { add_edges(at, reach, i, j, edge_edge); });
            cells_.with(nodes_, [&](int i, int j) { add_cell(at, reach, i, *nodes_.item(j), cell_node); });
        }
        std::sort(edge_edge.begin(), edge_edge.end());
        std::sort(cell_node.begin(), cell_node.end());
    }

    // Triangles that edges without a common or sewn node pass through, in order.
    std::vector<int32_t> crossed(const Point3* x) {
        fit(x, nullptr, 0.0);
        std::vector<char> hit(cells_.count(), 0);
        edges_.with(cells_, [&](int i, int j) {
            const int32_t *edge = edges_.item(i), *cell = cells_.item(j);
            if (hit[j] || joined(cell, edge[0]) || joined(cell, edge[1])) return;
            hit[j] = passes_through(x[edge[0]], x[edge[1]], x[cell[0]], x[cell[1]], x[cell[2]]);
        });
        std::vector<int32_t> found;
        for (int j = 0; j < cells_.count(); ++j)
            if (hit[j]) found.push_back(j);
        return found;
    }

    // The share of a way, at most 1, on which no pair meets: each that comes within a reach comes nearer by nine tenths
    // at most. Keeps what may come within the reach on that way, or around it.
    double share_of(const Point3* from, const Point3* way, double reach) {
        const double most = settle(from, way, reach);
        return most < INFINITY ? share_at_home(from, way, most) : share_on(from, way, reach);
    }

 private:
    // A way that is so short goes by the pairs of a neighbourhood, which holds for others beside it; farther than
    // `most` from each other at home none meet.
    double share_at_home(const Point3* from, const Point3* way, double most) const {
        double share = 1.0;
        within(home_edges_, most, [&](int i, int j) { share = edges_met(from, way, i, j, share, 0.0).first; });
        within(home_cells_, most, [&](int i, int j) { share = cell_met(from, way, i, j, share, 0.0).first; });
        return share;
    }

    double share_on(const Point3* from, const Point3* way, double reach) {
        const int count = nodes_.count();
        start_.assign(from, from + count);
        way_.assign(way, way + count);
        reach_ = reach;
        near_edges_.clear();
        near_cells_.clear();
        fit(from, way, 0.5 * reach);
        double share = 1.0;
        edges_.with_itself([&](int i, int j) {
            if (joined(edges_.item(i), edges_.item(j))) return;
            const auto [met, near] = edges_met(from, way, i, j, share, reach);
            share = met;
            if (near) near_edges_.push_back({i, j});
        });
        cells_.with(nodes_, [&](int i, int j) {
            const int32_t node = *nodes_.item(j);
            if (joined(cells_.item(i), node)) return;
            const auto [met, near] = cell_met(from, way, i, node, share, reach);
            share = met;
            if (near) near_cells_.push_back({i, node});
        });
        return share;
    }

    // Not inlined: each call has the same bits.
    [[gnu::noinline]] std::pair<double, bool> edges_met(const Point3* from, const Point3* way, int i, int j,
                                                        double most, double reach) const {
        const int32_t *a = edges_.item(i), *b = edges_.item(j), four[4] = {a[0], a[1], b[0], b[1]};
        return advanced<2>(from, way, four, most, reach,
                           [](const Point3* x) { return segment_way(x[0], x[1], x[2], x[3]); });
    }
    [[gnu::noinline]] std::pair<double, bool> cell_met(const Point3* from, const Point3* way, int i, int32_t node,
                                                       double most, double reach) const {
        const int32_t *a = cells_.item(i), four[4] = {a[0], a[1], a[2], node};
        return advanced<3>(from, way, four, most, reach,
                           [](const Point3* x) { return triangle_way(x[3], x[0], x[1], x[2]) * -1.0; });
    }

    struct Neighbour {
        double distance;
        int32_t i, j;
    };
    using Neighbours = std::vector<Neighbour>;

    static constexpr double left = 0.1;  // part of a distance that stays

    // The room of a node: how far it may go from where a neighbourhood was searched. Some of its ways, no less than a
    // part of the edges' length; no more than another part, for pairs would be in it that never meet, and of the reach.
    // What is not in it stays beyond the reach: it comes nearer by nine tenths only from ten times the reach on, which
    // is farther than nodes go.
    static constexpr double ways = 3.0, least_roomy = 0.1, roomy = 1.0 / 3.0, most_roomy = 2.25;

    // Pairs of a neighbourhood that are nearer than a distance.
    template <class Found>
    static void within(const Neighbours& home, double distance, const Found& found) {
        for (const Neighbour& pair : home) {
            if (pair.distance > distance) break;
            found(pair.i, pair.j);
        }
    }

    // The distance in its neighbourhood within which pairs may meet on a way, infinite where the way is too long. The
    // neighbourhood is searched again where the way leads out of the last one.
    double settle(const Point3* from, const Point3* way, double reach) {
        const Point3 mean = mean_of(way);
        double longest = 0.0;
        for (int i = 0; i < nodes_.count(); ++i) longest = std::max(longest, (way[i] - mean).norm());
        const double most = std::min(roomy * length_, most_roomy * reach);
        if (!(longest <= most)) return INFINITY;
        double off = home_reach_ == reach && off_home(from, way) < INFINITY ? off_home(from, nullptr) : INFINITY;
        if (off == INFINITY) {
            home_.assign(from, from + nodes_.count());
            home_reach_ = reach;
            room_.resize(home_.size());
            for (size_t i = 0; i < home_.size(); ++i)
                room_[i] = std::min(most, std::max(ways * (way[i] - mean).norm(), least_roomy * length_));
            find_home(reach);
            off = 0.0;
        }
        // From farther apart two nodes do not come nearer by nine tenths.
        return 2.0 * off + 2.0 * longest / (1.0 - left);
    }

    // What may come within a reach where all nodes have room.
    void find_home(double reach) {
        const Point3* x = home_.data();
        const double* room = room_.data();
        home_edges_.clear();
        home_cells_.clear();
        fit(x, nullptr, 0.5 * reach, room);
        edges_.with_itself([&](int i, int j) {
            const double d = edges_apart(x, i, j);
            if (d < reach + edges_.most_of(room, i) + edges_.most_of(room, j)) home_edges_.push_back({d, i, j});
        });
        cells_.with(nodes_, [&](int i, int j) {
            const int32_t node = *nodes_.item(j);
            const double d = cell_apart(x, i, node);
            if (d < reach + cells_.most_of(room, i) + room[node]) home_cells_.push_back({d, i, node});
        });
        for (Neighbours* part : {&home_edges_, &home_cells_})
            std::sort(part->begin(), part->end(),
                      [](const Neighbour& a, const Neighbour& b) { return a.distance < b.distance; });
    }

    // How far nodes are from home, after a way; infinite where one is beyond its room. Motions of all together bring
    // nothing nearer.
    double off_home(const Point3* at, const Point3* way) const {
        if (home_.empty()) return INFINITY;
        const Point3 none{0, 0, 0}, off = mean_of(at) - mean_of(home_.data()) + (way ? mean_of(way) : none);
        double farthest = 0.0;
        for (size_t i = 0; i < home_.size(); ++i) {
            const double far = (at[i] - home_[i] - off + (way ? way[i] : none)).norm();
            if (!(far <= room_[i])) return INFINITY;
            farthest = std::max(farthest, far);
        }
        return farthest;
    }
    Point3 mean_of(const Point3* x) const {
        Point3 sum{0, 0, 0};
        for (int i = 0; i < nodes_.count(); ++i) sum = sum + x[i];
        return sum * (1.0 / std::max(nodes_.count(), 1));
    }

    // Boxes around parts, or their ways, wider by a margin on each side, and by the room of their nodes.
    void fit(const Point3* from, const Point3* way, double margin, const double* room = nullptr) {
        boxes_.resize(nodes_.count());
        for (int i = 0; i < nodes_.count(); ++i)
            boxes_[i] = Box::around(from[i], way ? from[i] + way[i] : from[i], margin + (room ? room[i] : 0.0));
        for (BoxTree* tree : {&edges_, &cells_, &nodes_}) tree->fit(boxes_.data());
    }

    // Whether edges, or a triangle and a node, have a common node, or nodes that are sewn together.
    bool joined(const int32_t* a, const int32_t* b) const {
        if (of_.empty()) return a[0] == b[0] || a[0] == b[1] || a[1] == b[0] || a[1] == b[1];
        return as_one(a[0], b[0]) || as_one(a[0], b[1]) || as_one(a[1], b[0]) || as_one(a[1], b[1]);
    }
    bool joined(const int32_t* a, int32_t node) const {
        if (of_.empty()) return a[0] == node || a[1] == node || a[2] == node;
        return as_one(a[0], node) || as_one(a[1], node) || as_one(a[2], node);
    }
    bool as_one(int32_t i, int32_t j) const {
        const int32_t p = of_[i], q = of_[j];
        if (p == q) return true;
        const auto first = sewn_.begin() + start_of_[p], end = sewn_.begin() + start_of_[p + 1];
        return std::find(first, end, q) != end;
    }

    void add_edges(const Point3* at, double reach, int i, int j, Pairs& found) const {
        if (edges_apart(at, i, j) < reach) found.push_back({std::min(i, j), std::max(i, j)});
    }
    void add_cell(const Point3* at, double reach, int i, int32_t node, Pairs& found) const {
        if (cell_apart(at, i, node) < reach) found.push_back({i, node});
    }
    // Infinite where they are joined.
    double edges_apart(const Point3* at, int i, int j) const {
        const int32_t *a = edges_.item(i), *b = edges_.item(j);
        return joined(a, b) ? INFINITY : segment_way(at[a[0]], at[a[1]], at[b[0]], at[b[1]]).norm();
    }
    double cell_apart(const Point3* at, int i, int32_t node) const {
        const int32_t* a = cells_.item(i);
        if (joined(a, node)) return INFINITY;
        return triangle_way(at[node], at[a[0]], at[a[1]], at[a[2]]).norm();
    }

    // Whether what the last way has found is all that is within a reach at a place beside it.
    bool holds(const Point3* at, double reach) const {
        const int count = nodes_.count();
        if (static_cast<int>(start_.size()) != count) return false;
        double along = 0.0, square = 0.0, farthest = 0.0;
        for (int i = 0; i < count; ++i) {
            along += (at[i] - start_[i]).dot(way_[i]);
            square += way_[i].dot(way_[i]);
        }
        const double t = square > 0 ? restshape::share(along / square) : 0.0;
        for (int i = 0; i < count; ++i) {
            const Point3 off = at[i] - start_[i] - way_[i] * t;
            farthest = std::max(farthest, off.dot(off));
        }
        return 2.0 * std::sqrt(farthest) + reach <= reach_;
    }

    // The share of the way, at most `most`, on which the first few of four nodes do not meet the others, and whether
    // they may come within a reach on all of it. Distances change by no more than the parts move relative to each
    // other, so that steps of a part of them are safe. Source: Li, Kaufman and Jiang, ACM TOG 40(4) (2021) 170,
    // algorithm 1. What is found does not depend on `most` where that is larger: pairs may be taken in any order.
    template <int first, class Between>
    static std::pair<double, bool> advanced(const Point3* from, const Point3* way, const int32_t* four, double most,
                                            double reach, const Between& between) {
        Point3 x[4], d[4], mean{0, 0, 0};
        for (int k = 0; k < 4; ++k) {
            x[k] = from[four[k]];
            d[k] = way[four[k]];
            mean = mean + d[k] * 0.25;
        }
        double fastest[2] = {0.0, 0.0};
        for (int k = 0; k < 4; ++k) {
            d[k] = d[k] - mean;
            fastest[k >= first] = std::max(fastest[k >= first], d[k].dot(d[k]));
        }
        const double speed = std::sqrt(fastest[0]) + std::sqrt(fastest[1]);
        Point3 off = between(x);
        double apart = off.norm();
        const bool near = apart < reach + speed;
        if ((1.0 - left) * apart >= speed * most || speed == 0.0) return {most, near};
        const double least = left * apart;
        double gone = 0.0;
        for (int steps = 0; steps < most_steps; ++steps) {
            if (stay_apart<first>(x, d, 1.0 - gone, off, least)) return {most, near};
            const double step = std::min((1.0 - left) * apart / speed, 1.0 - gone);
            for (int k = 0; k < 4; ++k) x[k] = x[k] + d[k] * step;
            off = between(x);
            apart = off.norm();
            if (gone > 0.0 && apart < least) return {gone, near};
            gone += step;
            if (gone >= most) return {most, near};
            if (apart < least) return {gone, near};
        }
        return {gone, near};
    }

    // Whether the first few of four nodes stay at least so far from the others along one direction, at both ends of the
    // rest of the way, and so on all of it.
    template <int first>
    static bool stay_apart(const Point3* x, const Point3* d, double rest, const Point3& off, double least) {
        const double goal = least * off.norm();
        for (const double t : {0.0, rest}) {
            double low = INFINITY, high = -INFINITY;
            for (int k = 0; k < 4; ++k) {
                const double height = off.dot(x[k] + d[k] * t);
                if (k < first)
                    low = std::min(low, height);
                else
                    high = std::max(high, height);
            }
            if (!(low - high > goal)) return false;
        }
        return true;
    }

    static constexpr int most_steps = 10000;  // of an advance: what is left of the way is not gone
    BoxTree edges_, cells_, nodes_;
    std::vector<Box> boxes_;  // of the nodes
    // Numbers of nodes, and of each those that are sewn to it; empty where there are no seams.
    std::vector<int32_t> of_, start_of_, sewn_;
    // The last way, and what may come within a reach on it.
    std::vector<Point3> start_, way_;
    double reach_ = 0.0;
    Pairs near_edges_, near_cells_;
    // A neighbourhood: where it was searched, how far nodes may go from there, and what may come within a reach then.
    std::vector<Point3> home_;
    std::vector<double> room_;
    double length_ = 0.0, home_reach_ = -1.0;  // of edges in the flat sheet, on average
    Neighbours home_edges_, home_cells_;       // by distance there
};

}  // namespace restshape
