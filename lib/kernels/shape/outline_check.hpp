// Validity of an outline sampled by straight pieces, along a motion P0 + c0 P1 + c1 P2.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "shape/outline_round.hpp"

namespace restshape::outline {

struct Box {
    double x0, y0, x1, y1;
};

inline Box box_of(Point a, Point b) {
    return {std::min(a.x, b.x), std::min(a.y, b.y), std::max(a.x, b.x), std::max(a.y, b.y)};
}

inline bool apart(const Box& a, const Box& b, double gap) {
    return a.x0 > b.x1 + gap || b.x0 > a.x1 + gap || a.y0 > b.y1 + gap || b.y0 > a.y1 + gap;
}

// Squared distance from p to the segment a b.
inline double distance2(Point p, Point a, Point b) {
    const Point ab = b - a, ap = p - a;
    const double length2 = dot(ab, ab);
    const double t = length2 > 0 ? std::clamp(dot(ap, ab) / length2, 0.0, 1.0) : 0.0;
    const Point off{ap.x - t * ab.x, ap.y - t * ab.y};
    return dot(off, off);
}

// Whether two segments have a common point; collinear overlap counts.
inline bool segments_meet(Point a, Point b, Point c, Point d) {
    const double s0 = cross(b - a, c - a), s1 = cross(b - a, d - a);
    const double s2 = cross(d - c, a - c), s3 = cross(d - c, b - c);
    if (((s0 > 0 && s1 > 0) || (s0 < 0 && s1 < 0)) || ((s2 > 0 && s3 > 0) || (s2 < 0 && s3 < 0))) return false;
    return s0 != 0 || s1 != 0 || !apart(box_of(a, b), box_of(c, d), 0.0);
}

// Where the lines of two segments that meet do so; where they are parallel, the place of the first nearest to the
// start of the other.
inline Point meeting_point(Point a, Point b, Point c, Point d) {
    const double turn = cross(b - a, d - c), length2 = dot(b - a, b - a);
    const double along = length2 > 0 ? std::clamp(dot(c - a, b - a) / length2, 0.0, 1.0) : 0.0;
    const double t = turn != 0 ? cross(c - a, d - c) / turn : along;
    return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
}

enum class Fault {
    none,
    resample,
    cross,
    touch,
    fold,
    shorter,
    turned,
    outside,
    nested,
    overlap,
    point_near,
    point_outside,
    point_in_hole
};

struct Finding {
    Fault fault = Fault::none;
    int i = -1, j = -1;
    Point at{0, 0};
};

struct SampledLoop {
    int kind;  // 0 outline, 1 hole, 2 region
    std::vector<int> edges;
    std::vector<bool> forward;
    int piece = 0;  // that it is part of
};

class OutlineCheck {
 public:
    // first: samples of edge e are first[e] .. first[e + 1] - 1; ends: vertices at its ends;
    // gap: clearance; sharpest: smallest angle between edges at a vertex; round: whether an edge is a line or an arc;
    // spot_pieces: of which piece embedded points are.
    OutlineCheck(std::vector<int> first, std::vector<std::array<int, 2>> ends, std::vector<SampledLoop> loops,
                 double gap, double sharpest, std::vector<bool> round, std::vector<int> spot_pieces)
        : first_(std::move(first)),
          ends_(std::move(ends)),
          loops_(std::move(loops)),
          gap_(gap),
          sharpest_(std::tan(sharpest)),
          round_(std::move(round)),
          spot_pieces_(std::move(spot_pieces)) {
        find_probes();
    }

    // p0 .. p2: samples and their displacements; e0 .. e2: the same of embedded points; state: 0 still, 1 bending,
    // 2 moving as a whole; rigid: what moves as a whole keeps its form.
    void set_motion(std::array<std::vector<Point>, 3> samples, std::array<std::vector<Point>, 3> spots,
                    std::vector<std::uint8_t> state, bool rigid) {
        samples_ = std::move(samples);
        spots_ = std::move(spots);
        state_ = std::move(state);
        rigid_ = rigid;
        now_ = samples_[0];
        spot_now_ = spots_[0];
        boxes_.resize(state_.size());
        reference_length_.resize(state_.size());
        loop_state_.assign(loops_.size(), 0);
        for (std::size_t l = 0; l < loops_.size(); ++l)
            for (int e : loops_[l].edges)
                loop_state_[l] = std::max<int>(loop_state_[l], state_[e] ? (fixed_form(e) ? 2 : 3) : 0);
        for (std::size_t l = 0; l < loops_.size(); ++l)
            for (int e : loops_[l].edges)
                if (loop_state_[l] == 2 && !state_[e]) loop_state_[l] = 3;
        for (int e = 0; e < edges(); ++e) boxes_[e] = edge_box(e);
        settle(0, 0);
    }

