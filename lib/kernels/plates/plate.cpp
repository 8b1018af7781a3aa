// Plates and their inertia.
#include "plates/plate.hpp"

#include "fem/element.hpp"

namespace restshape {

std::vector<Element> plate_elements() {
    return {
        element_of<PlateElement>("plate", "tri3"),
        element_of<PlateMassElement>("mass_plate", "tri3"),
    };
}

}  // namespace restshape
