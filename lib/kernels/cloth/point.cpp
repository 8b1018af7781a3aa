// Potentials at nodes and at points of triangles, and springs of seams.
#include "cloth/point.hpp"

#include "cloth/seam.hpp"
#include "fem/element.hpp"

namespace restshape {

std::vector<Element> point_elements() {
    return {
        element_of<PointPotentialElement>("potential", "point1"),
        element_of<TrianglePotentialElement>("potential", "tri3"),
        element_of<PointCouplingElement>("coupling", "point2"),
        element_of<SeamEdgeElement>("seam", "edge3"),
        element_of<SeamFlatElement>("seam_flat", "flap6"),
        element_of<SeamSlopeElement>("seam_slope", "point2"),
    };
}

}  // namespace restshape
