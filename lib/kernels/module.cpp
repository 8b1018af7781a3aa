// The extension module restshape._kernels: every binding file adds its part.
#include <pybind11/pybind11.h>

namespace py = pybind11;

void bind_averages(py::module_&);
void bind_algebra(py::module_&);
void bind_boundary(py::module_&);
void bind_build(py::module_&);
void bind_calls(py::module_&);
void bind_contact(py::module_&);
void bind_curves(py::module_&);
void bind_elements(py::module_&);
void bind_estimate(py::module_&);
void bind_extrude(py::module_&);
void bind_operator(py::module_&);
void bind_increments(py::module_&);
void bind_least_squares(py::module_&);
void bind_mesh(py::module_&);
void bind_motion(py::module_&);
void bind_mesher(py::module_&);
void bind_messages(py::module_&);
void bind_near_pairs(py::module_&);
void bind_places(py::module_&);
void bind_sheet(py::module_&);
void bind_nested_cloth(py::module_&);
void bind_order(py::module_&);
void bind_outline(py::module_&);
void bind_correction(py::module_&);
void bind_panels(py::module_&);
void bind_rows(py::module_&);
void bind_steps(py::module_&);
void bind_rates(py::module_&);
void bind_space(py::module_&);
void bind_surface(py::module_&);
void bind_fields(py::module_&);
void bind_force_space(py::module_&);
void bind_thickness(py::module_&);
void bind_second_order(py::module_&);
void bind_watch(py::module_&);

PYBIND11_MODULE(_kernels, m) {
    m.doc() = "Compiled kernels of restshape: elements, assembly, mesh operations.";
    bind_averages(m);
    bind_algebra(m);
    bind_boundary(m);
    bind_build(m);
    bind_calls(m);
    bind_surface(m);
    bind_contact(m);
    bind_curves(m);
    bind_elements(m);
    bind_estimate(m);
    bind_extrude(m);
    bind_operator(m);
    bind_increments(m);
    bind_least_squares(m);
    bind_mesh(m);
    bind_motion(m);
    bind_mesher(m);
    bind_messages(m);
    bind_near_pairs(m);
    bind_places(m);
    bind_sheet(m);
    bind_nested_cloth(m);
    bind_order(m);
    bind_outline(m);
    bind_correction(m);
    bind_panels(m);
    bind_rows(m);
    bind_steps(m);
    bind_rates(m);
    bind_space(m);
    bind_fields(m);
    bind_force_space(m);
    bind_thickness(m);
    bind_second_order(m);
    bind_watch(m);
}
