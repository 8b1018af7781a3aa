// How ends are closed, and what joints, feet and loads then measure.
#pragma once

#include <cmath>

#include "shape.hpp"

namespace restshape::planks {

template <class T>
class Shaper {
 public:
    // gamma: 8 design parameters a plank, [m], [rad], [m]; null is the piece as it is.
    Shaper(const Piece& piece, const T* gamma, Shape<T>& shape) : P(piece), S(shape) {
        S.faults.clear();
        place(gamma);
        close();
        measure();
    }

 private:
    const Piece& P;
    Shape<T>& S;

    void note(Fault fault, int where) {
        if (fault != Fault::none) S.faults.push_back({fault, where});
    }

    void place(const T* gamma) {
        const int n = P.count();
        S.centre.resize(n), S.size.resize(n), S.axes.resize(n);
        for (int i = 0; i < n; ++i) {
            for (int a = 0; a < 3; ++a) S.centre[i][a] = P.centre[i][a], S.size[i][a] = P.size[i][a];
            for (int a = 0; a < 9; ++a) S.axes[i][a] = P.axes[i][a];
            if (gamma) place(i, gamma + freedoms * i);
        }
    }

    void place(int i, const T* g) {
        S.centre[i] = S.centre[i] + times(P.axes[i], V3<T>{g[0], g[1], g[2]});
        const Turn<T> t = turn(unwound(V3<T>{g[3], g[4], g[5]}));
        for (int k = 0; k < 3; ++k) {
            const V3<T> turned_axis = times(P.axes[i], column(t.less_one, k));
            for (int r = 0; r < 3; ++r) S.axes[i][3 * r + k] = P.axes[i][3 * r + k] + turned_axis[r];
        }
        for (int a = 0; a < 2; ++a) {
            const bool low = P.held[4 * i + 2 * a] != -1, high = P.held[4 * i + 2 * a + 1] != -1;
            if (low && high) continue;
            S.size[i][a] += g[6 + a];
            const double way = low ? 0.5 : high ? -0.5 : 0.0;
            if (way != 0.0) S.centre[i] = S.centre[i] + scaled(column(S.axes[i], a), g[6 + a] * way);
        }
    }

    V3<T> end(int i, int side) const {
        const int a = axis_of(side);
        return S.centre[i] + scaled(column(S.axes[i], a), S.size[i][a] * (0.5 * sign_of(side)));
    }
    V3<T> face_point(int j, int face) const { return end(j, face); }
    V3<T> face_normal(int j, int face) const { return scaled(column(S.axes[j], 2), sign_of(face)); }

    // Ends that are held move along their plank into the plane that holds them. That leaves all faces where they are,
    // so that each end can be closed on its own.
    void close() {
        for (int i = 0; i < P.count(); ++i)
            for (int side = 0; side < 4; ++side) {
                const int by = P.held[4 * i + side];
                if (by == -1) continue;
                if (by >= 0) {
                    const JointSpec& joint = P.joints[by];
                    close(i, side, face_point(joint.j, joint.face), face_normal(joint.j, joint.face));
                } else {
                    const PlaneSpec& plane = P.planes[P.feet[-2 - by].plane];
                    V3<T> point, normal;
                    for (int a = 0; a < 3; ++a) point[a] = plane.point[a], normal[a] = plane.normal[a];
                    close(i, side, point, normal);
                }
            }
        for (int i = 0; i < P.count(); ++i)
            for (int a = 0; a < 2; ++a)
                if (!(value(S.size[i][a]) >= P.settings.least_overlap)) note(Fault::length, i);
    }

    void close(int i, int side, const V3<T>& point, const V3<T>& normal) {
        const int a = axis_of(side);
        const double sign = sign_of(side);
        const T slope = dot(column(S.axes[i], a), normal);
        // An end comes to a plane from the side that its normal points to.
        if (!(-sign * value(slope) >= P.settings.least_slant))
            return note(-sign * value(slope) <= -P.settings.least_slant ? Fault::behind : Fault::slant, 4 * i + side);
        const T more = dot(point - end(i, side), normal) / slope * sign;
        S.size[i][a] += more;
        S.centre[i] = S.centre[i] + scaled(column(S.axes[i], a), more * (0.5 * sign));
    }

