"""Kernels hand PETSc arrays of its own integers: they compile where these have 64 bits."""

import os
import subprocess
import sysconfig
from pathlib import Path

import pybind11
import pytest

KERNELS = Path(__file__).parents[2] / "lib" / "kernels"
PLACES = [Path(os.environ["PETSC_DIR"])] if "PETSC_DIR" in os.environ else []
FOUND = [*PLACES, *Path("/usr/lib/petscdir").glob("*/*")]


def headers(long: bool) -> Path:
    """Folder with the headers of a PETSc whose indices have 64 bits, or 32; real numbers in both."""
    for root in FOUND:
        text = (root / "include" / "petscconf.h").read_text() if (root / "include" / "petscconf.h").is_file() else ""
        if text and "PETSC_USE_COMPLEX 1" not in text and ("PETSC_USE_64BIT_INDICES 1" in text) == long:
            return root / "include"
    pytest.skip(f"no PETSc with real numbers and indices of {64 if long else 32} bits in {', '.join(map(str, FOUND))}")


@pytest.mark.weekly
@pytest.mark.parametrize("own", [True, False], ids=["PETSc of 64 bits", "headers of 32 bits with 64 set"])
def test_kernels_that_make_matrices_compile_with_long_indices(own):
    include = headers(own)
    words = ["mpicxx", "-fsyntax-only", "-std=c++17", f"-I{KERNELS}", "-I/usr/include/eigen3", f"-I{include}"]
    bindings = [f"-I{pybind11.get_include()}", f"-I{sysconfig.get_path('include')}"]
    sources = [path for path in sorted(KERNELS.rglob("*.cpp")) if "PetscInt " in path.read_text()]
    assert len(sources) > 5
    for source in sources:
        defined = [] if own else ["-DPETSC_USE_64BIT_INDICES=1"]
        done = subprocess.run([*words, *defined, *bindings, source], capture_output=True, text=True, timeout=120)
        assert done.returncode == 0, done.stderr
