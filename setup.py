"""Builds `restshape._kernels` against PETSc's C library and Eigen, and the extension modules of applications.

Only what depends on a changed file is compiled: the compiler notes beside each object what it has read.

Environment:
  PETSC_DIR, PETSC_ARCH   use that PETSc instead of the one petsc4py was built with
  EIGEN3_INCLUDE_DIR      folder that holds Eigen/ (default: /usr/include/eigen3)
  CGAL_INCLUDE_DIR        folder that holds CGAL/ (default: /usr/include)
  RESTSHAPE_CGAL=0        build without CGAL's mesher: gmsh makes all meshes
  MPICXX                  MPI's C++ compiler wrapper (default: mpicxx)
  RESTSHAPE_PORTABLE=1    no -march=native: the binary runs on any CPU of the architecture
  RESTSHAPE_SANITIZE=1    with address and undefined-behaviour sanitizers: see scripts/sanitize.sh
  RESTSHAPE_BUILD_JOBS    files compiled at once (default: 2)
"""

import os
import re
import subprocess
import sys
import sysconfig
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from setuptools import setup
from setuptools._distutils.ccompiler import gen_preprocess_options
from setuptools.command.build_ext import build_ext

try:
    from pybind11.setup_helpers import Pybind11Extension
except ImportError:
    raise SystemExit("pybind11 is missing: pip install 'pybind11>=2.11,<4'") from None

KERNELS = Path("lib/kernels")
APPLICATIONS = Path("apps")
SANITIZERS = ("-fsanitize=address,undefined", "-fno-sanitize=vptr")
CHECKED = (*SANITIZERS, "-Dflatten=unused", "--param", "asan-instrumentation-with-call-threshold=0")
"""With checks in every line, functions that take in all that they call compile for minutes: here they do not."""
BUILD = Path("build/kernels") / sysconfig.get_config_var("SOABI")
PRECOMPILED = "precompiled.hpp"
"""Header of the bindings of the library's module, compiled once: what it includes takes half of the time of most."""
INTRINSICS = str(KERNELS / "intrinsics.hpp")
"""What other files begin with: in each file that includes pybind11 the compiler makes code of it for 5 s."""


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
    raise SystemExit(f"{compiler} reports no flags: set MPICXX to a working wrapper")


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


def compile_flags() -> list[str]:
    """Options of the compiler that decide what the code does and how fast."""
    portable = os.environ.get("RESTSHAPE_PORTABLE", "0") not in ("", "0")
    if sanitized():
        return ["-O1", "-g1", "-Wall", "-fno-math-errno", "-fno-omit-frame-pointer", *CHECKED]
    return ["-O3", "-g0", "-Wall", "-fno-math-errno", *([] if portable else ["-march=native"])]


def sanitized() -> bool:
    """Whether the modules look for reads beyond arrays and undefined behaviour while they run."""
    return os.environ.get("RESTSHAPE_SANITIZE", "0") not in ("", "0")


def system_headers(cgal: str | None) -> list[str]:
    """Options for the headers of others, which the compiler shall not warn of."""
    # The default folder must not come before those of the compiler itself.
    folders = [eigen_folder(), *([cgal] if cgal not in (None, "/usr/include") else [])]
    options = [word for folder in folders for word in ("-isystem", folder)]
    return options


def kernels_extension() -> Pybind11Extension:
    """The library's module, with PETSc's library found at run time where it was found now."""
    includes, library_dirs, library = petsc_paths()
    name, cgal, flags = "restshape._kernels", cgal_folder(), compile_flags()
    options = [*system_headers(cgal), "-include", PRECOMPILED]
    return Pybind11Extension(
        name,
        sources_in(KERNELS),
        # The compiler takes the compiled header from the first folder, or else the header itself from the second.
        include_dirs=[str(BUILD / name), str(KERNELS), *includes],
        library_dirs=library_dirs,
        runtime_library_dirs=library_dirs,
        libraries=[library],
        define_macros=[("RESTSHAPE_FLAGS", f'"{" ".join(flags)}"'), ("RESTSHAPE_CGAL", "1" if cgal else "0")],
        extra_compile_args=[*flags, *options, *mpi_flags("compile", "-I|-D|-pthread")],
        extra_link_args=[*mpi_flags("link", "-L|-l|-Wl|-pthread"), *(SANITIZERS if sanitized() else ())],
        cxx_std=17,
    )


def application_extensions() -> list[Pybind11Extension]:
    """A module `_kernels` for each application that has C++ of its own; it may include the library's headers."""
    return [
        Pybind11Extension(
            f"restshape_apps.{folder.parent.name}._kernels",
            sources_in(folder),
            include_dirs=[str(folder), str(KERNELS)],
            extra_compile_args=[*compile_flags(), *system_headers(None), "-include", INTRINSICS],
            extra_link_args=list(SANITIZERS) if sanitized() else [],
            cxx_std=17,
        )
        for folder in sorted(APPLICATIONS.glob("*/kernels"))
    ]


def sources_in(folder: Path) -> list[str]:
    """All C++ files of a folder and of those in it."""
    return sorted(str(path) for path in folder.rglob("*.cpp"))


