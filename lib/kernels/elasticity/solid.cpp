// Isotropic solids of both laws.
#include "elasticity/solid.hpp"

#include "fem/element.hpp"
#include "fem/straight.hpp"

namespace restshape {

std::vector<Element> solid_elements() {
    return {
        element_of<SolidElement<Tri3, LinearElastic<2>>>("linear_elastic", "tri3"),
        element_of<SolidElement<Tri6Small, LinearElastic<2>>>("linear_elastic", "tri6"),
        element_of<SolidElement<Tet4, LinearElastic<3>>>("linear_elastic", "tet4"),
        element_of<EitherElement<SolidElement<Tet10, LinearElastic<3>>, SolidElement<Tet10Straight, LinearElastic<3>>>>(
            "linear_elastic", "tet10"),
        element_of<SolidElement<Tri3, StVenantKirchhoff<2>>>("stvk", "tri3"),
        element_of<SolidElement<Tri6, StVenantKirchhoff<2>>>("stvk", "tri6"),
        element_of<SolidElement<Tet4, StVenantKirchhoff<3>>>("stvk", "tet4"),
        element_of<SolidElement<Tet10, StVenantKirchhoff<3>>>("stvk", "tet10"),
    };
}

}  // namespace restshape