    // From now on edges count as grown when they are twice as long as at (c0, c1).
    void settle(double c0, double c1) {
        move(c0, c1);
        for (int e = 0; e < edges(); ++e) reference_length_[e] = edge_length(e);
    }

    Finding check(double c0, double c1) {
        move(c0, c1);
        Finding found = check_lengths();
        if (found.fault == Fault::none) found = check_pairs();
        if (found.fault == Fault::none) found = check_loops();
        if (found.fault == Fault::none) found = check_spots();
        return found;
    }

 private:
    bool fixed_form(int e) const { return state_[e] == 2 && rigid_; }
    bool joined(int e, int f) const {
        return ends_[e][0] == ends_[f][0] || ends_[e][0] == ends_[f][1] || ends_[e][1] == ends_[f][0] ||
               ends_[e][1] == ends_[f][1];
    }

    Box edge_box(int e) const {
        Box b{now_[first_[e]].x, now_[first_[e]].y, now_[first_[e]].x, now_[first_[e]].y};
        for (int k = first_[e] + 1; k < first_[e + 1]; ++k) {
            b.x0 = std::min(b.x0, now_[k].x), b.x1 = std::max(b.x1, now_[k].x);
            b.y0 = std::min(b.y0, now_[k].y), b.y1 = std::max(b.y1, now_[k].y);
        }
        return b;
    }

    double edge_length(int e) const {
        double sum = 0;
        for (int k = first_[e]; k + 1 < first_[e + 1]; ++k)
            sum += std::sqrt(dot(now_[k + 1] - now_[k], now_[k + 1] - now_[k]));
        return sum;
    }

    void move(double c0, double c1) {
        for (std::size_t e = 0; e < state_.size(); ++e) {
            if (!state_[e]) continue;
            for (int k = first_[e]; k < first_[e + 1]; ++k) {
                now_[k].x = samples_[0][k].x + c0 * samples_[1][k].x + c1 * samples_[2][k].x;
                now_[k].y = samples_[0][k].y + c0 * samples_[1][k].y + c1 * samples_[2][k].y;
            }
            boxes_[e] = edge_box(static_cast<int>(e));
        }
        for (std::size_t k = 0; k < spot_now_.size(); ++k) {
            spot_now_[k].x = spots_[0][k].x + c0 * spots_[1][k].x + c1 * spots_[2][k].x;
            spot_now_[k].y = spots_[0][k].y + c0 * spots_[1][k].y + c1 * spots_[2][k].y;
        }
    }

    // Edges that collapse, and edges of many pieces that grew so much that the pieces are too coarse.
    Finding check_lengths() const {
        bool coarse = false;
        for (int e = 0; e < edges(); ++e) {
            if (!state_[e] || fixed_form(e)) continue;
            const Point a = now_[first_[e]], b = now_[first_[e + 1] - 1];
            const double length = edge_length(e);
            const bool closed = ends_[e][0] == ends_[e][1];
            if (length < gap_ || (!closed && dot(b - a, b - a) < gap_ * gap_)) return {Fault::shorter, e, e, a};
            coarse = coarse || (first_[e + 1] - first_[e] > 2 && length > 2 * reference_length_[e]);
        }
        return coarse ? Finding{Fault::resample} : Finding{};
    }

