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
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

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
HEADERS = BUILD / "headers"
"""Folder of the headers that are compiled once: what they include takes a third of the time of most files."""
PRECOMPILED, OF_BINDINGS = "precompiled.hpp", "precompiled_bindings.hpp"
"""What files begin with, and bindings: where pybind11 is included the compiler makes code of it for 5 s."""
ALONE = ("bind_delaunay.cpp",)
"""Bindings with CGAL, which does not bear names that PETSc's macros have."""
TOGETHER = 36_000
"""Bytes up to which files of bindings are compiled as one, which makes code of pybind11 once for all of them."""


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
    """Options for the headers of others, and for what the compiler shall not warn of."""
    # The default folder must not come before those of the compiler itself.
    folders = [eigen_folder(), *([cgal] if cgal not in (None, "/usr/include") else [])]
    # Packs of eight numbers are inlined, so that no call hangs on how a processor without AVX-512 hands them over.
    # GCC's AVX-512 intrinsics begin with values that they do not set; what they say against warnings of it is lost
    # where the header is compiled before.
    return ["-Wno-psabi", "-Wno-maybe-uninitialized", *(word for folder in folders for word in ("-isystem", folder))]


def own_folders() -> list[str]:
    """Where headers are: the compiler takes one that is compiled from the first, or else itself from the second."""
    return [str(HEADERS), str(KERNELS)]


def kernels_extension() -> Pybind11Extension:
    """The library's module, with PETSc's library found at run time where it was found now."""
    includes, library_dirs, library = petsc_paths()
    name, cgal, flags = "restshape._kernels", cgal_folder(), compile_flags()
    return Pybind11Extension(
        name,
        sources_in(KERNELS),
        include_dirs=[*own_folders(), *includes],
        library_dirs=library_dirs,
        runtime_library_dirs=library_dirs,
        libraries=[library],
        define_macros=[("RESTSHAPE_FLAGS", f'"{" ".join(flags)}"'), ("RESTSHAPE_CGAL", "1" if cgal else "0")],
        extra_compile_args=[*flags, *system_headers(cgal), *mpi_flags("compile", "-I|-D|-pthread")],
        extra_link_args=[*mpi_flags("link", "-L|-l|-Wl|-pthread"), *(SANITIZERS if sanitized() else ())],
        cxx_std=17,
    )


def application_extensions() -> list[Pybind11Extension]:
    """A module `_kernels` for each application that has C++ of its own; it may include the library's headers."""
    return [
        Pybind11Extension(
            f"restshape_apps.{folder.parent.name}._kernels",
            sources_in(folder),
            include_dirs=[str(folder), *own_folders()],
            extra_compile_args=[*compile_flags(), *system_headers(None)],
            extra_link_args=list(SANITIZERS) if sanitized() else [],
            cxx_std=17,
        )
        for folder in sorted(APPLICATIONS.glob("*/kernels"))
    ]


def sources_in(folder: Path) -> list[str]:
    """All C++ files of a folder and of those in it."""
    return sorted(str(path) for path in folder.rglob("*.cpp"))


def headers() -> Pybind11Extension:
    """What the headers of all modules are compiled with, as a module without files."""
    options = [*compile_flags(), *system_headers(None)]
    return Pybind11Extension("headers", [], include_dirs=[str(KERNELS)], extra_compile_args=options, cxx_std=17)


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
    write_new(note, text)
    return note


def write_new(path: Path, text: str) -> None:
    """Writes a text unless it is there already: what is newer than an object makes that object stale."""
    if not path.exists() or path.read_text() != text:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


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


def compiled_header(name: str) -> Path:
    """Where a header is compiled to."""
    return HEADERS / f"{name}.gch"


def old_header(name: str) -> bool:
    """Whether a header has to be compiled."""
    return stale(compiled_header(name), note_options(headers()))


def binds(source: str) -> bool:
    """Whether a file makes functions known to Python."""
    return "#include <pybind11/" in Path(source).read_text()


class Unit(NamedTuple):
    """What the compiler is started for once.

    Args:
        source: a file, or one that includes several.
        files: their names.
        header: what it begins with.
        size: bytes of the files.
    """

    source: Path
    files: list[str]
    header: str
    size: int

    @property
    def built(self) -> Path:
        """The object file."""
        return (BUILD / self.source).with_suffix(".o")

    @property
    def begun(self) -> Path:
        """The compiled header."""
        return compiled_header(self.header)


