"""The process of each rank of a job: ``mpiexec -n N python -m restshape_studies.bench.rank_process JOB FILE``.

Rank 0 writes a row a frame into the file, and at the end what all ranks have measured.
"""

from __future__ import annotations

import json
import resource
import sys
import traceback
from collections.abc import Callable
from itertools import islice
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np
from restshape_studies.bench.job import Job
from restshape_studies.bench.process import run_of

from restshape.cli.verbosity import inherit_verbosity
from restshape.errors import ReplayProblem, UserError
from restshape.surroundings import start_petsc

if TYPE_CHECKING:
    from mpi4py.MPI import Comm
    from petsc4py import PETSc

    from restshape.replay.loop import Replay

Report = Callable[[str, Any], None]
ENTRY, SINGLE = 12, 4
"""Bytes of an entry of a sparse matrix: a number and its column; of a number of single precision."""
REDUCTIONS, EXCHANGES = 300, 100
"""How often a sum over ranks, and a message to and fro, are timed."""
MESSAGE = 1 << 20
"""Bytes of a message whose time is that of its bytes."""


def peak_mb() -> float:
    """The most memory [MB] that this process has had."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def rates(world: Comm, working_set: float) -> dict[str, Any]:
    """What the machine gives ranks that work at once; collective.

    Args:
        world: the ranks.
        working_set: bytes of the triad's arrays on all ranks together.

    Returns: bandwidth [B/s] of all together; latency_s of a sum of one number over the ranks; message_s and
        message_bandwidth [B/s] of a message between two of them, 0 on one rank.
    """
    from restshape.measurement import measure_bandwidth

    world.Barrier()
    bandwidth = world.allreduce(measure_bandwidth(working_set / world.size))
    number, total = np.ones(1), np.zeros(1)
    world.Barrier()
    start = perf_counter()
    for _ in range(REDUCTIONS):
        world.Allreduce(number, total)
    latency = (perf_counter() - start) / REDUCTIONS
    short, long = (_exchange_seconds(world, size) for size in (8, MESSAGE))
    return {
        "bandwidth": bandwidth,
        "latency_s": latency if world.size > 1 else 0.0,
        "message_s": short,
        "message_bandwidth": MESSAGE / max(long - short, 1e-9) if world.size > 1 else 0.0,
    }


def _exchange_seconds(world: Comm, size: int) -> float:
    """Seconds of a message of so many bytes from one rank to another one; 0 on one rank."""
    if world.size == 1:
        return 0.0
    buffer = bytearray(size)
    world.Barrier()
    start = perf_counter()
    for _ in range(EXCHANGES):
        if world.rank == 0:
            world.Send(buffer, 1)
            world.Recv(buffer, 1)
        elif world.rank == 1:
            world.Recv(buffer, 0)
            world.Send(buffer, 0)
    return float(world.bcast((perf_counter() - start) / (2 * EXCHANGES)))


class Messages:
    """What PETSc's solves have sent since the last call, by its log, which must have begun."""

    def __init__(self) -> None:
        from petsc4py import PETSc

        from restshape.algebra.stages import LOGGED, log_stage

        self._event = PETSc.Log.Event("KSPSolve")
        self._stages = [0, *(log_stage(name).id for name in LOGGED)]
        self._last = np.zeros(3)

    def since_last(self) -> list[float]:
        """Messages of this rank, their bytes, and sums over the ranks."""
        infos = [self._event.getPerfInfo(stage) for stage in self._stages]
        keys = ("numMessages", "messageLength", "numReductions")
        now = np.array([sum(info[key] for info in infos) for key in keys])
        before, self._last = self._last, now
        return [float(value) for value in now - before]


