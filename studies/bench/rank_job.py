"""A timed replay on several ranks: what starts them, and the processes that run it."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from restshape_studies.bench.job import STOPPED, Job, Outcome, ending, read_reports

from restshape.cli.verbosity import relay
from restshape.errors import UserError

PROGRAM = "restshape_studies.bench.rank_process"
ROOT_MAY = ("OMPI_ALLOW_RUN_AS_ROOT", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM")
"""Without these Open MPI starts nothing for root, who may have nobody else in a container."""
PATIENCE = 10.0
"""Seconds in which a launcher ends its ranks."""


def cores() -> int:
    """How many cores there are for ranks: those of a job of Slurm, else those that this process may use."""
    tasks = os.environ.get("SLURM_NTASKS", "")
    if within_slurm() and tasks.isdigit():
        return int(tasks)
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def within_slurm() -> bool:
    """Whether this process is a job of Slurm that can start ranks on all of its machines."""
    return "SLURM_JOB_ID" in os.environ and shutil.which("srun") is not None


def launcher(ranks: int, oversubscribe: bool) -> list[str]:
    """The words that start so many ranks of a program.

    Raises:
        UserError: nothing is there that does.
    """
    if within_slurm():
        return ["srun", "--ntasks", str(ranks), *(["--overcommit"] if oversubscribe else [])]
    if shutil.which("mpiexec") is None:
        raise UserError("there is no mpiexec", "bench scaling", "install one, as docs/install.md says")
    return ["mpiexec", "-n", str(ranks)]


def surroundings(oversubscribe: bool) -> dict[str, str]:
    """The environment of ranks: one thread each; more of them than cores give way while they wait."""
    found = os.environ | {"OMP_NUM_THREADS": "1"}
    if hasattr(os, "geteuid") and os.geteuid() == 0:
        found = dict.fromkeys(ROOT_MAY, "1") | found
    if oversubscribe:
        found |= {"OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_mpi_yield_when_idle": "1"}
    return found


def run_on_ranks(
    job: Job, ranks: int, oversubscribe: bool = False, seconds: float | None = None, start: Sequence[str] = ()
) -> Outcome:
    """What the job gave in fresh processes, one a rank.

    Args:
        job: what to replay or to measure.
        ranks: how many.
        oversubscribe: ranks may share cores.
        seconds: after so long all are ended; the rows until then are kept.
        start: the words that start a program on ranks; empty: `launcher`.

    Raises:
        UserError: the job cannot be run: a bad scene, script, or option.
    """
    with tempfile.TemporaryDirectory(prefix="restshape-bench-", dir=_shared_folder()) as folder:
        given, reports = Path(folder) / "job.json", Path(folder) / "reports.jsonl"
        given.write_text(job.dumps(), encoding="utf-8")
        words = [*(start or launcher(ranks, oversubscribe)), sys.executable, "-P", "-m", PROGRAM]
        process = subprocess.Popen(
            [*words, str(given), str(reports)],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            env=surroundings(oversubscribe),
        )
        try:
            _, stderr = process.communicate(timeout=seconds)
            relay(stderr)
            problem = ending(process.returncode, cause(stderr))
        except subprocess.TimeoutExpired:
            problem = f"{STOPPED} after {seconds:.0f} s"
        finally:
            _end(process)
        return read_reports(reports, problem)


def cause(stderr: str) -> str:
    """What a rank has said of its end, without what launchers say of all of them; all of it where none has."""
    begin = stderr.rfind("Traceback (most recent call last)")
    return re.split(r"\n-{20,}|\nsrun: |\nAbort\(", stderr[begin:])[0] if begin >= 0 else stderr


def _shared_folder() -> str | None:
    """A folder that all machines of a job see; None: the usual one."""
    return os.getcwd() if within_slurm() else None


def _end(process: subprocess.Popen[str]) -> None:
    """End a launcher, which ends its ranks at a signal that it can catch."""
    if process.poll() is not None:
        return
    process.terminate()
    try:
        process.communicate(timeout=PATIENCE)
    except subprocess.TimeoutExpired:
        process.kill()
        process.communicate()
