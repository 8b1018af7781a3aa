"""Run by mpiexec: a flow on two ranks with each candidate; prints residuals and iterations as JSON."""

import json
import sys
from pathlib import Path

from petsc4py import PETSc
from restshape_studies.stability.scenery import make_replay

from restshape.algebra.reuse.candidates import STEADY_FLOW

WORLD = PETSc.COMM_WORLD


def solved(scene: Path, name: str, overlap: str) -> dict[str, object]:
    """The first frame of a scene with one candidate alone."""
    PETSc.Options("flow_").setValue("pc_asm_overlap", overlap)
    made = make_replay(scene, None)
    for other in STEADY_FLOW:
        if other.name != name:
            made.analysis.solver.kept.choice.exclude(other)
    row = next(iter(made.frames()))
    return {"drag": row["q_drag"], "iterations": row["iterations"], "name": row["preconditioner"]}


def main(scene: Path) -> None:
    asked = [f"{name} {overlap}" for name in ("lu", "ilu(1)") for overlap in "01"]
    asked += ["bicgstab+ilu(0) 1", "lu, rows exchanged 1"]
    found = {one: solved(scene, *one.rsplit(" ", 1)) for one in asked}
    if WORLD.rank == 0:
        print(json.dumps(found))


main(Path(sys.argv[1]))
