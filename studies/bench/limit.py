"""The least time of a level-1 frame: what each stage must move and compute, over what this machine can."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from statistics import mean, median
from time import perf_counter
from typing import Any

import numpy as np
from petsc4py import PETSc

from restshape import _kernels
from restshape.analysis.static.steady import SteadyAnalysis
from restshape.errors import UserError
from restshape.interface.run import Run
from restshape.measurement import measure_bandwidth
from restshape.replay.request import Request
from restshape.replay.tally import beside

REAL, SINGLE, INDEX, PLACE = 8, 4, 4, 2
"""Bytes of a number, of one in single precision, of an index, and of a pair of nodes' place in a row of the matrix."""
VECTORS = 11
"""Vectors that an iteration of conjugate gradients reads or writes at least, without its preconditioner: read p and
write A p; read p, A p, x, r and write x, r; read z, p and write p."""
GEOMETRY = 14
"""Operations for the gradients of shape functions at a point: differences of places, determinant, quotients."""
QUALITY = 25
"""Operations for area and quality of a triangle."""
ANSWER = ("relocate", "values", "krylov", "observe")
"""Stages until the answer is known."""
BESIDE = ("residual", "estimate", "record")
"""What is done beside it."""
UNKNOWN = "the limit is known of linear steady problems on triangles alone"
INSTEAD = "take a linear scene of a solid in the plane or of heat, without motion and storage"


