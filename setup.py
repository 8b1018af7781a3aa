"""Builds the extension module `restshape._kernels` against PETSc's C library and Eigen.

Environment:
  PETSC_DIR, PETSC_ARCH   use that PETSc instead of the one petsc4py was built with
  EIGEN3_INCLUDE_DIR      folder that holds Eigen/ (default: /usr/include/eigen3)
  RESTSHAPE_PORTABLE=1    no -march=native: the binary runs on any CPU of the architecture
"""

import os
import subprocess
from pathlib import Path

from pybind11.setup_helpers import ParallelCompile, Pybind11Extension, build_ext
from setuptools import setup

KERNELS = Path("lib/kernels")


def petsc_paths() -> tuple[list[str], list[str], str]:
    """Include folders, library folders and library name of the PETSc in use."""
    root, arch = os.environ.get("PETSC_DIR"), os.environ.get("PETSC_ARCH", "")
    if not root:
        import petsc4py

        config = petsc4py.get_config()
        root, arch = config["PETSC_DIR"], config.get("PETSC_ARCH") or ""
    places = [Path(root), Path(root) / arch]
    includes = [str(p / "include") for p in places if (p / "include").is_dir()]
    libraries = [p / "lib" for p in reversed(places) if (p / "lib").is_dir()]
    for folder in libraries:
        for name in ("petsc", "petsc_real"):
            if list(folder.glob(f"lib{name}.so*")) or list(folder.glob(f"lib{name}.dylib")):
                return includes, [str(folder)], name
    raise SystemExit(f"no PETSc library below {root}: set PETSC_DIR and PETSC_ARCH")


def mpi_flags(what: str) -> list[str]:
    """Flags that the MPI compiler wrapper adds for compiling or linking."""
    compiler = os.environ.get("MPICXX", "mpicxx")
    for option in (f"--showme:{what}", f"-{what}_info"):
        try:
            done = subprocess.run([compiler, option], capture_output=True, text=True, check=True)
        except FileNotFoundError:
            raise SystemExit(f"{compiler} not found: install an MPI with its compiler wrappers") from None
        except subprocess.CalledProcessError:
            continue
        return [word for word in done.stdout.split() if word.startswith("-")]
    raise SystemExit(f"{compiler} tells no flags: set MPICXX to a working wrapper")


includes, library_dirs, library = petsc_paths()
portable = os.environ.get("RESTSHAPE_PORTABLE", "0") not in ("", "0")
extension = Pybind11Extension(
    "restshape._kernels",
    sorted(str(path) for path in KERNELS.rglob("*.cpp")),
    include_dirs=[str(KERNELS), *includes, os.environ.get("EIGEN3_INCLUDE_DIR", "/usr/include/eigen3")],
    library_dirs=library_dirs,
    runtime_library_dirs=library_dirs,
    libraries=[library],
    depends=sorted(str(path) for path in KERNELS.rglob("*.hpp")),
    extra_compile_args=["-O3", "-Wall", "-fno-math-errno", *([] if portable else ["-march=native"]), *mpi_flags("compile")],
    extra_link_args=mpi_flags("link"),
    cxx_std=17,
)


def stale(source: str, built: str) -> str:
    """Tell whether an object file is older than its source or any header."""
    headers = [str(path) for path in KERNELS.rglob("*.hpp")]
    newest = max(os.path.getmtime(path) for path in [source, *headers])
    return "" if os.path.exists(built) and os.path.getmtime(built) >= newest else source


ParallelCompile("RESTSHAPE_BUILD_JOBS", default=2, needs_recompile=lambda obj, src: bool(stale(src, obj))).install()
setup(ext_modules=[extension], cmdclass={"build_ext": build_ext})
