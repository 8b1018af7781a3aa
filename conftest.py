"""What all tests share: commands in this process and in others, and which tests are those of absent applications."""

import os
import signal
import subprocess
import sys
from collections.abc import Callable
from importlib.metadata import entry_points
from pathlib import Path

import pytest

# Before any test imports PETSc or matplotlib, which would obey files of the current folder.
import restshape.surroundings

ROOT = Path(__file__).parent
ENVIRONMENT = {
    "OMP_NUM_THREADS": "1",
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_rmaps_base_oversubscribe": "1",
    "OMPI_MCA_btl": "^openib",
    # Ranks that wait give way: beside another worker there are more of them than cores.
    "OMPI_MCA_mpi_yield_when_idle": "1",
    "OMPI_MCA_btl_vader_single_copy_mechanism": "none",
    "OMPI_MCA_mca_base_component_show_load_errors": "0",
    # Processes find the applications of the tests, too.
    "PYTHONPATH": os.pathsep.join(filter(None, [str(ROOT / "tests" / "applications"), os.environ.get("PYTHONPATH")])),
}
os.environ.update(ENVIRONMENT)
# A shell that starts the tests in the background has them ignore Ctrl-C, and their children with them.
signal.signal(signal.SIGINT, signal.default_int_handler)
RESTSHAPE = (sys.executable, "-m", "restshape.cli.main")
Run = Callable[..., subprocess.CompletedProcess]
PROCESSES = {"restshape", "start_restshape", "outside"}
"""Fixtures of tests that start processes."""


def pytest_ignore_collect(collection_path: Path) -> bool | None:
    """True for tests of an application that is not installed."""
    parts = collection_path.relative_to(ROOT).parts if collection_path.is_relative_to(ROOT) else ()
    if parts[:1] != ("apps",) or "tests" not in parts:
        return None
    return True if parts[1] not in entry_points(group="restshape.applications").names else None


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark tests that start processes, which are those with a fixture of one, or of its environment."""
    for item in items:
        if not PROCESSES.isdisjoint(getattr(item, "fixturenames", ())):
            item.add_marker(pytest.mark.cli)


def _outside() -> dict[str, str]:
    """The environment without what an MPI that runs in this process left in it."""
    left = {k: v for k, v in os.environ.items() if not k.startswith(("OMPI_", "PMIX_", "PRTE_", "OPAL_"))}
    return left | ENVIRONMENT


@pytest.fixture
def restshape(tmp_path: Path) -> Run:
    """Runs a `restshape` command in tmp_path: ``restshape("replay", scene, ranks=2)``."""

    def run(*words: object, ranks: int = 1) -> subprocess.CompletedProcess:
        start = () if ranks == 1 else ("mpiexec", "-n", str(ranks))
        command = [*start, *RESTSHAPE, *map(str, words)]
        return subprocess.run(command, cwd=tmp_path, env=_outside(), capture_output=True, text=True, timeout=120)

    return run


@pytest.fixture
def command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> Run:
    """Runs a `restshape` command in tmp_path, in this process: ``command("replay", scene)``."""
    from restshape.cli.main import main

    def run(*words: object) -> subprocess.CompletedProcess:
        monkeypatch.chdir(tmp_path)
        capfd.readouterr()
        try:
            code = main([*map(str, words)])
        except SystemExit as ended:
            code = int(ended.code or 0)
        printed = capfd.readouterr()
        return subprocess.CompletedProcess(words, code, printed.out, printed.err)

    return run


@pytest.fixture
def on_ranks(restshape: Run, command: Run) -> Run:
    """Runs a command on one rank in this process, on more in processes of theirs: ``on_ranks(2, "replay", scene)``."""

    def run(ranks: int, *words: object) -> subprocess.CompletedProcess:
        return command(*words) if ranks == 1 else restshape(*words, ranks=ranks)

    return run


@pytest.fixture
def start_restshape(tmp_path: Path) -> Callable[..., subprocess.Popen]:
    """Starts a `restshape` command in tmp_path, in a process group of its own."""
    started = []

    def start(*words: object, ranks: int = 1) -> subprocess.Popen:
        prefix = () if ranks == 1 else ("mpiexec", "-n", str(ranks))
        process = subprocess.Popen(
            [*prefix, *RESTSHAPE, *map(str, words)],
            cwd=tmp_path,
            env=_outside(),
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )
        started.append(process)
        return process

    yield start
    for process in started:
        if process.poll() is None:
            process.kill()
        process.communicate()


@pytest.fixture
def outside() -> dict[str, str]:
    """The environment for other processes that start MPI."""
    return _outside()