@dataclass(frozen=True)
class Applied:
    """An application of a preconditioner.

    Args:
        kind: PETSc's type.
        numbers: that are stored, of the factor's triangle or of all grids and the maps between them.
        stored: bytes of these, with an index a block.
        bytes, flops: of an application, its vectors included.
    """

    kind: str
    numbers: int
    stored: int
    bytes: int
    flops: int

    @classmethod
    def substitution(cls, numbers: int, fields: int, nodes: int, size: int = REAL, kind: str = "cholesky") -> Applied:
        """Both passes of a substitution with a factor in blocks of nodes.

        Args:
            numbers: of the factor's triangle; of both triangles of `ilu`, which are passed once each.
            fields, nodes: unknowns of a node, and number of nodes.
            size: bytes of a number.
            kind: PETSc's type.
        """
        stored = numbers * size + numbers // fields**2 * INDEX
        passes = 1 if kind == "ilu" else 2
        return cls(kind, numbers, stored, passes * stored + 4 * REAL * nodes * fields, 2 * passes * numbers)

    @classmethod
    def cycle(cls, grids: Sequence[tuple[int, int, int]], maps: Sequence[int]) -> Applied:
        """A V-cycle of algebraic multigrid in single precision, with a sweep before each coarser grid and one behind.

        On each grid but the coarsest each sweep passes the lower half of the matrix once, the inverse of the diagonal,
        and behind the diagonal too; vectors are of double precision.

        Args:
            grids: rows, stored numbers and block size of each, the coarsest first.
            maps: stored numbers of each interpolation, which is passed down and up.
        """
        sizes = [SINGLE * nz + INDEX * (nz // block**2) for _, nz, block in grids]
        mapped = sum((SINGLE + INDEX / 6) * nz for nz in maps)
        smoothed = sum(
            size + 2 * SINGLE * rows * block + 6 * REAL * rows for size, (rows, _, block) in zip(sizes[1:], grids[1:])
        )
        flops = sum(4 * (nz + rows * block) for rows, nz, block in grids[1:]) + sum(4 * nz for nz in maps)
        numbers = sum(nz for _, nz, _ in grids) + sum(maps)
        return cls("gamg", numbers, int(sum(sizes) + mapped), int(smoothed + 2 * mapped), flops)


@dataclass(frozen=True)
class Sizes:
    """What a frame works on.

    Args:
        nodes, dim, fields: number of nodes, coordinates and unknowns of each.
        cells, corners, points: number of cells, nodes and quadrature points of each.
        blocks: of the matrix that are stored, a pair of nodes each.
        preconditioner: an application of it.
        recorded: numbers that a recording takes, places included.
        observed: a quantity is taken over cells.
    """

    nodes: int
    dim: int
    fields: int
    cells: int
    corners: int
    points: int
    blocks: int
    preconditioner: Applied
    recorded: int
    observed: bool

    @property
    def vector(self) -> int:
        """Bytes of the unknowns."""
        return REAL * self.nodes * self.fields

    @property
    def places(self) -> int:
        """Bytes of the places of the nodes."""
        return REAL * self.nodes * self.dim

    @property
    def connectivity(self) -> int:
        """Bytes of the nodes of the cells."""
        return INDEX * self.cells * self.corners

    @property
    def matrix(self) -> int:
        """Bytes of the matrix in blocks of a node: numbers, an index a block, and where rows begin."""
        return self.blocks * (REAL * self.fields**2 + INDEX) + INDEX * (self.nodes + 1)

    @property
    def one_pass(self) -> int:
        """Bytes of one pass over cells, places and unknowns."""
        return self.connectivity + self.places + self.vector


@dataclass(frozen=True)
class Work:
    """What a stage must do: bytes to read and write, floating-point operations, and bytes that it goes round in."""

    bytes: float
    flops: float
    working_set: float


def works(sizes: Sizes, iterations: float) -> dict[str, Work]:
    """What each stage of a level-1 frame must do, in the order of the frame.

    Every array counts once where it is read and once where it is written; what a code moves besides does not count.

    Args:
        sizes: of the frame.
        iterations: of conjugate gradients with the kept preconditioner.

    Source: docs/theory/limits.md.
    """
    s, d, k, applied = sizes, sizes.dim, sizes.corners, sizes.preconditioner
    products = s.blocks * s.fields**2
    flux = s.cells * s.points * (GEOMETRY + 2 * k * s.fields * d + 4 * d)
    entries = (3 * d * d if s.fields > 1 else 2 * d) * k * (k + 1) // 2
    values = s.cells * (s.points * (GEOMETRY + 2 * k * d + entries) + (k * s.fields) ** 2)
    krylov = (iterations + 1) * s.matrix + iterations * (applied.bytes + VECTORS * s.vector) + 3 * s.vector
    recovered = REAL * s.nodes * 3
    amounts = {
        "relocate": (4 * s.places + s.connectivity, 4 * d * s.nodes + QUALITY * s.cells),
        "values": (
            s.places + s.connectivity + PLACE * s.cells * k * k + REAL * products + s.vector,
            values,
        ),
        "krylov": (
            krylov,
            2 * products * (iterations + 1) + iterations * (applied.flops + 12 * s.nodes * s.fields),
        ),
        "observe": (s.one_pass, flux) if s.observed else (0, 0),
        "residual": (s.matrix + 2 * s.vector, 2 * products + 3 * s.nodes * s.fields),
        "estimate": (2 * s.one_pass + 2 * recovered, 3 * flux),
        "record": (s.one_pass + 2 * REAL * s.recorded, flux),
    }
    # What was touched since a stage's data were last in use: a frame, iterations, or the pass before.
    iterated = s.matrix + applied.stored + 6 * s.vector
    frame = iterated + 4 * s.places + s.connectivity + PLACE * s.cells * k * k + REAL * s.recorded
    sets = dict.fromkeys(amounts, iterated) | {
        "relocate": frame,
        "values": frame,
        "estimate": s.one_pass + recovered,
        "record": s.one_pass + REAL * s.recorded,
    }
    return {name: Work(float(moved), float(flops), float(sets[name])) for name, (moved, flops) in amounts.items()}


def least(work: Work, bandwidth: float, flop_rate: float) -> tuple[float, str]:
    """The least time [ms] of a stage by the roofline, and what binds it: "bytes" or "flops".

    Args:
        work: of the stage.
        bandwidth: bytes a second at its working set; flop_rate: operations a second.

    Source: S. Williams, A. Waterman and D. Patterson, Commun. ACM 52 (2009) 65.
    """
    moving, computing = 1e3 * work.bytes / bandwidth, 1e3 * work.flops / flop_rate
    return max(moving, computing), "bytes" if moving >= computing else "flops"


def sizes_of(analysis: SteadyAnalysis[Any]) -> Sizes:
    """The sizes of what an analysis has solved last.

    Raises:
        UserError: it is none of a linear problem on triangles on one rank.
    """
    problem, space, system = analysis.problem, analysis.problem.space, analysis.state.system
    shape = analysis.x.shape
    nodes, fields = shape[0], shape[1] if len(shape) > 1 else 1
    cells, corners = space.cells.shape
    if not problem.linear or corners not in (3, 6) or space.X.shape[1] != 2 or analysis.context.comm.size > 1:
        raise UserError(UNKNOWN, str(analysis.state.scene.path), INSTEAD)
    points, constants = analysis.fields()
    arrays = [space.X, *points.values(), *constants.values()]
    return Sizes(
        nodes=nodes,
        dim=2,
        fields=fields,
        cells=cells,
        corners=corners,
        points=1 if corners == 3 else 3,
        blocks=int(system.mat.getInfo()["nz_used"]) // fields**2,
        preconditioner=applied_by(analysis.solver.ksp.getPC(), fields, nodes),
        recorded=sum(array.size for array in arrays),
        observed=bool(analysis.state.scene.quantities),
    )


def applied_by(pc: PETSc.PC, fields: int, nodes: int) -> Applied:
    """An application of a preconditioner that is set up."""
    if pc.getType() == "gamg":
        levels = range(pc.getMGLevels())
        grids = [pc.getMGSmoother(level).getOperators()[0] for level in levels]
        maps = [pc.getMGInterpolation(level) for level in levels[1:]]
        stored = [(grid.getSize()[0], int(grid.getInfo()["nz_used"]), grid.getBlockSize()) for grid in grids]
        return Applied.cycle(stored, [int(one.getInfo()["nz_used"]) for one in maps])
    factor = pc.getFactorMatrix()
    size = _kernels.panel_value_bytes(factor.handle) or REAL
    return Applied.substitution(int(factor.getInfo()["nz_used"]), fields, nodes, size, pc.getType())


def measure(request: Request, frames: int) -> dict[str, Any]:
    """The limit of level-1 frames of a replay with an old preconditioner, and how near they come to it.

    Residual, estimate and hand-over are made and timed beside each frame.

    Args:
        request: of a linear steady problem on triangles, under a policy that keeps factors.
        frames: of level 1, which are looked at.

    Raises:
        UserError: no such problem, or no such frames.

    Returns: sizes; frames, iterations (mean), refreshed (frames left out for a new one); flop_rate [1/s]; stages: by
        name bytes, flops, working_set [bytes], bandwidth [B/s], least_ms, ms (median), fraction, bound; rest_ms
        (median of the frame that is in no stage); answer and whole: least_ms, ms, fraction of the frame until its
        answer, and with what is beside it.
    """
    run = Run(replace(request, measured="nothing"), summed=False)
    analysis = run.replay.analysis
    if not isinstance(analysis, SteadyAnalysis):
        raise UserError(UNKNOWN, str(request.scene.path), INSTEAD)
    rows, refreshed = [], 0
    for row in run.rows():
        if row["level"] == 1 and not row["refused"]:
            own = {"ms_answer": row["ms"] - beside(row), **_beside(analysis)}
            refreshed += bool(row["pc_rebuilt"])
            if not row["pc_rebuilt"]:
                rows.append({**row, **own})
        if len(rows) == frames:
            break
    if not rows:
        raise UserError(
            "no frame moves the mesh with an old preconditioner", str(request.scene.path), "name another script"
        )
    return {"refreshed": refreshed, **record(sizes_of(analysis), rows, measure_bandwidth, _kernels.flop_rate())}


def record(
    sizes: Sizes, rows: list[dict[str, Any]], bandwidth_at: Callable[[float], float], flop_rate: float
) -> dict[str, Any]:
    """What `measure` returns, of rows of frames.

    Args:
        sizes: of the frames.
        rows: with the milliseconds of all stages, and until the answer (`ms_answer`).
        bandwidth_at: bytes a second at a working set [bytes].
        flop_rate: operations a second.
    """
    iterations = mean(row["iterations"] for row in rows)
    stages: dict[str, dict[str, Any]] = {}
    known: dict[float, float] = {}
    for name, work in works(sizes, iterations).items():
        rate = known.setdefault(work.working_set, 0.0) or bandwidth_at(work.working_set)
        known[work.working_set] = rate
        least_ms, bound = least(work, rate, flop_rate)
        ms = median(row[f"ms_{name}"] for row in rows)
        fraction = least_ms / ms if ms > 0.0 and least_ms > 0.0 else None
        stages[name] = {
            "bytes": work.bytes,
            "flops": work.flops,
            "working_set": work.working_set,
            "bandwidth": rate,
            "least_ms": least_ms,
            "ms": ms,
            "fraction": fraction,
            "bound": bound,
        }
    answer = median(row["ms_answer"] for row in rows)
    whole = median(row["ms_answer"] + sum(row[f"ms_{name}"] for name in BESIDE) for row in rows)
    return {
        "sizes": {**asdict(sizes), "unknowns": sizes.nodes * sizes.fields},
        "frames": len(rows),
        "iterations": iterations,
        "flop_rate": flop_rate,
        "stages": stages,
        "rest_ms": median(row["ms_answer"] - sum(row[f"ms_{name}"] for name in ANSWER) for row in rows),
        "answer": _share(stages, ANSWER, answer),
        "whole": _share(stages, (*ANSWER, *BESIDE), whole),
    }


def _share(stages: Mapping[str, Mapping[str, Any]], names: tuple[str, ...], ms: float) -> dict[str, float]:
    least_ms = sum(stages[name]["least_ms"] for name in names)
    return {"least_ms": least_ms, "ms": ms, "fraction": least_ms / ms}


def _beside(analysis: SteadyAnalysis[Any]) -> dict[str, float]:
    """Milliseconds of residual, estimate and hand-over of the last solution."""

    def hand_over() -> None:
        # As `Recorder.frame` does, into memory of its own in place of that of its process.
        points, constants = analysis.fields()
        at = 0
        for array in (analysis.problem.space.X, *points.values(), *constants.values()):
            room = shared[at : at + array.size]
            room[:] = array.ravel()
            at += array.size

    points, constants = analysis.fields()
    shared = np.empty(sum(a.size for a in (analysis.problem.space.X, *points.values(), *constants.values())))
    works_beside = {"residual": analysis.residual_norm, "estimate": analysis.errors, "record": hand_over}
    return {f"ms_{name}": _milliseconds(run) for name, run in works_beside.items()}


def _milliseconds(run: Callable[[], object]) -> float:
    start = perf_counter()
    run()
    return 1e3 * (perf_counter() - start)
