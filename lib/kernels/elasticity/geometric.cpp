// Geometric stiffness of plane solids.
#include "elasticity/geometric.hpp"

#include "fem/element.hpp"

namespace restshape {

std::vector<Element> geometric_elements() {
    return {
        element_of<GeometricElement<Tri3, false>>("geometric", "tri3"),
        element_of<GeometricElement<Tri6, false>>("geometric", "tri6"),
        element_of<GeometricElement<Tri6, true>>("geometric_dilatation", "tri6"),
    };
}

}  // namespace restshape
