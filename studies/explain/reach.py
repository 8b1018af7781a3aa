"""What `mesh.reach` moves in the drags of a script, and what a solve of that part is expected to cost."""

from __future__ import annotations

from typing import Any

from restshape.errors import UserError
from restshape.interface.run import Run
from restshape.outputs.si_numbers import counted
from restshape.replay.loop import Replay
from restshape.replay.request import Request
from restshape.scene.edit_script import Script
from restshape.scene.model import Scene

Line = tuple[str, str, str]
NAME = "reach"


def reach(scene: Scene, script: Script | None) -> list[Line]:
    """How many nodes the first drag of a script moves, and the price: what, which, why; nothing without a reach."""
    if scene.mesh.reach is None:
        return []
    whole = "the whole is solved for"
    if script is None:
        return [(NAME, "nothing", "there is no script, and so no drag")]
    try:
        run = Run(Request.of(scene, script), summed=False)
        replay = run.replay
        for row in run.rows():
            part = getattr(replay.moving, "part", None)
            if row["level"] in (1, 2) and part is not None:
                break
        else:
            return [(NAME, whole, "no drag moves a part of the mesh alone")]
    except UserError as error:
        return [(NAME, "nothing", f"refused: {error.what}")]
    moves = f"{counted(len(part.nodes), 'node')} of {len(replay.moving.mesh.X)} ({100 * part.share:.3g} %)"
    parts: Any = getattr(replay.analysis, "parts", None)
    if parts is None or parts.solved is not replay.analysis.state:
        return [(NAME, f"{moves} move, and {whole}", "as --verbose of restshape replay says")]
    found = parts.found
    kept = found.solver.kept
    price = {name: choice.cost(candidate, size) for name, choice, candidate, size in _asked(replay, kept)}
    costs = ", ".join(f"{name} {1e3 * seconds:.3g}" for name, seconds in price.items())
    border = f"{len(found.part.rest)} unknowns on {len(found.part.border)} of the border"
    return [(NAME, f"{moves} move; {border} are condensed", f"expected ms a solve: {costs}" if costs else "")]


def _asked(replay: Replay, kept: Any) -> list[tuple[str, Any, Any, Any]]:
    """The kept preconditioners of the part and of the whole, with what prices them; none where there is no choice."""
    whole: Any = replay.analysis.solver.kept  # type: ignore[attr-defined]
    both = (("the part", kept), ("the whole", whole))
    return [(name, one.choice, one.candidate, one.size) for name, one in both if one.candidate is not None]
