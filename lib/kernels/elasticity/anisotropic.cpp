// Anisotropic solids.
#include "elasticity/anisotropic.hpp"

#include "fem/element.hpp"
#include "fem/straight.hpp"

namespace restshape {

std::vector<Element> anisotropic_elements() {
    return {
        element_of<AnisotropicElement<Tri3>>("anisotropic", "tri3"),
        element_of<AnisotropicElement<Tri6Small>>("anisotropic", "tri6"),
        element_of<AnisotropicElement<Tet4>>("anisotropic", "tet4"),
        element_of<EitherElement<AnisotropicElement<Tet10>, AnisotropicElement<Tet10Straight>>>("anisotropic", "tet10"),
    };
}

}  // namespace restshape
