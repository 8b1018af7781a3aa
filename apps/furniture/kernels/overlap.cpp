// Separating axes of boxes with cut ends.
#include "overlap.hpp"

namespace restshape::planks {

namespace {

// A plank as it is built: ends that are held are cut along the plane that holds them, so that a flush joint touches.
struct Body {
    std::array<V3<double>, 8> corners;  // bits: +x, +y, +z
    V3<double> low, high;               // of the box about them along the axes of space
    std::array<V3<double>, 5> normals;  // of the faces, then of the four ends
    std::array<V3<double>, 6> edges;    // unit vectors
    int kinds = 3;                      // how many edges differ
};

// The plane that holds an end: a point and a normal.
std::pair<V3<double>, V3<double>> holder(const Piece& P, const Shape<double>& S, int by) {
    if (by < -1) {
        const PlaneSpec& plane = P.planes[P.feet[-2 - by].plane];
        return {plane.point, plane.normal};
    }
    const JointSpec& joint = P.joints[by];
    const V3<double> normal = scaled(column(S.axes[joint.j], 2), sign_of(joint.face));
    return {S.centre[joint.j] + scaled(normal, 0.5 * S.size[joint.j][2]), normal};
}

Body body_of(const Piece& P, const Shape<double>& S, int i) {
    Body body;
    const V3<double> axes[3] = {column(S.axes[i], 0), column(S.axes[i], 1), column(S.axes[i], 2)};
    for (int c = 0; c < 8; ++c) {
        V3<double> p = S.centre[i];
        for (int a = 0; a < 3; ++a) p = p + scaled(axes[a], S.size[i][a] * (c >> a & 1 ? 0.5 : -0.5));
        body.corners[c] = p;
    }
    body.normals[0] = axes[2];
    bool cut = false;
    for (int side = 0; side < 4; ++side) {
        const int a = axis_of(side), by = P.held[4 * i + side];
        body.normals[1 + side] = axes[a];
        if (by == -1) continue;
        const auto [point, normal] = holder(P, S, by);
        const double slope = dot(axes[a], normal);
        if (!(-sign_of(side) * slope >= P.settings.least_slant)) continue;
        body.normals[1 + side] = normal, cut = true;
        for (int c = 0; c < 8; ++c)
            if ((c >> a & 1) == side % 2)
                body.corners[c] = body.corners[c] + scaled(axes[a], dot(point - body.corners[c], normal) / slope);
    }
    for (int a = 0; a < 3; ++a) body.edges[a] = axes[a];
    if (cut) {
        body.kinds = 6;
        for (int c = 0; c < 4; ++c) {
            const V3<double> edge = body.corners[c + 4] - body.corners[c];
            body.edges[2 + c] = scaled(edge, 1.0 / std::sqrt(dot(edge, edge)));
        }
    }
    body.low = body.high = body.corners[0];
    for (const V3<double>& p : body.corners)
        for (int a = 0; a < 3; ++a)
            body.low[a] = std::min(body.low[a], p[a]), body.high[a] = std::max(body.high[a], p[a]);
    return body;
}

// Whether two bodies overlap by no more than `allowed` along an axis.
bool separates(const V3<double>& axis, const Body& a, const Body& b, double allowed) {
    const double size = std::sqrt(dot(axis, axis));
    // Edges that are parallel give no axis of their own.
    if (size < 1e-6) return false;
    double low[2] = {1e300, 1e300}, high[2] = {-1e300, -1e300};
    for (int c = 0; c < 8; ++c) {
        const double at[2] = {dot(a.corners[c], axis), dot(b.corners[c], axis)};
        for (int k = 0; k < 2; ++k) low[k] = std::min(low[k], at[k]), high[k] = std::max(high[k], at[k]);
    }
    return std::min(high[0] - low[1], high[1] - low[0]) <= allowed * size;
}

// Axes along which bodies are compared, by number: the normals of both in turns, then what is normal to an edge of each
// (Gottschalk, Lin and Manocha, OBBTree, 1996).
constexpr int normal_axes = 10, most_edges = 6;

bool separates(int number, const Body& a, const Body& b, double allowed) {
    if (number < normal_axes) return separates((number % 2 ? b : a).normals[number / 2], a, b, allowed);
    const int p = (number - normal_axes) / most_edges, q = (number - normal_axes) % most_edges;
    return p < a.kinds && q < b.kinds && separates(cross(a.edges[p], b.edges[q]), a, b, allowed);
}

// Whether two bodies overlap by more than `allowed` [m] along each of their axes. The number of the axis that separates
// them is tried first the next time; negative: none has done so yet.
bool overlap(const Body& a, const Body& b, double allowed, int& known) {
    for (int k = 0; k < 3; ++k)
        if (std::min(a.high[k] - b.low[k], b.high[k] - a.low[k]) <= allowed) return false;
    if (known >= 0 && separates(known, a, b, allowed)) return false;
    for (int number = 0; number < normal_axes + most_edges * most_edges; ++number)
        if (separates(number, a, b, allowed)) {
            known = number;
            return false;
        }
    return true;
}

}  // namespace

std::vector<std::pair<int, int>> overlaps(const Piece& piece, const Shape<double>& shape, bool first_only,
                                          std::vector<int>* separating) {
    const int n = piece.count();
    std::vector<int> unknown;
    std::vector<int>& known = separating ? *separating : unknown;
    known.resize(n * n, -1);
    const double allowed = piece.settings.interference;
    std::vector<Body> bodies;
    bodies.reserve(n);
    std::vector<std::pair<int, int>> found;
    for (int i = 0; i < n; ++i) {
        bodies.push_back(body_of(piece, shape, i));
        for (size_t k = 0; k < piece.planes.size(); ++k) {
            const PlaneSpec& plane = piece.planes[k];
            double least = 0.0;
            for (const V3<double>& p : bodies[i].corners) least = std::min(least, dot(p - plane.point, plane.normal));
            if (least < -allowed) found.emplace_back(i, -1 - static_cast<int>(k));
            if (first_only && !found.empty()) return found;
        }
    }
    for (int i = 0; i < n; ++i)
        for (int j = i + 1; j < n; ++j) {
            if (!overlap(bodies[i], bodies[j], allowed, known[i * n + j])) continue;
            found.emplace_back(i, j);
            if (first_only) return found;
        }
    return found;
}

}  // namespace restshape::planks
