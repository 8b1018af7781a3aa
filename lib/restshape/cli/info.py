"""`restshape info`: versions, how things were built, and the machine."""

import argparse
import os
import platform
import re
import sys
from importlib import import_module, metadata
from pathlib import Path
from typing import Any

from restshape import __version__
from restshape.calibration import Calibration, own_path
from restshape.cli.options import add_json, print_table, write_json
from restshape.errors import UserError
from restshape.outputs.kinds import JsonFile
from restshape.outputs.si_numbers import counted
from restshape.surroundings import cpu_model, start_petsc

SUMMARY = "show versions, how things were built, and the machine"
PACKAGES = ("numpy", "scipy", "gmsh", "meshio", "ezdxf", "svgelements", "pydantic", "matplotlib", "vtk")
USED = {"vtk": "vtkmodules.vtkRenderingOpenGL2"}
"""What is imported of a package whose other modules are not needed, and take a second."""
BLAS_NAMES = re.compile(r"/[^/]*(openblas|mkl_rt|mkl_core|blis|atlas|flexiblas|libblas|cblas)[^/]*$")


def arguments(parser: argparse.ArgumentParser) -> None:
    """Adds what this command takes."""
    parser.add_argument("--calibrate", action="store_true", help="measure what a unit of work costs on this machine")
    parser.add_argument(
        "--out",
        metavar="FILE",
        type=JsonFile,
        help=f"with --calibrate: where the calibration goes (default: {own_path()})",
    )
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    """Prints what is installed; with ``--calibrate`` measures and writes the machine's calibration."""
    if args.out and not args.calibrate:
        raise UserError("--out goes with --calibrate", "--out", "add --calibrate")
    rank, facts = software(args.petsc)
    if rank > 0:
        return 0
    facts["machine"] = machine()
    for title, rows in facts.items():
        print_table(title, ("", ""), rows.items())
        print()
    facts["calibration"] = calibrations(args)
    write_json(args, facts)
    return 0


def software(options: list[str]) -> tuple[int, dict[str, dict[str, Any]]]:
    """This process's rank, and the versions of programs, of solvers and of the extension.

    Args:
        options: words for PETSc's options database.
    """
    programs: dict[str, Any] = {"restshape": __version__, "Python": f"{platform.python_version()} ({sys.executable})"}
    programs |= {name: package_version(name) for name in PACKAGES}
    programs["h5py"], programs["HDF5"] = package_version("h5py"), hdf5_version()
    try:
        import petsc4py
        import slepc4py

        start_petsc(options)
        from petsc4py import PETSc
        from slepc4py import SLEPc

        from restshape import _kernels
    except ImportError as error:
        raise UserError(f"cannot be imported: {error}", "restshape info", "make setup, or docs/install.md") from error
    build = _kernels.build()
    solvers = {
        "PETSc": dotted(PETSc.Sys.getVersion()),
        "PETSc's folder": petsc_folder(petsc4py.get_config()),
        "petsc4py": petsc4py.__version__,
        "SLEPc": dotted(SLEPc.Sys.getVersion()),
        "slepc4py": slepc4py.__version__,
        "scalar": f"{PETSc.ScalarType.__name__}, {build['scalar_bytes']} bytes",
        "index": f"{PETSc.IntType.__name__}, {build['index_bytes']} bytes",
        "MPI": build["mpi"],
        "ranks": PETSc.COMM_WORLD.size,
        "BLAS": ", ".join(loaded_blas()) or "unknown",
    }
    names = ("compiler", "flags", "portable", "eigen", "simd_bytes")
    extension = {"PETSc when built": build["petsc"], **{name: build[name] for name in names}}
    return PETSc.COMM_WORLD.rank, {"programs": programs, "solvers": solvers, "extension": extension}


def package_version(name: str) -> str:
    """The version of a Python package, or why it cannot be used."""
    try:
        import_module(USED.get(name, name))
        return metadata.version(name)
    except (ImportError, OSError) as error:
        return f"cannot be imported: {error}"


def hdf5_version() -> str:
    """The version of the HDF5 library that h5py uses."""
    try:
        return import_module("h5py").version.hdf5_version
    except ImportError:
        return "unknown"


def dotted(version: tuple[int, ...]) -> str:
    """A version as text."""
    return ".".join(map(str, version[:3]))


def petsc_folder(config: dict[str, str]) -> str:
    """The PETSC_DIR, and PETSC_ARCH if there is one, that petsc4py was built with."""
    return " ".join(word for word in (config.get("PETSC_DIR", ""), config.get("PETSC_ARCH", "")) if word)


def loaded_blas() -> list[str]:
    """Names of the BLAS libraries that this process has loaded (links followed), sorted."""
    try:
        lines = Path("/proc/self/maps").read_text().splitlines()
    except OSError:
        return []
    paths = {line.split(maxsplit=5)[5] for line in lines if len(line.split(maxsplit=5)) == 6}
    return sorted({Path(os.path.realpath(path)).name for path in paths if BLAS_NAMES.search(path)})


def machine() -> dict[str, Any]:
    """What this machine is: system, CPU, cores, memory."""
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    return {
        "system": f"{system_name()} {platform.machine()}",
        "CPU": cpu_model(),
        "cores": f"{len(os.sched_getaffinity(0))} of {os.cpu_count()}",
        "memory": f"{memory / 2**30:.1f} GiB",
        "OMP_NUM_THREADS": os.environ.get("OMP_NUM_THREADS", "not set"),
    }


def system_name() -> str:
    """The name of the operating system."""
    try:
        return platform.freedesktop_os_release()["PRETTY_NAME"]
    except (OSError, KeyError):
        return platform.system()


def calibrations(args: argparse.Namespace) -> dict[str, Any]:
    """The nominal calibration and this machine's, measured now if asked for, else read; prints both."""
    nominal, path = Calibration.load(), args.out or own_path()
    if args.calibrate:
        own, extra = calibrate(path)
    else:
        own, extra = (Calibration.load(path) if path.is_file() else None), {}
    units = nominal.as_dict()["seconds"]
    here = own.as_dict()["seconds"] if own else dict.fromkeys(units)
    rows = [(unit, f"{value:.3g}", "" if own is None else f"{here[unit]:.3g}") for unit, value in units.items()]
    print_table("calibration, seconds a unit", ("unit", "nominal", "this machine"), rows, ("nominal", "this machine"))
    print(f"nominal: {nominal.machine}")
    print(f"this machine: {path}" if own else "this machine: not measured (restshape info --calibrate)")
    for name, value in extra.items():
        print(f"{name}: {value / 1e9:.1f} GB/s")
    return {"nominal": nominal.as_dict(), "own": own.as_dict() if own else None, **extra}


def calibrate(path: Path) -> tuple[Calibration, dict[str, float]]:
    """This machine's calibration, measured and written to `path`, and its memory bandwidth [B/s]."""
    from restshape.measurement import measure, measure_bandwidth

    own = measure(f"{cpu_model()}, {counted(len(os.sched_getaffinity(0)), 'core')}")
    own.save(path)
    return own, {"memory bandwidth": measure_bandwidth()}
