"""Processes that begin with all imported: each starts PETSc and MPI for itself."""

import io
import multiprocessing
import os
import runpy
import subprocess
import sys
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from multiprocessing import reduction
from multiprocessing.process import BaseProcess
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import IO, Any

RECORDER = "restshape.replay.recording.recorder_process"
COMMANDS = ["restshape.cli.check", "restshape.cli.replay", "restshape.cli.start_notes", "h5py"]
EXAMPLES = ["restshape_studies.stability.strategies", "scipy.sparse.linalg"]
IMPORTED = [RECORDER, *COMMANDS, *EXAMPLES]
"""What the process imports that all others are forked from. It does not find this module, which imports little."""
PETSC = "petsc4py.PETSc"


def run_forked(
    words: list[str], folder: Path, environment: dict[str, str], seconds: float
) -> subprocess.CompletedProcess:
    """What a command gave that ran in a process of its own in a folder.

    Args:
        words: after ``restshape``.
        environment: all of the variables that the process has.
        seconds: after which it is killed.

    Raises:
        TimeoutError: it was killed.
    """
    files = [folder.parent / f"{folder.name}.{name}" for name in ("printed", "reported")]
    process = _start(_run, words, folder, environment, files)
    process.join(seconds)
    if process.exitcode is None:
        process.kill()
        process.join()
        raise TimeoutError(f"restshape {' '.join(words)}: no end after {seconds} s")
    out, err = (file.read_text() for file in files)
    return subprocess.CompletedProcess(words, process.exitcode, out, err)


def _start(does: Callable[..., None], *args: Any) -> BaseProcess:
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(IMPORTED)
    process = context.Process(target=does, args=args, daemon=True)
    process.start()
    return process


def _run(words: list[str], folder: Path, environment: dict[str, str], files: list[Path]) -> None:
    from restshape.cli.main import main

    _begin(environment, files)
    os.chdir(folder)
    _end(lambda: main(words))


def _begin(environment: dict[str, str], files: Sequence[str | Path]) -> None:
    """Have this process's own environment, and write into files what it prints and what it reports."""
    assert PETSC not in sys.modules, "the process that others are forked from has started PETSc"
    os.environ.clear()
    os.environ.update(environment)
    for number, file in enumerate(files, start=1):
        opened = os.open(file, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(opened, number)
        os.close(opened)


def _end(work: Callable[[], Any]) -> None:
    """Do the work, and end as an interpreter does."""
    try:
        code = work()
    except SystemExit as ended:
        code = ended.code
    except Exception:
        traceback.print_exc()
        code = 1
    # Where PETSc says what it has to say.
    if PETSC in sys.modules:
        sys.modules[PETSC]._finalize()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(int(code or 0))


class Forked:
    """Stands in for `subprocess.Popen`."""

    process: BaseProcess

    def _begin(self, does: Callable[..., None], *args: Any) -> None:
        self.process = _start(does, *args)
        self.pid = self.process.pid

    @property
    def returncode(self) -> int | None:
        """Its exit code, or the negative number of the signal that has ended it; None while it runs."""
        return self.process.exitcode

    def poll(self) -> int | None:
        """The same."""
        return self.returncode

    def wait(self, timeout: float | None = None) -> None:
        """Wait for its end."""
        self.process.join(timeout)
        if self.returncode is None:
            raise subprocess.TimeoutExpired("a forked process", timeout or 0.0)

    def send_signal(self, number: int) -> None:
        """Send it a signal."""
        os.kill(self.process.pid, number)

    def kill(self) -> None:
        """End it."""
        self.process.kill()


class ForkedExamples(Forked):
    """The process of ``python -P -m MODULE WORDS``, which begins when its stdin is closed.

    Args:
        command: that would start it.
        stderr: the file that it reports to.
        env: its environment.
    """

    def __init__(self, command: Sequence[str], stderr: IO[str], env: dict[str, str], **_: object) -> None:
        _, *options, module = command[:4]
        assert options == ["-P", "-m"], command
        self.stdin = Asked(lambda text: self._begin(_run_module, module, command[4:], text, stderr.name, env))


class ForkedRecorder(Forked):
    """The process that writes a recording.

    Args:
        command: that would start it.
        pass_fds: that it inherits.
        env: its environment.
    """

    def __init__(self, command: Sequence[str], pass_fds: Sequence[int], env: dict[str, str], **_: object) -> None:
        assert command[1:4] == ["-P", "-m", RECORDER] and command[4:8] == [str(fd) for fd in pass_fds]
        self._begin(_record, [Inherited(fd) for fd in pass_fds], command[8], env)


class Inherited:
    """A descriptor of this process, which is one of the forked process, too: its number there."""

    def __init__(self, number: int) -> None:
        self.number = number

    def __reduce__(self) -> tuple[Callable[..., int], tuple[object]]:
        return _detached, (reduction.DupFd(self.number),)


def _detached(duplicate: Any) -> int:
    return duplicate.detach()


def _record(descriptors: Sequence[int], cores: str, environment: dict[str, str]) -> None:
    from restshape.replay.recording.recorder_process import main

    _begin(environment, [os.devnull, os.devnull])
    os.setsid()
    _end(lambda: main([*map(str, descriptors), cores]))


class Asked(io.StringIO):
    """What a process is asked for, which begins when that is known; `begin` is given the text."""

    def __init__(self, begin: Callable[[str], None]) -> None:
        super().__init__()
        self.begin = begin

    def close(self) -> None:
        """Begin."""
        if not self.closed:
            self.begin(self.getvalue())
        super().close()


def _run_module(module: str, words: Sequence[str], text: str, stderr: str, environment: dict[str, str]) -> None:
    _begin(environment, [os.devnull, stderr])
    sys.stdin, sys.argv = io.StringIO(text), [module, *words]
    sys.path[:0] = environment.get("PYTHONPATH", "").split(os.pathsep)
    _end(lambda: runpy.run_module(module, run_name="__main__", alter_sys=True) and None)


@contextmanager
def examples_forked() -> Iterator[None]:
    """Within, processes of random examples and hard cases are forked; their own tests start real ones."""
    from restshape_studies.stability import watched

    with _standing_in(watched, ForkedExamples):
        yield


@contextmanager
def recorders_forked() -> Iterator[None]:
    """Within, processes that write recordings are forked; their own tests start real ones."""
    from restshape.replay.recording import recorder_start

    with _standing_in(recorder_start, ForkedRecorder):
        yield


@contextmanager
def _standing_in(module: ModuleType, process: type[Forked]) -> Iterator[None]:
    names = {name: getattr(subprocess, name) for name in ("PIPE", "DEVNULL", "TimeoutExpired")}
    module.subprocess = SimpleNamespace(Popen=process, **names)
    try:
        yield
    finally:
        module.subprocess = subprocess
