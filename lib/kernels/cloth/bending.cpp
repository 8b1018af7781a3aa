// Bending of cloth, and halves of hinges at mirrors.
#include "cloth/bending.hpp"

#include "cloth/hinge.hpp"
#include "cloth/mirrored.hpp"
#include "fem/element.hpp"

namespace restshape {

std::vector<Element> bending_elements() {
    return {
        element_of<HingeElement>("hinge", "flap4"),
        element_of<NonlinearHingeElement>("hinge_nonlinear", "flap4"),
        element_of<MirroredElement<HingeElement>>("hinge_mirrored", "flap3"),
        element_of<MirroredElement<NonlinearHingeElement>>("hinge_nonlinear_mirrored", "flap3"),
        element_of<MorleyElement>("morley", "tri6"),
    };
}

}  // namespace restshape