def note_options(extension: Pybind11Extension) -> Path:
    """Writes down what a module's objects are compiled with; a newer note than an object makes that object stale."""
    # With -march=native the CPU is one of the options: the compiler shows what it takes it for.
    question = [os.environ.get("CXX", "g++"), "--version", "-Q", "--help=target", *extension.extra_compile_args]
    try:
        compiler = subprocess.run(question, capture_output=True, text=True).stdout
    except FileNotFoundError:
        raise SystemExit(f"no C++ compiler: install {question[0]}, or name yours with CC and CXX") from None
    keys = ("include_dirs", "library_dirs", "libraries", "define_macros", "extra_compile_args", "extra_link_args")
    text = "\n".join([*(f"{key} {getattr(extension, key)}" for key in keys), sys.executable, compiler])
    note = BUILD / extension.name / "options.txt"
    if not note.exists() or note.read_text() != text:
        note.parent.mkdir(parents=True, exist_ok=True)
        note.write_text(text)
    return note


def dependencies(built: Path) -> list[Path]:
    """The source and the headers that an object was compiled from, as the compiler noted them beside it."""
    text = built.with_suffix(".d").read_text().replace("\\\n", " ")
    names = [name.replace("\\ ", " ") for name in re.split(r"(?<!\\)\s+", text.partition(":")[2])]
    return [Path(name) for name in names if name and not name.endswith(".gch")]


def stale(built: Path, *others: Path) -> bool:
    """Whether a compiled file is older than anything it was compiled from, or than others that it depends on."""
    try:
        return built.stat().st_mtime < max(path.stat().st_mtime for path in [*others, *dependencies(built)])
    except FileNotFoundError:
        return True


def binds(source: str) -> bool:
    """Whether a file makes functions known to Python."""
    return "#include <pybind11/" in Path(source).read_text()


def beginning(source: str, words: list[str]) -> list[str]:
    """The options of a module for one of its files: without the header of the bindings unless it is one of them."""
    return words if binds(source) else [INTRINSICS if word == PRECOMPILED else word for word in words]


def duration(source: str) -> tuple[bool, int]:
    """Orders sources by how long they compile: bindings take longest, and more of them longer."""
    return binds(source), os.path.getsize(source)


class BuildKernels(build_ext):
    """Builds with objects kept between runs, those of editable installs too."""

    def finalize_options(self) -> None:
        """Sets the folder of object files; setuptools would take a temporary one for an editable install."""
        super().finalize_options()
        self.build_temp = str(BUILD)

    def build_extensions(self) -> None:
        """Compiles what is stale of all modules, a few files at once and the longest first, and links."""
        # Without it a compiler cache keeps nothing that was compiled with a header made before.
        os.environ.setdefault("CCACHE_SLOPPINESS", "pch_defines,time_macros")
        todo = []
        for extension in self.extensions:
            note = note_options(extension)
            header = self.precompile(extension, note)
            objects = {source: (BUILD / source).with_suffix(".o") for source in extension.sources}
            others = {source: [note, *(header if binds(source) else ())] for source in objects}
            todo += [(extension, source) for source, built in objects.items() if stale(built, *others[source])]
            extension.sources, extension.depends = [], [str(built) for built in objects.values()]
            extension.extra_objects = extension.depends
        todo.sort(key=lambda job: duration(job[1]), reverse=True)
        numbered = enumerate(todo, 1)
        with ThreadPoolExecutor(int(os.environ.get("RESTSHAPE_BUILD_JOBS", "2"))) as pool:
            list(pool.map(lambda item: self.compile(*item[1], f"[{item[0]}/{len(todo)}]"), numbered))
        super().build_extensions()

    def precompile(self, extension: Pybind11Extension, options: Path) -> list[Path]:
        """Compiles the header of a module that has one, if it is stale; what its bindings depend on."""
        words = extension.extra_compile_args
        if PRECOMPILED not in words:
            return []
        built, own = BUILD / extension.name / f"{PRECOMPILED}.gch", words.index(PRECOMPILED)
        if stale(built, options):
            sys.stdout.write(f"{PRECOMPILED}\n")
            sys.stdout.flush()
            folders = [*extension.include_dirs, *self.compiler.include_dirs]
            places = gen_preprocess_options(extension.define_macros, folders)
            made = ["-x", "c++-header", str(KERNELS / PRECOMPILED), "-o", str(built), "-MMD", "-MF"]
            made += [str(built.with_suffix(".d")), *words[: own - 1], *words[own + 1 :]]
            # Newer setuptools have a compiler of its own for C++, with which the files are compiled, too.
            compiler = getattr(self.compiler, "compiler_so_cxx", None) or self.compiler.compiler_so
            self.spawn([*compiler, *places, *made])
        return [built]

    def compile(self, extension: Pybind11Extension, source: str, place: str) -> None:
        """Compiles one file, and has the compiler note what it reads."""
        # Several files are compiled at once: a line is written whole, its end included.
        sys.stdout.write(f"{place} {source.partition('kernels' + os.sep)[2]}\n")
        sys.stdout.flush()
        self.compiler.compile(
            [source],
            output_dir=self.build_temp,
            macros=extension.define_macros,
            include_dirs=extension.include_dirs,
            extra_postargs=[*beginning(source, extension.extra_compile_args), "-MMD"],
        )


setup(ext_modules=[kernels_extension(), *application_extensions()], cmdclass={"build_ext": BuildKernels})
