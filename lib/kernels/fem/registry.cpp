// The elements that exist: one line a file of them.
// clang-format off
#define RESTSHAPE_ELEMENT_FILES(file) \
    file(mass_elements) \
    file(solid_elements) \
    file(dilatation_elements) \
    file(geometric_elements) \
    file(anisotropic_elements) \
    file(traction_elements) \
    file(plate_elements) \
    file(membrane_elements) \
    file(bending_elements) \
    file(point_elements) \
    file(stokes_elements) \
    file(stabilised_flow_elements) \
    file(advected_heat_elements) \
    file(curved_slip_elements) \
    file(backflow_elements) \
    file(heat_elements)
// clang-format on

#include <stdexcept>

#include "fem/element.hpp"

namespace restshape {

#define RESTSHAPE_DECLARE(file) std::vector<Element> file();
RESTSHAPE_ELEMENT_FILES(RESTSHAPE_DECLARE)

std::map<std::string, Tally>& tallies() {
    static std::map<std::string, Tally> all;
    return all;
}

namespace {

std::vector<Element> registered() {
    std::vector<Element> all;
#define RESTSHAPE_APPEND(file) \
    for (Element & e : file()) all.push_back(std::move(e));
    RESTSHAPE_ELEMENT_FILES(RESTSHAPE_APPEND)
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
