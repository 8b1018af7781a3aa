"""Libraries started so that they obey no file of the current folder, and use one thread a rank."""

import contextlib
import os
import platform
import signal
import sys
from collections.abc import Sequence
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder
from pathlib import Path
from types import ModuleType

from restshape.errors import UserError

ONE_THREAD = "OMP_NUM_THREADS"
"""How many threads BLAS, LAPACK and MUMPS use: one a rank, unless the environment says otherwise.

The matrices of a frame are too small for more, and threads that wait for each other on a busy machine make a frame of
milliseconds last for minutes.
"""
FOLDERS = {"matplotlib": "mpl-data", "ezdxf": ""}
"""Libraries that look for settings where the process stands, and the folder of their own where they find no others."""
PETSC = "petsc4py.PETSc"
POINT_TO_POINT = "OMPI_MCA_pml"
"""How Open MPI passes messages. Before it chooses, a library for network cards measures the processor's clock, for
0.13 s: a lone process, which has nobody to pass messages to, names the plain way (ob1)."""
DISCOVERY = "HWLOC_COMPONENTS"
"""What hwloc looks at, where MPI asks for the machine. Cards and disks, which a lone process does not ask for, take a
third of MPI's start."""
LONE = {POINT_TO_POINT: "ob1", DISCOVERY: "-pci,-linuxio"}
"""What a lone process sets while MPI starts."""
RANKED = {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK"}
"""What mpiexec, or a scheduler of jobs, sets in the environment of ranks, one of these."""

TASKS = "SLURM_STEP_NUM_TASKS"
"""How many tasks srun has started together."""


def lone_task() -> bool:
    """Whether srun has started several tasks, and has made none of them a rank of MPI."""
    return os.environ.get(TASKS, "1") not in ("", "0", "1") and RANKED.isdisjoint(os.environ)


def start_petsc(words: Sequence[str] = ()) -> None:
    """Starts PETSc, which reads neither ``.petscrc`` nor ``petscrc``, here or at home.

    Args:
        words: for its options database; ``-options_file FILE`` among them names a file that it does read.

    Raises:
        UserError: PETSc refuses them, or is built with complex numbers; srun has started tasks that are no ranks.
    """
    import petsc4py

    if lone_task():
        what = f"srun has started {os.environ[TASKS]} tasks that are no ranks of MPI: each would do all of the work"
        do = f"export SLURM_MPI_TYPE=pmix (srun --mpi=list shows others); for runs of their own: unset {TASKS}"
        raise UserError(what, "srun", do)

    # A process that nobody has started with mpiexec would start a daemon of Open MPI, for 0.1 s, to spawn ranks.
    os.environ.setdefault("OMPI_MCA_ess_singleton_isolated", "1")
    lone = {name: way for name, way in LONE.items() if name not in os.environ and RANKED.isdisjoint(os.environ)}
    os.environ.update(lone)
    kept = (signal.SIGHUP, signal.SIGPIPE, signal.SIGQUIT, signal.SIGTERM)
    handlers = {number: signal.getsignal(number) for number in kept}
    try:
        petsc4py.init(["restshape", "-skip_petscrc", *words])
        # PETSc would end in MPI_Abort at them.
        with contextlib.suppress(ValueError):
            for number, handler in handlers.items():
                signal.signal(number, signal.SIG_DFL if handler is None else handler)
    # petsc4py's own class of errors is in the module that could not be started.
    except RuntimeError as error:
        where = f"-- {' '.join(words)}" if words else ""
        raise UserError("PETSc cannot start; its messages are above", where, "mend the words after --") from error
    finally:
        # Ranks that this process starts choose for themselves.
        for name in lone:
            os.environ.pop(name, None)
    if issubclass(getattr(sys.modules.get(PETSC), "ScalarType", float), complex):
        where, do = f"petsc4py of {petsc4py.__path__[0]}", "set PETSC_DIR and PETSC_ARCH to a build with real numbers"
        raise UserError("PETSc is built with complex numbers, and restshape computes with real ones", where, do)


def start_gmsh() -> ModuleType:
    """The gmsh package, started if need be: it reads no settings, nor does the PETSc that it brings along."""
    import gmsh

    if not gmsh.isInitialized():
        # gmsh warns of words that are none of its own, but hands them to its PETSc.
        gmsh.initialize(["restshape", "-v", "0", "-skip_petscrc"], readConfigFiles=False, interruptible=False)
        gmsh.option.setNumber("General.Verbosity", 5)
        # gmsh lets a broken pipe kill the process, and with it the message of what went wrong.
        signal.signal(signal.SIGPIPE, signal.SIG_IGN)
    module: ModuleType = gmsh
    return module


def cpu_model() -> str:
    """The model of the CPU."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        lines = []
    named = (line.split(":", 1)[1].strip() for line in lines if line.startswith("model name"))
    return next(named, None) or platform.processor() or "unknown"


def petsc_options() -> dict[str, str]:
    """All options in PETSc's database: those of words, of files named in them, and of the environment."""
    from petsc4py import PETSc

    return {name: str(value or "") for name, value in sorted(PETSc.Options().getAll().items())}


class _Petsc(Loader):
    """Starts PETSc at its first import, where nobody has started it before."""

    def create_module(self, spec: ModuleSpec) -> ModuleType | None:
        return None

    def exec_module(self, module: ModuleType) -> None:
        start_petsc()


class _Elsewhere(Loader):
    """Imports a library while the process stands in a folder of the library's own.

    Args:
        loader: of the library.
        folder: with the library's own settings, or with none.
    """

    def __init__(self, loader: Loader, folder: Path) -> None:
        self.loader, self.folder = loader, folder

    def create_module(self, spec: ModuleSpec) -> ModuleType | None:
        return self.loader.create_module(spec)

    def exec_module(self, module: ModuleType) -> None:
        with contextlib.chdir(self.folder):
            self.loader.exec_module(module)


class _Finder(MetaPathFinder):
    def find_spec(
        self, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        if name != PETSC and name not in FOLDERS:
            return None
        spec = PathFinder.find_spec(name, path, target)
        if spec is None or spec.loader is None or spec.origin is None:
            return spec
        if name == PETSC:
            spec.loader = _Petsc()
        else:
            spec.loader = _Elsewhere(spec.loader, Path(spec.origin).parent / FOLDERS[name])
        return spec


def use_one_thread() -> None:
    """From now on libraries that are loaded use one thread a rank, unless `OMP_NUM_THREADS` is set."""
    os.environ.setdefault(ONE_THREAD, "1")


def ignore_files() -> None:
    """From now on these libraries obey no file of the current folder; those imported before stay as they are."""
    if not any(isinstance(finder, _Finder) for finder in sys.meta_path):
        sys.meta_path.insert(0, _Finder())
