"""Jobs of studies run in this process, which saves the start of one each; their own tests start real ones."""

import io
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, redirect_stderr

import pytest
from restshape_studies.bench import process
from restshape_studies.bench.job import run


class Here:
    """Stands in for the process of a job: its program, run in this process when it is given the job.

    Args:
        command: that would start it, of which the last word is the file for its reports.

    Attributes:
        returncode: None before it has run.
    """

    def __init__(self, command: Sequence[str], **_: object) -> None:
        self.words, self.returncode = command[-2:], None

    def communicate(self, text: str, timeout: float | None = None) -> tuple[str, str]:
        """Run it; `timeout` is not kept. What it has printed."""
        with pytest.MonkeyPatch.context() as changed, redirect_stderr(io.StringIO()) as printed:
            changed.setattr(sys, "stdin", io.StringIO(text))
            changed.setattr(sys, "argv", [*self.words])
            changed.setattr(process, "pin", lambda: None)
            changed.setattr(process, "start_petsc", self._started)
            self.returncode = process.main()
        return "", printed.getvalue()

    @staticmethod
    def _started(words: Sequence[str]) -> None:
        assert not words, "PETSc has been started without them"

    def poll(self) -> int | None:
        """Its exit code."""
        return self.returncode


@contextmanager
def jobs_run_here() -> Iterator[None]:
    """Within, jobs of studies start no process."""
    assert run.__defaults__ == (None, subprocess.Popen)
    with pytest.MonkeyPatch.context() as changed:
        changed.setattr(run, "__defaults__", (None, Here))
        yield