    void measure() {
        const size_t n = P.centre.size();
        S.mass.resize(n);
        for (size_t i = 0; i < n; ++i) S.mass[i] = S.size[i][0] * S.size[i][1] * S.size[i][2] * P.density[i];
        S.joints.resize(P.joints.size());
        for (size_t k = 0; k < P.joints.size(); ++k)
            measure(P.joints[k], S.joints[k]), note(S.joints[k].fault, static_cast<int>(k));
        S.contacts.resize(4 * P.feet.size());
        S.foot_faults.resize(P.feet.size());
        for (size_t k = 0; k < P.feet.size(); ++k) {
            S.foot_faults[k] = measure(P.feet[k], &S.contacts[4 * k]);
            note(S.foot_faults[k], static_cast<int>(k));
        }
        S.load_arms.resize(P.loads.size());
        for (size_t k = 0; k < P.loads.size(); ++k) {
            const int i = P.loads[k].plank;
            const V3<double>& s = P.loads[k].place;
            S.load_arms[k] = times(S.axes[i], V3<T>{S.size[i][0] * s[0], S.size[i][1] * s[1], S.size[i][2] * s[2]});
        }
    }

    void measure(const JointSpec& spec, JointShape<T>& joint) const {
        const V3<T> e = end(spec.i, spec.side);
        const int along = 1 - axis_of(spec.side);
        joint.y = column(S.axes[spec.i], along);
        joint.n = face_normal(spec.j, spec.face);
        joint.x = cross(joint.y, joint.n);
        T low = S.size[spec.i][along] * -0.5, high = S.size[spec.i][along] * 0.5;
        const bool meets = clip(spec.j, e, joint.y, low, high);
        joint.length = high - low;
        joint.p = e + scaled(joint.y, (low + high) * 0.5);
        joint.arm_i = joint.p - S.centre[spec.i];
        joint.arm_j = joint.p - S.centre[spec.j];
        const double length = value(joint.length);
        joint.nails = std::max(1.0, std::floor(length / spec.spacing + 1e-6));
        const double gap = value(dot(e - face_point(spec.j, spec.face), joint.n));
        const double tilt = 0.5 * value(S.size[spec.i][along]) * value(dot(joint.y, joint.n));
        joint.fault = Fault::none;
        if (!meets || !(length >= P.settings.least_overlap)) joint.fault = Fault::overlap;
        if (!(std::abs(gap) + std::abs(tilt) <= P.settings.gap)) joint.fault = Fault::gap;
    }

    // Cuts the end's line e + s y, low <= s <= high, to the face of plank j.
    bool clip(int j, const V3<T>& e, const V3<T>& y, T& low, T& high) const {
        const V3<T> q = transposed_times(S.axes[j], e - S.centre[j]), d = transposed_times(S.axes[j], y);
        for (int a = 0; a < 2; ++a) {
            const T half = S.size[j][a] * 0.5;
            if (std::abs(value(d[a])) < 1e-9) {
                // An end that is drawn on the very edge of the face lies on it, however its numbers are rounded.
                if (std::abs(value(q[a])) > value(half) + 1e-9) return false;
                continue;
            }
            const double way = value(d[a]) > 0.0 ? 1.0 : -1.0;
            const T first = (half * -way - q[a]) / d[a], last = (half * way - q[a]) / d[a];
            // A side of the face that the end just reaches does not count as cutting it.
            if (value(first) > value(low) + 1e-9) low = first;
            if (value(last) < value(high) - 1e-9) high = last;
        }
        return value(high) > value(low);
    }

    // The four points where the long edges of a plank meet the plane: an end is cut along what it stands on.
    Fault measure(const FootSpec& foot, Contact<T>* contacts) const {
        const PlaneSpec& plane = P.planes[foot.plane];
        const int i = foot.plank, a = axis_of(foot.side), b = (a + 1) % 3, c = (a + 2) % 3;
        const V3<T> e = end(i, foot.side), axis = column(S.axes[i], a);
        const T slope = dot(axis, plane.normal);
        double tilt = std::abs(value(dot(e - plane.point, plane.normal)));
        for (int k = 0; k < 4; ++k) {
            const T along = S.size[i][b] * (k % 2 ? 0.5 : -0.5), across = S.size[i][c] * (k / 2 ? 0.5 : -0.5);
            V3<T> offset = scaled(column(S.axes[i], b), along) + scaled(column(S.axes[i], c), across);
            const T off = dot(offset, plane.normal);
            if (a == 2) {
                tilt = std::max(tilt, std::abs(value(off)));
            } else {
                const T part = b == 2 ? along : across;
                const T rest = off - part * dot(column(S.axes[i], 2), plane.normal);
                tilt = std::max(tilt, std::abs(value(rest)));
                offset = offset - scaled(axis, off / slope);
            }
            contacts[k] = {i, e + offset, e + offset - S.centre[i], plane.normal, plane.mu};
        }
        return tilt <= P.settings.gap ? Fault::none : Fault::foot;
    }
};

}  // namespace restshape::planks
