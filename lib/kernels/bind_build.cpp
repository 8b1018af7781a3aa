// What the extension was compiled with, for `restshape info`.
#include <mpi.h>
#include <petscsys.h>
#include <pybind11/pybind11.h>

#include <Eigen/Core>
#include <cstring>
#include <string>

namespace py = pybind11;

namespace {

std::string version(int major, int minor, int patch) {
    return std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(patch);
}

std::string mpi_library() {
    char text[MPI_MAX_LIBRARY_VERSION_STRING];
    int length = 0;
    MPI_Get_library_version(text, &length);
    // Some libraries count the closing zero.
    return std::string(text, strnlen(text, length));
}

py::dict build() {
    py::dict facts;
    facts["compiler"] = std::string("C++ ") + __VERSION__;
    facts["flags"] = RESTSHAPE_FLAGS;
    facts["portable"] = std::string(RESTSHAPE_FLAGS).find("-march=native") == std::string::npos;
    facts["petsc"] = version(PETSC_VERSION_MAJOR, PETSC_VERSION_MINOR, PETSC_VERSION_SUBMINOR);
    facts["eigen"] = version(EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION);
    facts["simd_bytes"] = EIGEN_MAX_ALIGN_BYTES;
    facts["index_bytes"] = static_cast<int>(sizeof(PetscInt));
    facts["scalar_bytes"] = static_cast<int>(sizeof(PetscScalar));
    facts["mpi"] = mpi_library();
    return facts;
}

}  // namespace

void bind_build(py::module_& m) {
    m.def("build", &build, "Compiler, flags and versions of the libraries that this module was compiled with.");
}
