// Potentials at nodes.
#include "cloth/point.hpp"

#include "fem/element.hpp"

namespace restshape {

std::vector<Element> point_elements() {
    return {
        element_of<PointPotentialElement>("potential", "point1"),
    };
}

}  // namespace restshape
