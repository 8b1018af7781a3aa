// The nearest place of a triangle mesh, its generalised winding number, and where rays meet it (CGAL's tree of boxes).
//
// The nearest place of one triangle: Ericson, Real-time collision detection (2005), 5.1.5.
// Far triangles count together as one dipole: Barill, Dickson, Schmidt, Levin, Jacobson, Fast winding numbers for soups
// and clouds, ACM Transactions on Graphics 37 (2018). Near ones count by the solid angle of van Oosterom and Strackee.
#pragma once

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

#include "cloth/nearest_place.hpp"

namespace restshape {

// The corners of a triangle.
struct Face {
    double x[3][3];
};

inline double square_of_distance(const Face& face, const double* y) {
    double at[3], square = 0.0;
    nearest_place(face.x[0], face.x[1], face.x[2], y, at);
    for (int a = 0; a < 3; ++a) square += (y[a] - at[a]) * (y[a] - at[a]);
    return square;
}

class SurfaceSearch {
    using Kernel = CGAL::Simple_cartesian<double>;
    using Point = Kernel::Point_3;
    using Faces = std::vector<Kernel::Triangle_3>;
    using Primitive = CGAL::AABB_triangle_primitive<Kernel, Faces::const_iterator>;
    using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

 public:
    // x: corners (n, 3); cells: triangles (m, 3) of them, none without area.
    SurfaceSearch(const double* x, const int32_t* cells, std::size_t count) {
        for (std::size_t e = 0; e < count; ++e) {
            Point p[3];
            for (int i = 0; i < 3; ++i) {
                const double* at = x + 3 * static_cast<std::size_t>(cells[3 * e + i]);
                p[i] = Point(at[0], at[1], at[2]);
            }
            faces_.emplace_back(p[0], p[1], p[2]);
        }
        tree_.insert(faces_.begin(), faces_.end());
        tree_.build();
        order_.resize(count);
        std::iota(order_.begin(), order_.end(), 0);
        if (count) split(0, count);
    }

    // The nearest place of the surface, not farther than a place of it that is known.
    void nearest(const double* y, double* hint) const {
        double best = 0.0;
        for (int a = 0; a < 3; ++a) best += (y[a] - hint[a]) * (y[a] - hint[a]);
        if (!clusters_.empty()) nearest(clusters_[0], y, hint, best);
    }
    void any_place(double* hint) const {
        for (int a = 0; a < 3; ++a) hint[a] = faces_.front()[0][a];
    }

    // Faces of which one is nearest to any place within a reach of y. Returns how far y is from the surface.
    double within_reach(const double* y, double reach, std::vector<Face>& found) const {
        double place[3], best = 0.0;
        any_place(place);
        nearest(y, place);
        for (int a = 0; a < 3; ++a) best += (y[a] - place[a]) * (y[a] - place[a]);
        const double far = std::sqrt(best) * (1.0 + 1e-12) + 2.0 * reach;
        found.clear();
        collect(clusters_[0], y, far * far, found);
        return std::sqrt(best);
    }

    // Where a ray first leaves the surface behind it; infinite where it never does.
    double first_hit(const double* from, const double* way) const {
        const Kernel::Ray_3 ray(Point(from[0], from[1], from[2]), Kernel::Vector_3(way[0], way[1], way[2]));
        std::vector<Tree::Intersection_and_primitive_id<Kernel::Ray_3>::Type> hits;
        tree_.all_intersections(ray, std::back_inserter(hits));
        double least = std::numeric_limits<double>::infinity();
        for (const auto& hit : hits)
            if (const Point* at = boost::get<Point>(&hit.first))
                least = std::min(least, std::sqrt(CGAL::squared_distance(*at, ray.source())));
        return least;
    }

    // 1 inside, 0 outside of a closed surface. Dipoles are farther away than `far` of their radii.
    double winding(const double* y, double far) const { return faces_.empty() ? 0.0 : winding(0, y, far) / (4 * M_PI); }

 private:
    struct Cluster {
        double centre[3], normal[3], radius;
        std::size_t first, last, left, right;  // without parts left is 0
        double low[3], high[3];                // box of its faces
    };

    std::size_t split(std::size_t first, std::size_t last) {
        const std::size_t own = clusters_.size();
        clusters_.emplace_back();
        Cluster made = dipole(first, last);
        if (last - first > 8) {
            double low[3], high[3];
            bounds(first, last, low, high);
            int axis = 0;
            for (int a = 1; a < 3; ++a)
                if (high[a] - low[a] > high[axis] - low[axis]) axis = a;
            const std::size_t middle = (first + last) / 2;
            const auto begin = order_.begin();
            std::nth_element(begin + first, begin + middle, begin + last, [&](std::size_t i, std::size_t j) {
                const double a = centroid(i, axis), b = centroid(j, axis);
                return a < b || (a == b && i < j);
            });
            made.left = split(first, middle);
            made.right = split(middle, last);
        }
        clusters_[own] = made;
        return own;
    }

    double centroid(std::size_t face, int axis) const {
        return (faces_[face][0][axis] + faces_[face][1][axis] + faces_[face][2][axis]) / 3;
    }
    void bounds(std::size_t first, std::size_t last, double* low, double* high) const {
        for (int a = 0; a < 3; ++a) {
            low[a] = std::numeric_limits<double>::infinity(), high[a] = -low[a];
            for (std::size_t k = first; k < last; ++k) {
                low[a] = std::min(low[a], centroid(order_[k], a));
                high[a] = std::max(high[a], centroid(order_[k], a));
            }
        }
    }

