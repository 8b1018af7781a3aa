// Membranes of cloth.
#include "cloth/corotated.hpp"
#include "fem/element.hpp"

namespace restshape {

std::vector<Element> membrane_elements() {
    return {
        element_of<MembraneElement<false>>("membrane", "tri3"),
        element_of<MembraneElement<true>>("membrane_stabilised", "tri3"),
        element_of<MembraneTensionElement>("membrane_tension", "tri3"),
        element_of<CorotatedMembraneElement>("membrane_corotated", "tri3"),
        element_of<CorotatedStabilisedElement>("membrane_corotated_stabilised", "tri3"),
    };
}

}  // namespace restshape
