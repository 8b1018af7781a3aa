"""Builds the extension module `restshape._kernels` against PETSc's C library and Eigen.

Environment:
  PETSC_DIR, PETSC_ARCH   use that PETSc instead of the one petsc4py was built with
  EIGEN3_INCLUDE_DIR      folder that holds Eigen/ (default: /usr/include/eigen3)
  CGAL_INCLUDE_DIR        folder that holds CGAL/ (default: /usr/include)
  RESTSHAPE_CGAL=0        build without CGAL's mesher: gmsh makes all meshes
  MPICXX                  MPI's C++ compiler wrapper (default: mpicxx)
  RESTSHAPE_PORTABLE=1    no -march=native: the binary runs on any CPU of the architecture
  RESTSHAPE_BUILD_JOBS    files compiled at once (default: 2)
"""

import os
import re
import subprocess
import sys
import sysconfig
from pathlib import Path

from setuptools import setup

try:
    from pybind11.setup_helpers import ParallelCompile, Pybind11Extension, build_ext
except ImportError:
    raise SystemExit("pybind11 is missing: pip install 'pybind11>=2.11,<4'") from None

KERNELS = Path("lib/kernels")
BUILD = Path("build/kernels") / sysconfig.get_config_var("SOABI")
OPTIONS = BUILD / "options.txt"


def petsc_root() -> tuple[str, str]:
    """PETSC_DIR and PETSC_ARCH: the environment's, or those that petsc4py was built with."""
    try:
        import petsc4py
    except ImportError:
        raise SystemExit(f"{sys.executable} cannot import petsc4py: see docs/install.md") from None
    root, arch = os.environ.get("PETSC_DIR"), os.environ.get("PETSC_ARCH", "")
    if not root:
        config = petsc4py.get_config()
        root, arch = config["PETSC_DIR"], config.get("PETSC_ARCH") or ""
    if not os.path.isdir(root):
        raise SystemExit(f"PETSC_DIR is {root}, and there is no such folder: set it to your PETSc")
    check_petsc(Path(root), arch, petsc4py.__version__)
    return root, arch


def header_text(root: Path, arch: str, name: str) -> str:
    """The text of a header of PETSc, empty if it is not there."""
    places = [root / arch / "include" / name, root / "include" / name]
    return next((place.read_text() for place in places if place.is_file()), "")


def check_petsc(root: Path, arch: str, binding: str) -> None:
    """Stops with a message unless PETSc has headers, real scalars, and the version of its Python binding."""
    found = dict(
        re.findall(r"#define\s+PETSC_VERSION_(MAJOR|MINOR)\s+(\d+)", header_text(root, arch, "petscversion.h"))
    )
    if len(found) < 2:
        raise SystemExit(
            f"no PETSc headers below {root}: install its development files, or set PETSC_DIR and PETSC_ARCH"
        )
    version = f"{found['MAJOR']}.{found['MINOR']}"
    if tuple(map(int, version.split("."))) < (3, 18):
        raise SystemExit(f"PETSc {version} in {root} is too old: restshape needs 3.18 or newer")
    if binding.split(".")[:2] != version.split("."):
        raise SystemExit(f"petsc4py {binding} is not that of PETSc {version} in {root}: set PETSC_DIR or PYTHONPATH")
    if "PETSC_USE_COMPLEX 1" in header_text(root, arch, "petscconf.h"):
        raise SystemExit(f"PETSc in {root} has complex scalars: restshape needs real ones")


def petsc_paths() -> tuple[list[str], list[str], str]:
    """Include folders, library folders and library name of the PETSc in use."""
    root, arch = petsc_root()
    places = [Path(root), Path(root) / arch]
    includes = [str(p / "include") for p in places if (p / "include").is_dir()]
    libraries = [p / "lib" for p in reversed(places) if (p / "lib").is_dir()]
    for folder in libraries:
        for name in ("petsc", "petsc_real"):
            if list(folder.glob(f"lib{name}.so*")) or list(folder.glob(f"lib{name}.dylib")):
                return list(dict.fromkeys(includes)), [str(folder)], name
    raise SystemExit(f"no shared PETSc library below {root}: set PETSC_DIR and PETSC_ARCH")


def mpi_flags(what: str, keep: str) -> list[str]:
    """Flags that the MPI compiler wrapper adds for compiling or linking, those that match `keep`."""
    compiler = os.environ.get("MPICXX", "mpicxx")
    for option in (f"--showme:{what}", f"-{what}_info"):
        try:
            done = subprocess.run([compiler, option], capture_output=True, text=True, check=True)
        except FileNotFoundError:
            raise SystemExit(f"{compiler} not found: install an MPI with compiler wrappers, or set MPICXX") from None
        except subprocess.CalledProcessError:
            continue
        return [word for word in done.stdout.split() if re.match(keep, word)]
    raise SystemExit(f"{compiler} tells no flags: set MPICXX to a working wrapper")