def own_work(replay: Replay) -> dict[str, float]:
    """What this rank works on.

    Returns: cells that touch its nodes, observed ones whose stresses it recovers, all_cells, its nodes; bytes of its
        part of matrix and preconditioner, and
        iteration, those that an iteration passes: 0 where an analysis keeps no linear system.
    """
    from petsc4py import PETSc
    from restshape_studies.bench.limit import VECTORS

    local = PETSc.Mat.InfoType.LOCAL
    space, rank, size = replay.solver.space, replay.comm.rank, replay.comm.size
    first, last = space.node_offsets[rank : rank + 2]
    touched = ((space.cells >= first) & (space.cells < last)).any(axis=1)
    shared = getattr(getattr(replay.analysis, "problem", None), "shared", None)
    observed = len(shared.part.space.chosen) if shared else len(space.cells)
    counted = {"cells": int(touched.sum()), "observed": observed, "all_cells": len(space.cells)}
    counted["nodes"] = int(last - first)
    solver = getattr(replay.analysis, "solver", None)
    if hasattr(solver, "pencil"):
        pencil = solver.pencil
        matrix = ENTRY * sum(mat.getInfo(local)["nz_used"] for mat in (pencil.stiffness, pencil.mass))
        return counted | {"matrix": matrix, "preconditioner": ENTRY * pencil.nonzeros / size, "iteration": 0.0}
    if not hasattr(solver, "ksp") or not solver.ksp.getOperators()[0].getType():
        return counted | {"matrix": 0.0, "preconditioner": 0.0, "iteration": 0.0}
    mat, pc = solver.ksp.getOperators()[0], solver.ksp.getPC()
    unknowns = mat.getSize()[0]
    fields = max(1, unknowns // len(space.X))
    own = mat.getLocalSize()[0]
    matrix = ENTRY * mat.getInfo(local)["nz_used"]
    if solver.kept.shared:
        # By panels of single precision, once forward and once back.
        filled = solver.kept.filled / size
        stored, passed = ENTRY * filled, 2.0 * SINGLE * filled
    else:
        stored, passed = _applied(pc, fields, own // fields, unknowns // fields, size)
    vectors = 8 * VECTORS * own
    return counted | {"matrix": matrix, "preconditioner": stored, "iteration": matrix + passed + vectors}


def _applied(pc: PETSc.PC, fields: int, nodes: int, all_nodes: int, ranks: int) -> tuple[float, float]:
    """Bytes of a rank's part of a preconditioner, and those that it passes in an application."""
    from restshape_studies.bench.limit import applied_by

    from restshape.algebra.preconditioner import FACTORS

    if pc.getType() == "asm":
        parts = [ksp.getPC() for ksp in pc.getASMSubKSP()]
        found = [applied_by(part, fields, nodes) for part in parts if part.getType() in FACTORS]
        return float(sum(one.stored for one in found)), float(sum(one.bytes for one in found))
    if pc.getType() == "gamg" or pc.getType() in FACTORS:
        found = applied_by(pc, fields, all_nodes)
        return found.stored / ranks, found.bytes / ranks
    return 0.0, 0.0


def play(job: Job, world: Comm, report: Report) -> None:
    """Replay on all ranks; report a row for each frame, then what each rank has measured."""
    from petsc4py import PETSc

    base = peak_mb()
    PETSc.Log.begin()
    run = run_of(job)
    messages, rows = Messages(), []
    for row in islice(run.rows(), job.frames):
        row["messages"], row["message_bytes"], row["reductions"] = messages.since_last()
        rows.append({key: value for key, value in row.items() if key.startswith("ms")})
        report("row", row)
    own: dict[str, Any] = {"ms": rows, "peak_mb": peak_mb(), "base_mb": base, **own_work(run.replay)}
    working_set = world.allreduce(own["matrix"] + own["preconditioner"])
    if working_set:
        own["bandwidth"] = rates(world, working_set)["bandwidth"]
    found = world.gather(own)
    if found:
        report("found", {"ranks": found, "working_set": working_set})


def main() -> int:
    """Run the job; 0 when it is done, 2 when it cannot be. A rank that fails ends all."""
    inherit_verbosity()
    job = Job.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
    start_petsc(job.petsc)
    from petsc4py import PETSc

    world = PETSc.COMM_WORLD.tompi4py()
    with Path(sys.argv[2] if world.rank == 0 else "/dev/null").open("w", buffering=1, encoding="utf-8") as file:

        def report(kind: str, content: Any) -> None:
            file.write(json.dumps([kind, content]) + "\n")

        try:
            if job.measure == "rates":
                report("found", rates(world, **job.details))
            else:
                play(job, world, report)
        except UserError as error:
            report("error", {"what": error.what, "where": error.where, "do": error.do})
            return 2
        except ReplayProblem as problem:
            report("error", {"what": str(problem), "where": job.scene, "do": "see restshape replay on it"})
            return 2
        except BaseException:
            traceback.print_exc()
            sys.stderr.flush()
            world.Abort(1)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
