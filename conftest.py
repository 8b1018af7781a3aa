"""What all tests share: commands in this process and others; tests of absent applications, and those of a week."""

import gc
import os
import signal
import subprocess
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import cache, wraps
from importlib import import_module
from importlib.metadata import entry_points
from itertools import chain, pairwise
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

# Before any test imports PETSc or matplotlib, which would obey files of the current folder.
import restshape.surroundings

if TYPE_CHECKING:
    from _pytest.terminal import TerminalReporter
    from two_ranks import TwoRanks

ROOT = Path(__file__).parent
ENVIRONMENT = {
    "OMP_NUM_THREADS": "1",
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_rmaps_base_oversubscribe": "1",
    # With "uct" each process would end a second later.
    "OMPI_MCA_btl": "^uct,openib,ofi",
    "OMPI_MCA_ess_singleton_isolated": "1",
    # Ranks that wait give way: beside another worker there are more of them than cores.
    "OMPI_MCA_mpi_yield_when_idle": "1",
    "OMPI_MCA_btl_vader_single_copy_mechanism": "none",
    "OMPI_MCA_mca_base_component_show_load_errors": "0",
    # Processes find the applications of the tests, too.
    "PYTHONPATH": os.pathsep.join(filter(None, [str(ROOT / "tests" / "applications"), os.environ.get("PYTHONPATH")])),
}
os.environ.update(ENVIRONMENT)
# Where the surroundings forbid compiled files, each worker and each process of a test would compile all again.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False
# A shell that starts the tests in the background, or nohup, has them ignore signals, and their children with them.
signal.signal(signal.SIGINT, signal.default_int_handler)
signal.signal(signal.SIGQUIT, signal.SIG_DFL)
signal.signal(signal.SIGHUP, signal.SIG_DFL)
RESTSHAPE = (sys.executable, "-m", "restshape.cli.main")
Run = Callable[..., subprocess.CompletedProcess]
GARBAGE = 20_000
"""Objects after which garbage is collected: what tests make is small, and most of it goes without."""
SLOWEST = 15
"""Files that are named at the end."""
PROCESSES = {"restshape", "start_restshape", "outside", "two_ranks"}
"""Fixtures of tests that start processes."""


@cache
def _installed() -> frozenset[str]:
    """Names of the applications that are installed."""
    return frozenset(entry_points(group="restshape.applications").names)


def pytest_ignore_collect(collection_path: Path) -> bool | None:
    """True for tests of an application that is not installed."""
    parts = collection_path.relative_to(ROOT).parts if collection_path.is_relative_to(ROOT) else ()
    if parts[:1] != ("apps",) or "tests" not in parts:
        return None
    return True if parts[1] not in _installed() else None


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Mark tests that start processes, which are those with a fixture of one or of its environment, and those on ranks.

    Weekly tests are left out unless `-m` names their mark.
    """
    if "weekly" not in config.option.markexpr:
        left_out = [item for item in items if item.get_closest_marker("weekly")]
        config.hook.pytest_deselected(items=left_out)
        items[:] = [item for item in items if item not in left_out]
    for item in items:
        names = getattr(item, "fixturenames", ())
        if not PROCESSES.isdisjoint(names):
            item.add_marker(pytest.mark.cli)
        if "two_ranks" in names:
            item.add_marker(pytest.mark.mpi)
        if item.get_closest_marker("mpi"):
            item.add_marker(pytest.mark.ranks)


def pytest_sessionstart(session: pytest.Session) -> None:
    """Have one worker import the last half of all tests first: each finds half of them compiled by the other.

    What pytest makes of asserts takes longer than all else that is done before the first test.
    """
    config = session.config
    if os.environ.get("PYTEST_XDIST_WORKER") != "gw1" or config.args != config.getini("testpaths"):
        return
    files = [path for folder in config.args for path in sorted((ROOT / folder).rglob("test_*.py"))]
    for path in reversed(files[len(files) // 2 :]):
        if not pytest_ignore_collect(path):
            sys.path.insert(0, str(path.parent))
            # What is wrong with a test, or leaves it out, is said when it is collected.
            with suppress(Exception, pytest.skip.Exception):
                import_module(path.stem)


def pytest_configure() -> None:
    """Leave random examples to their strategies: reading constants from all modules takes longer than the examples."""
    from hypothesis.internal.conjecture import providers

    if hasattr(providers, "_get_local_constants") and hasattr(providers, "_local_constants"):
        providers._get_local_constants = lambda: providers._local_constants


def pytest_collection_finish() -> None:
    """Leave what tests are made of, and what they have imported, out of the collections of garbage to come."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(GARBAGE)


def pytest_terminal_summary(terminalreporter: "TerminalReporter") -> None:
    """Say which files take longest, and what all of them take: growth is seen before the time is over."""
    spent: Counter[str] = Counter()
    for report in chain.from_iterable(terminalreporter.stats.values()):
        if isinstance(report, pytest.TestReport):
            spent[report.nodeid.partition("::")[0]] += report.duration
    if len(spent) > SLOWEST:
        terminalreporter.section(f"slowest files of {len(spent)}, which take {sum(spent.values()):.0f} s together")
        for name, seconds in spent.most_common(SLOWEST):
            terminalreporter.write_line(f"{seconds:7.1f} s  {name}")