def eigen_folder() -> str:
    """The folder that holds Eigen's headers."""
    folder = os.environ.get("EIGEN3_INCLUDE_DIR", "/usr/include/eigen3")
    if not os.path.isfile(os.path.join(folder, "Eigen", "Core")):
        raise SystemExit(f"no Eigen in {folder}: install Eigen 3.4, or set EIGEN3_INCLUDE_DIR to its folder")
    return folder


def cgal_folder() -> str | None:
    """The folder that holds CGAL's headers; None without them, or where they are not wanted."""
    if os.environ.get("RESTSHAPE_CGAL", "1") in ("", "0"):
        return None
    folder = os.environ.get("CGAL_INCLUDE_DIR", "/usr/include")
    if os.path.isfile(os.path.join(folder, "CGAL", "Delaunay_mesher_2.h")):
        return folder
    if "CGAL_INCLUDE_DIR" in os.environ:
        raise SystemExit(f"no CGAL in {folder}: set CGAL_INCLUDE_DIR to the folder that holds CGAL/")
    print("no CGAL in /usr/include, so gmsh makes all meshes: install libcgal-dev for faster ones", file=sys.stderr)
    return None


def kernels_extension() -> Pybind11Extension:
    """The extension module, with PETSc's library found at run time where it was found now."""
    includes, library_dirs, library = petsc_paths()
    cgal = cgal_folder()
    portable = os.environ.get("RESTSHAPE_PORTABLE", "0") not in ("", "0")
    flags = [
        "-O3",
        "-g0",
        "-Wall",
        "-Wno-maybe-uninitialized",
        "-fno-math-errno",
        *([] if portable else ["-march=native"]),
    ]
    return Pybind11Extension(
        "restshape._kernels",
        sorted(str(path) for path in KERNELS.rglob("*.cpp")),
        include_dirs=[str(KERNELS), *includes],
        library_dirs=library_dirs,
        runtime_library_dirs=library_dirs,
        libraries=[library],
        depends=[*sorted(str(path) for path in KERNELS.rglob("*.hpp")), str(OPTIONS)],
        define_macros=[("RESTSHAPE_FLAGS", f'"{" ".join(flags)}"'), ("RESTSHAPE_CGAL", "1" if cgal else "0")],
        extra_compile_args=[
            *flags,
            "-isystem",
            eigen_folder(),
            # The default folder must not come before those of the compiler itself.
            *(["-isystem", cgal] if cgal not in (None, "/usr/include") else []),
            *mpi_flags("compile", "-I|-D|-pthread"),
        ],
        extra_link_args=mpi_flags("link", "-L|-l|-Wl|-pthread"),
        cxx_std=17,
    )


def note_options(extension: Pybind11Extension) -> None:
    """Writes down what the objects are compiled with; a newer note than an object makes that object stale."""
    # With -march=native the CPU is one of the options: the compiler tells what it takes it for.
    question = [os.environ.get("CXX", "g++"), "--version", "-Q", "--help=target", *extension.extra_compile_args]
    try:
        compiler = subprocess.run(question, capture_output=True, text=True).stdout
    except FileNotFoundError:
        raise SystemExit(f"no C++ compiler: install {question[0]}, or name yours with CC and CXX") from None
    keys = ("include_dirs", "library_dirs", "libraries", "define_macros", "extra_compile_args", "extra_link_args")
    text = "\n".join([*(f"{key} {getattr(extension, key)}" for key in keys), sys.executable, compiler])
    if not OPTIONS.exists() or OPTIONS.read_text() != text:
        OPTIONS.parent.mkdir(parents=True, exist_ok=True)
        OPTIONS.write_text(text)


def stale(built: str, source: str) -> bool:
    """Tell whether an object file is older than its source, any header, or the compiler's options."""
    inputs = [source, str(OPTIONS), *(str(path) for path in KERNELS.rglob("*.hpp"))]
    return not os.path.exists(built) or os.path.getmtime(built) < max(map(os.path.getmtime, inputs))


class BuildKernels(build_ext):
    """Builds with objects kept between runs, those of editable installs too."""

    def finalize_options(self) -> None:
        """Sets the folder of object files; setuptools would take a temporary one for an editable install."""
        super().finalize_options()
        self.build_temp = str(BUILD)

    def build_extensions(self) -> None:
        """Compiles what is stale, two files at once, and links."""
        note_options(self.extensions[0])
        with ParallelCompile("RESTSHAPE_BUILD_JOBS", default=2, needs_recompile=stale):
            super().build_extensions()


setup(ext_modules=[kernels_extension()], cmdclass={"build_ext": BuildKernels})
