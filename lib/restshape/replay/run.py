"""Runs a whole replay and sums it up."""

from collections.abc import Callable, Iterator
from pathlib import Path

from petsc4py import PETSc

from restshape.analysis.analysis import RowValues
from restshape.replay.columns import columns_of
from restshape.replay.field_names import check_field_names
from restshape.replay.first_steps import FirstSteps
from restshape.replay.loop import Replay
from restshape.replay.parity import Parity
from restshape.replay.petsc_options import refusal
from restshape.replay.recorder import Recorder
from restshape.replay.request import Request
from restshape.replay.rounding import load_scales
from restshape.replay.row_table import table_of_rows
from restshape.replay.tally import Summary, Tally
from restshape.scene.plan import solved_physics
from restshape.surroundings import petsc_options


class AgreedInterrupt(KeyboardInterrupt):
    """All ranks have agreed to end after this frame: none of them waits for another."""


def run_replay(
    request: Request,
    recorder: Recorder | None = None,
    parity: bool = False,
    csv: Path | None = None,
    on_frame: Callable[[], None] = lambda: None,
    keep_rows: bool = True,
    say: Callable[[str], None] | None = None,
) -> Summary:
    """The summary of a replay on all ranks of PETSc's world, as `replay --json` writes it, with all `rows`.

    Args:
        request: what is to be replayed.
        recorder: takes each frame; on rank 0 only.
        parity: compare each frame with a cold solve on the same mesh.
        csv: file for a row of numbers a frame.
        on_frame: called after each frame; on several ranks an `AgreedInterrupt` of it ends the replay.
        keep_rows: give all `rows`; else those alone that the report of the application needs.
        say: takes a line of what the first frame is at, where that takes long.

    Raises:
        UserError: the scene cannot be simulated, or a file cannot be written.
    """
    comm = PETSc.COMM_WORLD
    first = comm.rank == 0
    replay = _replay(request, recorder)
    if recorder:
        recorder.add_header(_surroundings(comm) | {"singular": dict(replay.errors.singular.ever)})
    check = Parity(replay) if parity else None
    units = {name: quantity.unit for name, quantity in request.scene.quantities.items()}
    tally, rows, interrupted = Tally(units, load_scales(request.scene)), [], False
    ends: list[RowValues] = []
    keep = keep_rows or request.application.report is not None
    names = list(columns_of(request.scene, request.application, request.predict))
    with table_of_rows(csv if first else None, names) as table:
        try:
            for row in _frames(replay, request, say):
                if check:
                    row |= check()
                tally.add(row)
                ends = [*ends[:1], row]
                if keep:
                    rows.append(row)
                if table:
                    table(row)
                on_frame()
        except KeyboardInterrupt as interrupt:
            # Else the other ranks know nothing of it, and one that waits for this one cannot be determined.
            if (comm.size > 1 and not isinstance(interrupt, AgreedInterrupt)) or not tally.frames:
                raise
            interrupted = True
    summary = _summary(replay, request, tally, rows) | {"ends": ends, "interrupted": interrupted, "rows": rows}
    return summary | {"parity": check.summary()} if check else summary


def _summary(replay: Replay, request: Request, tally: Tally, rows: list[RowValues]) -> Summary:
    """What is said of all frames of a replay; `rows` are those that the report of the application needs."""
    summary = tally.summary(request.policy.name, replay.comm.size, replay.analysis.estimated_quantity)
    summary |= {"reasons": tally.reasons, "largest_residual": tally.largest_residual, "guess": request.policy.guess}
    summary |= {"singular": replay.errors.singular.ever} | replay.errors.linear_theory.summary()
    if request.application.report:
        summary |= request.application.report.summarised(rows)
    return summary


def _replay(request: Request, recorder: Recorder | None) -> Replay:
    """The replay, with its solvers set up."""
    try:
        return Replay(request, PETSc.COMM_WORLD, recorder)
    except PETSc.Error as error:
        if not request.petsc:
            raise
        raise refusal(error, request.petsc) from error


def _surroundings(comm: PETSc.Comm) -> dict[str, object]:
    """What a header says of ranks and PETSc."""
    version = list(PETSc.Sys.getVersion())
    return {"ranks": comm.size, "petsc": version, "petsc_in_effect": petsc_options()}


def _frames(replay: Replay, request: Request, say: Callable[[str], None] | None) -> Iterator[RowValues]:
    """The rows of all frames; where PETSc fails in the first one, what it says against the user's words."""
    petsc = request.petsc
    frames = replay.frames()
    steps = FirstSteps(replay, say) if say else None
    try:
        first = next(frames)
        if steps:
            steps.end()
        check_field_names(replay.analysis, replay.solver.space, solved_physics(request.scene, request.application))
        yield first
    except PETSc.Error as error:
        # On several ranks the others may not have failed.
        if not petsc or replay.comm.size > 1:
            raise
        raise refusal(error, petsc) from error
    yield from frames
