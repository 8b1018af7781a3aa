// Loads on the sides of an outline.
#include "elasticity/traction.hpp"

#include "elasticity/pressure.hpp"
#include "fem/element.hpp"

namespace restshape {

std::vector<Element> traction_elements() {
    return {
        element_of<TractionElement<Line2>>("traction", "edge2"),
        element_of<TractionElement<Line3>>("traction", "edge3"),
        element_of<PressureElement<Line2>>("pressure", "edge2"),
        element_of<PressureElement<Line3>>("pressure", "edge3"),
    };
}

}  // namespace restshape
