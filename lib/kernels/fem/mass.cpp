// Inertia of solids.
#include "fem/mass.hpp"

#include "fem/element.hpp"
#include "fem/straight.hpp"
#include "fem/straight_mass.hpp"

namespace restshape {

std::vector<Element> mass_elements() {
    return {
        element_of<SimplexMassElement<Tri3, 2>>("mass", "tri3"),
        element_of<MassElement<Tri6Mass, 2>>("mass", "tri6"),
        element_of<SimplexMassElement<Tet4, 3>>("mass", "tet4"),
        element_of<EitherElement<MassElement<Tet10Mass, 3>, StraightMassElement<Tet10Mass, 3>>>("mass", "tet10"),
        element_of<LumpedMassElement<Tri3, 2>>("lumped_mass", "tri3"),
        element_of<ScaledMassElement<Tri6Mass, 2>>("lumped_mass", "tri6"),
        element_of<LumpedMassElement<Tet4, 3>>("lumped_mass", "tet4"),
        element_of<ScaledMassElement<Tet10Mass, 3>>("lumped_mass", "tet10"),
    };
}

}  // namespace restshape
