"""The study `restshape bench regret`: auto beside the best policy and the best schedule, by counted work."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from restshape_studies.bench.job import run
from restshape_studies.bench.turns import Announce, Case
from restshape_studies.commands.bench_kind import Kind, job_of, unchecked

from restshape.cli.options import print_table
from restshape.cli.regret_tables import HEADS, row, total
from restshape.errors import UserError

if TYPE_CHECKING:
    from restshape.variation.regret import Regret

MEASURE = "restshape.variation.regret"


def declare(parser: argparse.ArgumentParser) -> None:
    """Declare no arguments."""


def measure(args: argparse.Namespace, case: Case, announce: Announce) -> dict[str, Any]:
    """What `variation.regret.measure` finds; `problem` says why there is nothing, of several scenes."""
    announce(f"{case.name}: all policies, and schedules in hindsight")
    try:
        outcome = run(job_of(args, case, "auto", measure=MEASURE))
    except UserError as error:
        if len(args.scenes) == 1:
            raise
        return {"problem": error.what}
    return outcome.found or {"problem": outcome.problem}


def show(args: argparse.Namespace, name: str, found: dict[str, Any]) -> None:
    """Print why there is nothing of a scene, where that is so."""
    if "problem" in found:
        print(f"{name}: {found['problem']}")


def sum_up(found: dict[str, Any]) -> None:
    """Print the table, a row a scene."""
    known: dict[str, Regret] = {name: one for name, one in found.items() if "problem" not in one}
    rows = [row(name, one) for name, one in known.items()]
    if len(known) > 1:
        rows.append(total(list(known.values())))
    print_table("counted work of linear solves, by the calibration", HEADS, rows, right=HEADS[1:2] + HEADS[3:])


KINDS = (
    Kind(
        "regret",
        "auto beside the best policy, and beside the best schedule of refreshes, by counted work",
        declare,
        unchecked,
        measure,
        show,
        scenes="several",
        about="refreshes are those of its matrices",
        sum_up=sum_up,
    ),
)
