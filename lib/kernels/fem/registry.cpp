// The elements that exist: one line each.
#include <stdexcept>

#include "element.hpp"
#include "element_anisotropic.hpp"
#include "element_bending.hpp"
#include "element_corotated.hpp"
#include "element_dilatation.hpp"
#include "element_geometric.hpp"
#include "element_hinge.hpp"
#include "element_mass.hpp"
#include "element_membrane.hpp"
#include "element_mirrored.hpp"
#include "element_plate.hpp"
#include "element_point.hpp"
#include "element_pressure.hpp"
#include "element_solid.hpp"
#include "element_straight.hpp"
#include "element_traction.hpp"

namespace restshape {

std::map<std::string, Tally>& tallies() {
    static std::map<std::string, Tally> all;
    return all;
}

namespace {

std::vector<Element> registered() {
    std::vector<Element> all = {
        element_of<SolidElement<Tri3, LinearElastic<2>>>("linear_elastic_tri3"),
        element_of<SolidElement<Tri6Small, LinearElastic<2>>>("linear_elastic_tri6"),
        element_of<SolidElement<Tet4, LinearElastic<3>>>("linear_elastic_tet4"),
        element_of<EitherElement<SolidElement<Tet10, LinearElastic<3>>, SolidElement<Tet10Straight, LinearElastic<3>>>>(
            "linear_elastic_tet10"),
        element_of<SolidElement<Tri3, StVenantKirchhoff<2>>>("stvk_tri3"),
        element_of<SolidElement<Tri6, StVenantKirchhoff<2>>>("stvk_tri6"),
        element_of<SolidElement<Tet4, StVenantKirchhoff<3>>>("stvk_tet4"),
        element_of<SolidElement<Tet10, StVenantKirchhoff<3>>>("stvk_tet10"),
        element_of<DilatationElement<Tri6Small, LinearElastic<2>>>("linear_elastic_dilatation_tri6"),
        element_of<DilatationElement<Tri6, StVenantKirchhoff<2>>>("stvk_dilatation_tri6"),
        element_of<GeometricElement<Tri3, false>>("geometric_tri3"),
        element_of<GeometricElement<Tri6, false>>("geometric_tri6"),
        element_of<GeometricElement<Tri6, true>>("geometric_dilatation_tri6"),
        element_of<AnisotropicElement<Tri3>>("anisotropic_tri3"),
        element_of<AnisotropicElement<Tri6Small>>("anisotropic_tri6"),
        element_of<AnisotropicElement<Tet4>>("anisotropic_tet4"),
        element_of<EitherElement<AnisotropicElement<Tet10>, AnisotropicElement<Tet10Straight>>>("anisotropic_tet10"),
        element_of<PlateElement>("plate_tri3"),
        element_of<PlateMassElement>("mass_plate_tri3"),
        element_of<MembraneElement<false>>("membrane_tri3"),
        element_of<MembraneElement<true>>("membrane_stabilised_tri3"),
        element_of<CorotatedMembraneElement>("membrane_corotated_tri3"),
        element_of<HingeElement>("hinge4"),
        element_of<NonlinearHingeElement>("hinge_nonlinear4"),
        element_of<MirroredElement<HingeElement>>("hinge_mirrored3"),
        element_of<MirroredElement<NonlinearHingeElement>>("hinge_nonlinear_mirrored3"),
        element_of<MorleyElement>("morley_tri6"),
        element_of<PointPotentialElement>("potential_point1"),
        element_of<SimplexMassElement<Tri3, 3>>("mass_cloth_tri3"),
        element_of<LumpedMassElement<Tri3, 3>>("lumped_mass_cloth_tri3"),
        element_of<SimplexMassElement<Tri3, 2>>("mass_tri3"),
        element_of<MassElement<Tri6Mass, 2>>("mass_tri6"),
        element_of<SimplexMassElement<Tet4, 3>>("mass_tet4"),
        element_of<EitherElement<MassElement<Tet10Mass, 3>, StraightMassElement<Tet10Mass, 3>>>("mass_tet10"),
        element_of<LumpedMassElement<Tri3, 2>>("lumped_mass_tri3"),
        element_of<ScaledMassElement<Tri6Mass, 2>>("lumped_mass_tri6"),
        element_of<LumpedMassElement<Tet4, 3>>("lumped_mass_tet4"),
        element_of<ScaledMassElement<Tet10Mass, 3>>("lumped_mass_tet10"),
        element_of<TractionElement<Line2>>("traction_edge2"),
        element_of<TractionElement<Line3>>("traction_edge3"),
        element_of<PressureElement<Line2>>("pressure_edge2"),
        element_of<PressureElement<Line3>>("pressure_edge3"),
    };
    for (Element& e : all) e.tally = &tallies()[e.name];
    return all;
}

}  // namespace

const std::vector<Element>& elements() {
    static const std::vector<Element> all = registered();
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