def units(extension: Pybind11Extension) -> list[Unit]:
    """The files of a module as they are compiled, the longest first: of bindings, neighbours that are short as one."""
    groups: list[list[str]] = []
    for source in filter(binds, extension.sources):
        if (
            groups
            and source.endswith(ALONE) == groups[-1][0].endswith(ALONE)
            and sum(map(os.path.getsize, [*groups[-1], source])) <= TOGETHER
        ):
            groups[-1].append(source)
        else:
            groups.append([source])
    bindings = [unit_of(extension, group, OF_BINDINGS) for group in groups]
    others = [unit_of(extension, [source], PRECOMPILED) for source in extension.sources if not binds(source)]
    return bindings + others


def unit_of(extension: Pybind11Extension, sources: list[str], header: str) -> Unit:
    """Some files as one; the file that includes several is written where it has changed."""
    names = [source.partition("kernels" + os.sep)[2] for source in sources]
    source = Path(sources[0])
    if len(sources) > 1:
        text = "".join(f'#include "{name}"\n' for name in names)
        source = BUILD / extension.name / f"from_{source.name}"
        write_new(source, text)
    return Unit(source, names, header, sum(map(os.path.getsize, sources)))


def in_order(jobs: list[tuple[Pybind11Extension, Unit]]) -> list[tuple[Pybind11Extension, Unit]]:
    """Jobs, the longest first; one without bindings before all, while the header of the bindings is compiled."""
    longest = sorted(jobs, key=lambda job: (job[1].header == OF_BINDINGS, job[1].size), reverse=True)
    first = [job for job in longest if job[1].header == PRECOMPILED][:1]
    return [*first, *(job for job in longest if job not in first)]


class BuildKernels(build_ext):
    """Builds with objects kept between runs, those of editable installs too."""

    def finalize_options(self) -> None:
        """Sets the folder of object files; setuptools would take a temporary one for an editable install."""
        super().finalize_options()
        self.build_temp = str(BUILD)

    def build_extensions(self) -> None:
        """Compiles what is stale of all modules, a few files at once, and links."""
        # Without it a compiler cache keeps nothing that was compiled with a header made before.
        os.environ.setdefault("CCACHE_SLOPPINESS", "pch_defines,time_macros")
        with ThreadPoolExecutor(int(os.environ.get("RESTSHAPE_BUILD_JOBS", "2"))) as pool:
            made = {name: pool.submit(self.precompile, name) for name in (OF_BINDINGS, PRECOMPILED) if old_header(name)}
            todo = []
            for extension in self.extensions:
                note, parts = note_options(extension), units(extension)
                todo += [
                    (extension, unit) for unit in parts if unit.header in made or stale(unit.built, note, unit.begun)
                ]
                extension.sources, extension.depends = [], [str(unit.built) for unit in parts]
                extension.extra_objects = extension.depends
            places = [f"[{number}/{len(todo)}]" for number in range(1, len(todo) + 1)]
            list(
                pool.map(lambda job, place: self.compile(*job, place, made.get(job[1].header)), in_order(todo), places)
            )
        super().build_extensions()

    def precompile(self, name: str) -> None:
        """Compiles a header; the files of all modules can begin with it."""
        sys.stdout.write(f"{name}\n")
        sys.stdout.flush()
        module, built = headers(), compiled_header(name)
        options = module.extra_compile_args
        places = gen_preprocess_options([], [*module.include_dirs, *self.compiler.include_dirs])
        made = ["-x", "c++-header", str(KERNELS / name), "-o", str(built), "-MMD", "-MF", str(built.with_suffix(".d"))]
        # Newer setuptools have a compiler of its own for C++, with which the files are compiled, too.
        compiler = getattr(self.compiler, "compiler_so_cxx", None) or self.compiler.compiler_so
        self.spawn([*compiler, *places, *made, *options])

    def compile(self, extension: Pybind11Extension, unit: Unit, place: str, header: Future | None) -> None:
        """Compiles one unit when its header is there, and has the compiler note what it reads."""
        if header:
            header.result()
        # Several files are compiled at once: a line is written whole, its end included.
        sys.stdout.write(f"{place} {', '.join(unit.files)}\n")
        sys.stdout.flush()
        self.compiler.compile(
            [str(unit.source)],
            output_dir=self.build_temp,
            macros=extension.define_macros,
            include_dirs=extension.include_dirs,
            extra_postargs=[*extension.extra_compile_args, "-include", unit.header, "-MMD"],
        )


setup(ext_modules=[kernels_extension(), *application_extensions()], cmdclass={"build_ext": BuildKernels})