    Finding check_pairs() const {
        for (int e = 0; e < edges(); ++e) {
            if (state_[e] == 1 || (state_[e] && !rigid_)) {
                const Finding found = check_pair(e, e);
                if (found.fault != Fault::none) return found;
            }
            for (int f = e + 1; f < edges(); ++f) {
                if ((!state_[e] && !state_[f]) || (fixed_form(e) && fixed_form(f))) continue;
                if (apart(boxes_[e], boxes_[f], gap_)) continue;
                const Finding found = check_pair(e, f);
                if (found.fault != Fault::none) return found;
            }
        }
        return {};
    }

    Finding check_pair(int e, int f) const {
        const bool same = e == f, neighbours = same || joined(e, f);
        for (int k = first_[e]; k + 1 < first_[e + 1]; ++k) {
            const Point a = now_[k], b = now_[k + 1];
            const Box ab = box_of(a, b);
            if (!same && apart(ab, boxes_[f], gap_)) continue;
            for (int m = same ? k + 1 : first_[f]; m + 1 < first_[f + 1]; ++m) {
                const Point c = now_[m], d = now_[m + 1];
                if (apart(ab, box_of(c, d), gap_)) continue;
                const Fault fault = neighbours ? check_near(e, k, f, m) : check_apart(a, b, c, d);
                if (fault == Fault::cross) return {fault, e, f, meeting_point(a, b, c, d)};
                if (fault != Fault::none) return {fault, e, f, a};
            }
        }
        return same || !neighbours ? Finding{} : check_round(e, f);
    }

    // Lines and arcs with a common vertex, which no clearance keeps apart: whether they cross by less than the pieces
    // of either one know.
    Finding check_round(int e, int f) const {
        if (!round_[e] || !round_[f]) return {};
        for (int i : {0, 1})
            for (int j : {0, 1}) {
                if (ends_[e][i] != ends_[f][j]) continue;
                const Point shared = now_[i ? first_[e + 1] - 1 : first_[e]];
                if (const auto at = second_meeting(round_of(e), round_of(f), shared)) return {Fault::cross, e, f, *at};
            }
        return {};
    }

    // A line has two samples, and no middle.
    Round round_of(int e) const {
        const int last = first_[e + 1] - 1, middle = (first_[e] + last) / 2;
        return {now_[first_[e]], now_[middle], now_[last]};
    }

    Fault check_apart(Point a, Point b, Point c, Point d) const {
        if (segments_meet(a, b, c, d)) return Fault::cross;
        const double nearest = std::min(std::min(distance2(a, c, d), distance2(b, c, d)),
                                        std::min(distance2(c, a, b), distance2(d, a, b)));
        return nearest < gap_ * gap_ ? Fault::touch : Fault::none;
    }

    // Name of a sample that segments of two edges may share: a vertex, or a sample inside an edge.
    long label(int e, int k) const {
        if (k == first_[e]) return -1 - ends_[e][0];
        if (k == first_[e + 1] - 1) return -1 - ends_[e][1];
        return k;
    }

    // Pieces of one edge or of edges with a common vertex: they may meet there, at no less than the sharpest angle.
    Fault check_near(int e, int k, int f, int m) const {
        const std::array<long, 2> own{label(e, k), label(e, k + 1)}, other{label(f, m), label(f, m + 1)};
        int shared = 0;
        Point u{}, v{};
        for (int i = 0; i < 2; ++i)
            for (int j = 0; j < 2; ++j)
                if (own[i] == other[j]) {
                    ++shared;
                    u = now_[k + 1 - i] - now_[k + i];
                    v = now_[m + 1 - j] - now_[m + j];
                }
        if (shared == 0) return segments_meet(now_[k], now_[k + 1], now_[m], now_[m + 1]) ? Fault::cross : Fault::none;
        const bool folded = shared == 2 || (dot(u, v) > 0 && std::abs(cross(u, v)) < sharpest_ * dot(u, v));
        return folded ? Fault::fold : Fault::none;
    }

    double signed_area(const SampledLoop& loop) const {
        double sum = 0;
        const Point o = now_[first_[loop.edges[0]]];
        for (std::size_t i = 0; i < loop.edges.size(); ++i) {
            double part = 0;
            const int e = loop.edges[i];
            for (int k = first_[e]; k + 1 < first_[e + 1]; ++k) part += cross(now_[k] - o, now_[k + 1] - o);
            sum += loop.forward[i] ? part : -part;
        }
        return 0.5 * sum;
    }

