// Solids whose dilatation is its mean over the element.
#include "elasticity/dilatation.hpp"

#include "fem/element.hpp"

namespace restshape {

std::vector<Element> dilatation_elements() {
    return {
        element_of<DilatationElement<Tri6Small, LinearElastic<2>>>("linear_elastic_dilatation", "tri6"),
        element_of<DilatationElement<Tri6, StVenantKirchhoff<2>>>("stvk_dilatation", "tri6"),
    };
}

}  // namespace restshape