# The words of the processes that the present test has started.
_started: list[list[str]] = []


_start_process = subprocess.Popen.__init__


@wraps(_start_process)
def _notice(process: subprocess.Popen, args: object, *rest: object, **settings: object) -> None:
    """Note the words before a process starts; an audit hook would be called at whatever is opened or imported, too."""
    words = [args] if isinstance(args, str | os.PathLike) else list(args)
    _started.append([os.fspath(word) for word in words])
    _start_process(process, args, *rest, **settings)


subprocess.Popen.__init__ = _notice


def mark_needed(words: list[str]) -> str:
    """The mark of tests that start a process with these words; none for those that the program starts by itself."""
    program = Path(words[0]).name
    if program == "mpiexec" and "--version" not in words:
        return "mpi"
    if program not in (Path(sys.executable).name, "restshape"):
        return ""
    modules = [module for flag, module in pairwise(words) if flag == "-m"]
    own = any(module.startswith("restshape") and module != RESTSHAPE[-1] for module in modules)
    return "" if own else "cli"


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Iterator[None]:
    """A test that starts a process has the mark that says so."""
    _started.clear()
    yield
    for words in _started:
        mark = mark_needed(words)
        assert not mark or item.get_closest_marker(mark), f"a test with {words} needs the mark {mark}"


def _one_core() -> set[int]:
    """A core for ranks that wait for each other: they look busy to each other's core, but give way on the same one."""
    worker, cores = os.environ.get("PYTEST_XDIST_WORKER", "gw0"), sorted(os.sched_getaffinity(0))
    return {cores[int(worker.removeprefix("gw")) % len(cores)]}


def _ranks(number: int) -> tuple[tuple[str, ...], Callable[[], None] | None]:
    """What starts ranks: words before a command, and what their process does first."""
    if number == 1:
        return (), None
    core = _one_core()
    return ("mpiexec", "--bind-to", "none", "-n", str(number)), lambda: os.sched_setaffinity(0, core)


def _outside() -> dict[str, str]:
    """The environment without what an MPI that runs in this process left in it."""
    left = {k: v for k, v in os.environ.items() if not k.startswith(("OMPI_", "PMIX_", "PRTE_", "OPAL_"))}
    return left | ENVIRONMENT


@pytest.fixture
def restshape(tmp_path: Path) -> Run:
    """Runs a `restshape` command in tmp_path, in a process of its own: ``restshape("replay", scene, ranks=2)``.

    A single process is forked from one that has imported the command line. With ``fresh`` it starts as a user's does.
    """
    from forked import run_forked

    def run(*words: object, ranks: int = 1, fresh: bool = False) -> subprocess.CompletedProcess:
        if ranks == 1 and not fresh:
            return run_forked([*map(str, words)], tmp_path, _outside(), 120.0)
        start, first = _ranks(ranks)
        command, settings = [*start, *RESTSHAPE, *map(str, words)], {"capture_output": True, "text": True}
        return subprocess.run(command, cwd=tmp_path, env=_outside(), timeout=120, preexec_fn=first, **settings)

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


@pytest.fixture(scope="session")
def two_ranks() -> Iterator["TwoRanks"]:
    """Two ranks that stay for all tests."""
    from two_ranks import TwoRanks

    ranks = TwoRanks(*_ranks(2), _outside())
    yield ranks
    ranks.stop()


@pytest.fixture
def on_ranks(two_ranks: "TwoRanks", command: Run, tmp_path: Path) -> Run:
    """Runs a command in tmp_path on one rank, in this process, or on two, which stay for further commands.

    ``on_ranks(2, "replay", scene)``. Words after ``--`` come too late for them: they have started PETSc.
    """

    def run(ranks: int, *words: object) -> subprocess.CompletedProcess:
        return command(*words) if ranks == 1 else two_ranks(*words, folder=tmp_path)

    return run


@pytest.fixture
def jobs_here() -> Iterator[None]:
    """Jobs of studies run in this process."""
    from jobs_here import jobs_run_here

    with jobs_run_here():
        yield


@pytest.fixture(autouse=True, scope="session")
def forked_recorders() -> Iterator[None]:
    """Processes that write recordings of replays in this process are forked."""
    from forked import recorders_forked

    with recorders_forked():
        yield


@pytest.fixture
def forked_examples() -> Iterator[None]:
    """Processes that play random examples are forked."""
    from forked import examples_forked

    with examples_forked():
        yield


@pytest.fixture
def start_restshape(tmp_path: Path) -> Callable[..., subprocess.Popen]:
    """Starts a `restshape` command in tmp_path, in a process group of its own."""
    started = []

    def start(*words: object, ranks: int = 1) -> subprocess.Popen:
        prefix, first = _ranks(ranks)
        process = subprocess.Popen(
            [*prefix, *RESTSHAPE, *map(str, words)],
            preexec_fn=first,
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


@pytest.fixture(scope="session")
def outside() -> dict[str, str]:
    """The environment for other processes that start MPI."""
    return _outside()