    bool inside(Point p, const SampledLoop& loop) const {
        bool in = false;
        for (int e : loop.edges) {
            const Box& b = boxes_[e];
            if (p.y < b.y0 || p.y > b.y1 || p.x > b.x1) continue;
            for (int k = first_[e]; k + 1 < first_[e + 1]; ++k) {
                const Point a = now_[k], c = now_[k + 1];
                if ((a.y > p.y) != (c.y > p.y) && p.x < a.x + (p.y - a.y) / (c.y - a.y) * (c.x - a.x)) in = !in;
            }
        }
        return in;
    }

    // For each pair of loops the first piece of one that is not part of the other.
    void find_probes() {
        for (std::size_t i = 0; i < loops_.size(); ++i)
            for (std::size_t j = 0; j < loops_.size(); ++j) {
                if (i == j || loops_[j].kind == 2) continue;
                // Outlines lie beside each other, and what is inside one of them has nothing to do with the others.
                if (loops_[i].kind == 0 ? loops_[j].kind != 0 : loops_[i].piece != loops_[j].piece) continue;
                for (int e : loops_[i].edges)
                    if (std::find(loops_[j].edges.begin(), loops_[j].edges.end(), e) == loops_[j].edges.end()) {
                        probes_.push_back({static_cast<int>(i), static_cast<int>(j), first_[e]});
                        break;
                    }
            }
    }

    Finding check_loops() const {
        for (std::size_t l = 0; l < loops_.size(); ++l) {
            if (loop_state_[l] != 3) continue;
            const double area = signed_area(loops_[l]) * (loops_[l].kind == 1 ? -1 : 1);
            if (!(area > gap_ * gap_)) return {Fault::turned, static_cast<int>(l), static_cast<int>(l)};
        }
        for (const auto& [i, j, k] : probes_) {
            if ((loop_state_[i] == 0 && loop_state_[j] == 0) || (loop_state_[i] == 2 && loop_state_[j] == 2)) continue;
            const Point p{0.5 * (now_[k].x + now_[k + 1].x), 0.5 * (now_[k].y + now_[k + 1].y)};
            if (inside(p, loops_[j]) == (loops_[i].kind != 0 && loops_[j].kind == 0)) continue;
            if (loops_[i].kind == 0) return {Fault::overlap, i, j, p};
            return {loops_[j].kind == 0 ? Fault::outside : Fault::nested, i, j, p};
        }
        return {};
    }

    Finding check_spots() const {
        for (int i = 0; i < static_cast<int>(spot_now_.size()); ++i) {
            const Point p = spot_now_[i];
            for (int e = 0; e < edges(); ++e) {
                if (apart({p.x, p.y, p.x, p.y}, boxes_[e], gap_)) continue;
                for (int k = first_[e]; k + 1 < first_[e + 1]; ++k)
                    if (distance2(p, now_[k], now_[k + 1]) < gap_ * gap_) return {Fault::point_near, i, e, p};
            }
            for (int l = 0; l < static_cast<int>(loops_.size()); ++l) {
                if (loops_[l].kind == 2 || loops_[l].piece != spot_pieces_[i] ||
                    inside(p, loops_[l]) == (loops_[l].kind == 0))
                    continue;
                return {loops_[l].kind == 0 ? Fault::point_outside : Fault::point_in_hole, i, l, p};
            }
        }
        return {};
    }

    int edges() const { return static_cast<int>(ends_.size()); }

    struct Probe {
        int inner, outer, sample;
    };

    std::vector<int> first_;
    std::vector<std::array<int, 2>> ends_;
    std::vector<SampledLoop> loops_;
    double gap_, sharpest_;
    std::vector<bool> round_;
    std::vector<int> spot_pieces_;
    std::vector<Probe> probes_;
    std::array<std::vector<Point>, 3> samples_, spots_;
    std::vector<std::uint8_t> state_;
    bool rigid_ = false;
    std::vector<int> loop_state_;  // 0 still, 2 moving rigidly, 3 changing its form
    std::vector<Point> now_, spot_now_;
    std::vector<Box> boxes_;
    std::vector<double> reference_length_;
};

}  // namespace restshape::outline
