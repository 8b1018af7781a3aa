// How far triangles may go beside a body before any could come near a bound: what one step has found, the next ones
// need not look for.
//
// Source: docs/theory/cloth.md.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "cloth/triangle_distance.hpp"

namespace restshape {

class TriangleRoom {
 public:
    // Arguments as of `triangle_share`.
    TriangleRoom(const Body& body, std::size_t count, double floor, double deeper, double bottom, double tolerance)
        : body_(body), floor_(floor), deeper_(deeper), bottom_(bottom), tolerance_(tolerance), known_(count) {}

    std::size_t count() const { return known_.size(); }
    // Triangles that have been looked at.
    std::size_t looks() const { return looks_; }

    // `triangle_share` of a triangle, which is 1 within its room.
    double share(std::size_t e, const Vec3* p, const Vec3* d) {
        Known& own = known_[e];
        if (own.holds(p, d)) return 1.0;
        ++looks_;
        own = around(p);
        return own.holds(p, d) ? 1.0 : triangle_share(body_, p, d, floor_, deeper_, bottom_, tolerance_);
    }

 private:
    struct Known {
        Vec3 at[3] = {};
        double room = -1.0;  // how far all corners may go from there

        bool holds(const Vec3* p, const Vec3* d) const {
            if (!(room > 0.0)) return false;
            for (int i = 0; i < 3; ++i) {
                const Vec3 begin = p[i] - at[i], end = begin + d[i];
                if (!(inner(begin.c, begin) <= room * room && inner(end.c, end) <= room * room)) return false;
            }
            return true;
        }
    };

    // From the distance at the middle: a little less than what is left above the bound, over the steepest slope.
    Known around(const Vec3* p) const {
        Known found{{p[0], p[1], p[2]}, -1.0};
        const Vec3 centre = (1.0 / 3.0) * (p[0] + p[1] + p[2]);
        const Distance middle = body_.distance(centre.c, false);
        double slope = 0.0, farthest = 0.0;
        for (int i = 0; i < 3; ++i) {
            const Vec3 way = p[i] - centre;
            slope = std::min(slope, inner(middle.gradient, way));
            farthest = std::max(farthest, inner(way.c, way));
        }
        const double least = middle.value + below(body_, centre.c, slope, farthest);
        found.room = (least - floor_ - 3.0 * tolerance_) / body_.slope();
        return found;
    }

    Body body_;
    double floor_, deeper_, bottom_, tolerance_;
    std::vector<Known> known_;
    std::size_t looks_ = 0;
};

}  // namespace restshape
