// Binding of the energy and forces of a sheet in one pass.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <algorithm>
#include <stdexcept>
#include <string>

#include "cloth/sheet.hpp"
#include "fem/element.hpp"
#include "require.hpp"

namespace py = pybind11;
using namespace pybind11::literals;
using restshape::Purpose;

namespace {

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Output = py::array_t<double, py::array::c_style>;
using Cells = py::array_t<int32_t, py::array::c_style | py::array::forcecast>;

using restshape::require;

class Sheet {
 public:
    Sheet(const Doubles& X, const Cells& corners, const Doubles& moduli, const std::string& bends, const Cells& cells,
          const Doubles& stiffness)
        : nodes_(X.ndim() == 2 ? X.shape(0) : 0), triangles_(corners.ndim() ? corners.shape(0) : 0) {
        require(X.ndim() == 2 && X.shape(1) == 2, "X must have the shape (n, 2)");
        membrane_ = made<restshape::PackedMembrane>(X, corners, moduli, 9);
        membrane_tally_ = restshape::element("membrane_tri3").tally;
        if (bends.empty()) return;
        bending_tally_ = restshape::element(bends).tally;
        bent_ = cells.shape(0);
        if (bends == "hinge_flap4")
            hinges_ = made<restshape::PackedBending<restshape::HingeElement>>(X, cells, stiffness, 1);
        else if (bends == "morley_tri6")
            plates_ = made<restshape::PackedBending<restshape::MorleyElement>>(X, cells, stiffness, 9);
        else
            throw std::invalid_argument("bending must be of hinge_flap4, of morley_tri6 or empty");
    }

    double evaluate(const Doubles& x, Output out) {
        require(x.ndim() == 2 && x.shape(0) == nodes_ && x.shape(1) == 3, "x must have the shape (n, 3)");
        require(out.size() == 3 * nodes_ && out.writeable(), "out must be a writeable array of shape (n, 3)");
        double* to = out.mutable_data();
        std::fill(to, to + out.size(), 0.0);
        count(membrane_tally_, triangles_);
        if (bending_tally_) count(bending_tally_, bent_);
        const double stretched = membrane_.add(x.data(), to);
        return stretched + (hinges_.add(x.data(), to) + plates_.add(x.data(), to));
    }

 private:
    template <class Packed>
    restshape::PackedElements<Packed> made(const Doubles& X, const Cells& cells, const Doubles& p,
                                           py::ssize_t wide) const {
        const py::ssize_t count = cells.ndim() ? cells.shape(0) : 0;
        require(cells.ndim() == 2 && cells.shape(1) == Packed::nodes,
                "cells must have as many nodes as their elements");
        const bool each = p.ndim() == 2 && p.shape(0) == count && p.shape(1) == wide;
        require(each || (p.ndim() == 1 && p.size() == wide), "each cell, or all, must have a row of parameters");
        const auto inside = [&](int32_t node) { return node >= 0 && node < nodes_; };
        require(std::all_of(cells.data(), cells.data() + cells.size(), inside),
                "a cell names a node that does not exist");
        return {X.data(), cells.data(), p.data(), each ? static_cast<int>(wide) : 0, count};
    }
    static void count(restshape::Tally* tally, int64_t elements) {
        tally->add(Purpose::energy, elements);
        tally->add(Purpose::residual, elements);
    }

    py::ssize_t nodes_, triangles_, bent_ = 0;
    restshape::Tally *membrane_tally_ = nullptr, *bending_tally_ = nullptr;
    restshape::PackedElements<restshape::PackedMembrane> membrane_;
    restshape::PackedElements<restshape::PackedBending<restshape::HingeElement>> hinges_;
    restshape::PackedElements<restshape::PackedBending<restshape::MorleyElement>> plates_;
};

}  // namespace

void bind_sheet(py::module_& m) {
    py::class_<Sheet>(
        m, "Sheet",
        "A membrane of St. Venant and Kirchhoff with its load, and what bends quadratically: the elements "
        "membrane_tri3, and hinge_flap4 or morley_tri6. What depends on material and stiffness alone "
        "is kept.")
        .def(py::init<const Doubles&, const Cells&, const Doubles&, const std::string&, const Cells&, const Doubles&>(),
             "X"_a, "corners"_a, "moduli"_a, "bends"_a, "cells"_a, "stiffness"_a,
             "Of material coordinates X (n, 2) [m], triangles (ne, 3) with the membrane's parameters (9,) or (ne, 9), "
             "and cells (m, k) of the element that bends, by its name, with its parameters; without a name nothing "
             "does.")
        .def("evaluate", &Sheet::evaluate, "x"_a, "out"_a.noconvert(),
             "The energy [J] at x (n, 3) [m]; sets `out` (n, 3) [N] to its gradient.");
}
