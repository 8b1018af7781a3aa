// The elements that exist: one line each.
#include <stdexcept>

#include "element.hpp"
#include "element_mass.hpp"
#include "element_solid.hpp"
#include "element_traction.hpp"

namespace restshape {

const std::vector<Element>& elements() {
    static const std::vector<Element> all = {
        element_of<SolidElement<Tri3, LinearElastic<2>>>("linear_elastic_tri3"),
        element_of<SolidElement<Tri6, LinearElastic<2>>>("linear_elastic_tri6"),
        element_of<SolidElement<Tet4, LinearElastic<3>>>("linear_elastic_tet4"),
        element_of<SolidElement<Tet10, LinearElastic<3>>>("linear_elastic_tet10"),
        element_of<SolidElement<Tri3, StVenantKirchhoff<2>>>("stvk_tri3"),
        element_of<SimplexMassElement<Tri3, 2>>("mass_tri3"),
        element_of<LumpedMassElement<Tri3, 2>>("lumped_mass_tri3"),
        element_of<TractionElement<Line2>>("traction_edge2"),
        element_of<TractionElement<Line3>>("traction_edge3"),
    };
    return all;
}

const Element& element(const std::string& name) {
    std::string known;
    for (const Element& e : elements()) {
        if (e.name == name) return e;
        known += (known.empty() ? "" : ", ") + e.name;
    }
    throw std::invalid_argument("no element \"" + name + "\"; there are " + known);
}

}  // namespace restshape
