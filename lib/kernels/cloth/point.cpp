// Potentials at nodes and at points of triangles.
#include "cloth/point.hpp"

#include "fem/element.hpp"

namespace restshape {

std::vector<Element> point_elements() {
    return {
        element_of<PointPotentialElement>("potential", "point1"),
        element_of<TrianglePotentialElement>("potential", "tri3"),
        element_of<PointCouplingElement>("coupling", "point2"),
    };
}

}  // namespace restshape
