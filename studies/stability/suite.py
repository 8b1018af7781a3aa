"""The hard cases of all applications, and their runs in a process that may crash or hang."""

import math
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from restshape_studies.stability.case import Case, Statement, Trial
from restshape_studies.stability.watched import watch
from restshape_studies.verification import check_cases, verifications

from restshape.errors import ReplayProblem, UserError
from restshape.policy import POLICIES

PROCESS = "restshape_studies.stability.case_process"
Row = dict[str, Any]
Job = tuple[str, str]
"""The name of a case and a policy."""


def cases() -> dict[str, Case]:
    """All cases of the installed applications, by ``application.name``."""
    return {
        f"{app}.{name}": case
        for app, known in verifications().items()
        for name, case in known.load_hard_cases().items()
    }


def jobs(known: dict[str, Case], names: Sequence[str], policies: Sequence[str]) -> list[Job]:
    """What is to be run.

    Args:
        known: all cases.
        names: of those wanted; none: all.
        policies: wanted; none: those that each case names, "all": every one.

    Raises:
        UserError: no such case.
    """
    check_cases(list(names), known, "restshape stability --list names them")
    chosen = tuple(POLICIES) if "all" in policies else tuple(policies)
    return [(name, policy) for name in names or known for policy in chosen or known[name].policies]


def run_case(name: str, case: Case, trial: Trial) -> Row:
    """What came of a case: one row; a policy under which it has no meaning gives one with the reason."""
    start = time.perf_counter()
    row: Row = {"case": name, "policy": trial.policy, "left_out": case.exempt.get(trial.policy, "")}
    if row["left_out"]:
        return {**row, **row_of([]), "holds": None, "seconds": 0.0}
    found: list[Statement] = []
    try:
        found += case.run(trial)
    except (UserError, ReplayProblem) as problem:
        found.append(Statement("nothing refused as a whole", str(problem), False))
    # Folders of trials are gone when a row is read, and differ from run to run.
    found = [replace(one, value=_without(trial.folder, one.value)) for one in found]
    return {**row, **row_of(found), "seconds": time.perf_counter() - start}


def _without(folder: Path, value: float | str) -> float | str:
    """A value whose words name files by their places in a folder."""
    return value.replace(f"{folder}/", "") if isinstance(value, str) else value


def not_begun(name: str, policy: str, seconds: float) -> Row:
    """The row of a case that would have begun after so long."""
    reason = f"no more than {seconds:g} s were wanted"
    return {"case": name, "policy": policy, "left_out": reason, **row_of([]), "holds": None, "seconds": 0.0}


def row_of(found: Sequence[Statement]) -> Row:
    """What a row says: the first statement that fails, else the first one; and all of them."""
    shown = next((s for s in found if not s.holds), found[0] if found else Statement("", "", False))
    statements = [{**asdict(s), "value": _plain(s.value)} for s in found]
    holds = bool(found) and all(s.holds for s in found)
    return {"must": shown.must, "value": _plain(shown.value), "holds": holds, "statements": statements}


def _plain(value: float | str) -> float | str:
    """The value as JSON knows it."""
    return value if isinstance(value, str) or math.isfinite(value) else str(value)


def run_apart(
    wanted: Sequence[Job],
    silence: float,
    share: float,
    seconds: float,
    petsc: Sequence[str],
    report: Callable[[Row], None],
) -> list[Row]:
    """The rows of all jobs, run one after the other in a process; one that it does not survive fails.

    Args:
        wanted: what to run.
        silence: seconds that one job may take.
        share: of each case's frames or seeds.
        seconds: no job begins after so long: the rest is left out.
        petsc: words for PETSc's options database.
        report: is given each row, as soon as it is there.
    """
    rows: list[Row] = []
    start = time.monotonic()

    def add(row: Row) -> None:
        rows.append(row)
        report(row)

    while len(rows) < len(wanted):
        left = wanted[len(rows) :]
        spare = seconds - (time.monotonic() - start)
        with tempfile.TemporaryDirectory(prefix="restshape-stability-") as folder:
            job = {"jobs": left, "share": share, "seconds": None if math.isinf(spare) else spare}
            end = watch(PROCESS, Path(folder), job, silence, lambda kind, row: add(row), tuple(petsc))
        left = wanted[len(rows) :]
        if left and end.problem:
            name, policy = left[0]
            words = end.last_words.rpartition(" | ")[2] or end.problem
            lost = row_of([Statement("the process survives", f"{end.problem}: {words}"[:600], False)])
            add({"case": name, "policy": policy, "left_out": "", **lost, "seconds": math.nan})
        elif left:
            for name, policy in left:
                add(not_begun(name, policy, seconds))
    return rows
