// Binding of what gives memory back to the system.
#include <pybind11/pybind11.h>

#include <cstdlib>
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace py = pybind11;

void bind_memory(py::module_& m) {
    m.def(
        "give_back_memory",
        [] {
#ifdef __GLIBC__
            // SuperLU_DIST, which PETSc brings, has glibc keep all that is freed (mallopt), wherever it lies.
            malloc_trim(0);
            return true;
#else
            return false;
#endif
        },
        "Gives memory that was freed back to the system; returns whether the system's library does so on demand.");
}