    Cluster dipole(std::size_t first, std::size_t last) const {
        Cluster made{{0, 0, 0}, {0, 0, 0}, 0.0, first, last, 0, 0, {0, 0, 0}, {0, 0, 0}};
        double all = 0.0;
        for (std::size_t k = first; k < last; ++k) {
            const auto& face = faces_[order_[k]];
            const auto normal = CGAL::cross_product(face[1] - face[0], face[2] - face[0]) / 2;
            const double area = std::sqrt(normal.squared_length());
            all += area;
            for (int a = 0; a < 3; ++a) {
                made.normal[a] += normal[a];
                made.centre[a] += area * centroid(order_[k], a);
            }
        }
        for (double& c : made.centre) c /= all;
        for (std::size_t k = first; k < last; ++k)
            for (int i = 0; i < 3; ++i) {
                double square = 0.0;
                for (int a = 0; a < 3; ++a) square += std::pow(faces_[order_[k]][i][a] - made.centre[a], 2);
                made.radius = std::max(made.radius, square);
            }
        made.radius = std::sqrt(made.radius);
        for (int a = 0; a < 3; ++a) {
            made.low[a] = std::numeric_limits<double>::infinity(), made.high[a] = -made.low[a];
            for (std::size_t k = first; k < last; ++k)
                for (int i = 0; i < 3; ++i) {
                    made.low[a] = std::min(made.low[a], faces_[order_[k]][i][a]);
                    made.high[a] = std::max(made.high[a], faces_[order_[k]][i][a]);
                }
        }
        return made;
    }

    // The square of the distance of a box.
    static double before(const Cluster& cluster, const double* y) {
        double square = 0.0;
        for (int a = 0; a < 3; ++a) {
            const double way = std::max(std::max(cluster.low[a] - y[a], y[a] - cluster.high[a]), 0.0);
            square += way * way;
        }
        return square;
    }

    void collect(const Cluster& cluster, const double* y, double most, std::vector<Face>& found) const {
        if (before(cluster, y) > most) return;
        if (cluster.left) {
            collect(clusters_[cluster.left], y, most, found);
            collect(clusters_[cluster.right], y, most, found);
            return;
        }
        for (std::size_t k = cluster.first; k < cluster.last; ++k) {
            const Face face = corners(order_[k]);
            if (square_of_distance(face, y) <= most) found.push_back(face);
        }
    }

    Face corners(std::size_t face) const {
        Face found;
        for (int i = 0; i < 3; ++i)
            for (int a = 0; a < 3; ++a) found.x[i][a] = faces_[face][i][a];
        return found;
    }

    // Improves a place, whose squared distance is `best`; of two parts the nearer one is first.
    void nearest(const Cluster& cluster, const double* y, double* place, double& best) const {
        if (!cluster.left) {
            for (std::size_t k = cluster.first; k < cluster.last; ++k) {
                const Face face = corners(order_[k]);
                double at[3];
                nearest_place(face.x[0], face.x[1], face.x[2], y, at);
                const double way[3] = {y[0] - at[0], y[1] - at[1], y[2] - at[2]}, square = inner(way, way);
                if (square < best) best = square, std::copy(at, at + 3, place);
            }
            return;
        }
        const Cluster *near = &clusters_[cluster.left], *far = &clusters_[cluster.right];
        double least = before(*near, y), most = before(*far, y);
        if (most < least) std::swap(near, far), std::swap(least, most);
        if (least < best) nearest(*near, y, place, best);
        if (most < best) nearest(*far, y, place, best);
    }

    // Solid angles, which are 4 pi inside.
    double winding(std::size_t own, const double* y, double far) const {
        const Cluster& cluster = clusters_[own];
        double way[3], square = 0.0, flux = 0.0;
        for (int a = 0; a < 3; ++a) {
            way[a] = cluster.centre[a] - y[a];
            square += way[a] * way[a];
            flux += way[a] * cluster.normal[a];
        }
        if (square > far * far * cluster.radius * cluster.radius) return flux / (square * std::sqrt(square));
        if (cluster.left) return winding(cluster.left, y, far) + winding(cluster.right, y, far);
        double total = 0.0;
        for (std::size_t k = cluster.first; k < cluster.last; ++k) total += solid_angle(faces_[order_[k]], y);
        return total;
    }

    static double solid_angle(const Kernel::Triangle_3& face, const double* y) {
        double p[3][3], length[3];
        for (int i = 0; i < 3; ++i) {
            for (int a = 0; a < 3; ++a) p[i][a] = face[i][a] - y[a];
            length[i] = std::sqrt(inner(p[i], p[i]));
        }
        const double volume = p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1]) +
                              p[0][1] * (p[1][2] * p[2][0] - p[1][0] * p[2][2]) +
                              p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0]);
        const double below = length[0] * length[1] * length[2] + inner(p[0], p[1]) * length[2] +
                             inner(p[1], p[2]) * length[0] + inner(p[2], p[0]) * length[1];
        return 2 * std::atan2(volume, below);
    }
    static double inner(const double* a, const double* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

    Faces faces_;
    Tree tree_;
    std::vector<std::size_t> order_;
    std::vector<Cluster> clusters_;
};

}  // namespace restshape
