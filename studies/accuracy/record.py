"""What a study says of each of its points, from what the point's process reported."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from statistics import median
from typing import Any

import numpy as np
from restshape_studies.accuracy.setting import Setting
from restshape_studies.bench.job import Outcome

from restshape.outputs.si_numbers import counted
from restshape.scene.expressions import Expression
from restshape.scene.model import Scene

Row = dict[str, Any]
PARTS = ("discretisation", "algebraic", "reuse")
BOUNDS = (0.5, 2.0)
"""Between which the effectivity of an estimate is wanted."""


@dataclass(frozen=True)
class Truth:
    """What quantities are counted from.

    Args:
        values: by frame and name, of the reference.
        coarser: the same of the coarser one.
        exact: by name, closed forms on the first shape.
        uncertainty: by measure of the field, how far the two references are from each other in the worst frame.
    """

    values: dict[str, dict[str, float]]
    coarser: dict[str, dict[str, float]]
    exact: dict[str, float]
    uncertainty: dict[str, float]

    def scale(self, name: str) -> float:
        """The largest size of a quantity over the frames, that its errors are relative to; 0 where it has no number."""
        sizes = [abs(part_of[name]) for part_of in self.values.values() if np.isfinite(part_of.get(name, np.nan))]
        return max([*sizes, abs(self.exact.get(name, 0.0))], default=0.0)

    def error(self, name: str, frame: str, value: float) -> float:
        """The relative error of a quantity; not a number where it has none."""
        true = self.exact[name] if frame == "0" and name in self.exact else self.values[frame].get(name, np.nan)
        scale = self.scale(name)
        if true == value:
            return 0.0
        return abs(value - true) / scale if scale else float("nan")

    def doubt(self, name: str) -> float:
        """How far the two references are from each other in a quantity, relative, in the worst frame."""
        scale = self.scale(name)
        both = [(self.values[f].get(name), self.coarser[f].get(name)) for f in self.values if f in self.coarser]
        worst = [abs(a - b) for a, b in both if a is not None and b is not None and a != b]
        return max(worst) / scale if worst and scale else 0.0


def truth_of(scene: Scene, fine: Row, coarse: Row) -> Truth:
    """The truth from what the processes of both references reported."""
    uncertainty: dict[str, float] = {}
    for distances in fine["distances"].values():
        for measure, value in distances.items():
            uncertainty[measure] = max(uncertainty.get(measure, 0.0), value)
    return Truth(fine["quantities"], coarse["quantities"], closed_forms(scene), uncertainty)


def closed_forms(scene: Scene) -> dict[str, float]:
    """Values of the quantities that the scene knows a closed form of."""
    found = {}
    for name, quantity in scene.quantities.items():
        if isinstance(quantity.reference, Expression):
            found[name] = float(quantity.reference.evaluate(0.0, 0.0, scene.parameters))
        elif quantity.reference is not None:
            found[name] = quantity.reference
    return found


def record(name: str, scene: Scene, setting: Setting, outcome: Outcome, truth: Truth, of: str) -> Row:
    """A point as `accuracy --json` writes it.

    Args:
        name: of the scene.
        scene: with its own settings.
        setting: of the point.
        outcome: of its process.
        truth: that errors are counted from.
        of: "field", or the quantity whose error is `error`.
    """
    blank = _blank(name, scene, setting) | {"problem": nameless(outcome.problem)}
    run = outcome.found
    if not run:
        return blank | {"problem": blank["problem"] or "the process reported nothing"}
    frames = [frame for frame in run["frames"] if "errors" in frame]
    problems = [f"frame {frame['index']}: {frame['problem']}" for frame in run["frames"] if "problem" in frame]
    problems += without(run["refused"], "a solution")
    problems += without(
        run["lost"],
        f"a solution at the tolerance {run['tight_tolerance']:g}, so that the error is not split",
    )
    times = {key: run[key] for key in ("frame_ms", "total_s", "unknowns", "elements", "timed_frames", "replayed")}
    found = blank | times | {"problem": nameless("; ".join(problems)), "frames": frames}
    if not frames:
        return found
    errors = {measure: _summed([f["errors"][measure] for f in frames]) for measure in frames[0]["errors"]}
    for measure, part_of in errors.items():
        part_of["uncertainty"] = truth.uncertainty.get(measure, 0.0)
        parts = [f["parts"][measure] for f in frames if "parts" in f]
        part_of["solver"] = max((p["reuse"] + p["algebraic"] for p in parts), default=0.0)
    main = next(iter(errors))
    quantities = {q: _quantity(frames, truth, q) for q in frames[0]["quantities"]}
    chosen = errors[main] if of == "field" else quantities.get(of)
    parts = _parts(frames, main, of, truth)
    return found | {
        "error": chosen and chosen["worst"],
        "error_median": chosen and chosen["median"],
        "uncertainty": chosen and chosen["uncertainty"],
        "below_reference": bool(chosen and chosen["worst"] is not None and chosen["worst"] <= chosen["uncertainty"]),
        "measure": main if of == "field" else f"q_{of}",
        "errors": errors,
        "quantities": quantities,
        "parts": parts,
        "reuse_holds": parts["reuse"] <= setting.tolerance if parts else None,
        "effectivity": effectivity(frames, "energy" if main == "motion" else main),
    }


def _blank(name: str, scene: Scene, setting: Setting) -> Row:
    """The record of a point of which nothing has been measured; arguments as in `record`."""
    head = {
        "scene": name,
        "name": setting.name,
        "size": setting.factor * scene.mesh.size,
        "size_factor": setting.factor,
        "order": setting.order,
        "policy": setting.policy,
        "tolerance": setting.tolerance,
        "varied": setting.varied,
        "given": setting.given,
        "overrides": list(setting.overrides),
    }
    unknown = ("error", "error_median", "parts", "reuse_holds", "frame_ms", "total_s", "unknowns", "elements")
    unknown += ("uncertainty", "effectivity")
    nothing = {"errors": {}, "quantities": {}, "frames": [], "below_reference": False, "pareto": False, "problem": ""}
    return head | dict.fromkeys(unknown) | nothing


def nameless(text: str) -> str:
    """A message without folders, which mean something on one machine only."""
    return re.sub(r"(?<![\w.])/(?:[\w.+-]+/)+", "", text)


def without(refused: dict[str, str], what: str) -> list[str]:
    """What is said of frames without something, in one line; nothing where there are none."""
    if not refused:
        return []
    first = next(iter(refused))
    return [
        f"{counted(len(refused), 'frame')} without {what}, the first one is {first}: {refused[first].splitlines()[0]}"
    ]


def _summed(values: list[float]) -> Row:
    """The worst and the median over frames; None where a frame has no number."""
    known = [value for value in values if np.isfinite(value)]
    return {"worst": max(known), "median": median(known)} if known else {"worst": None, "median": None}


def _quantity(frames: list[Row], truth: Truth, name: str) -> Row:
    """Errors of a quantity, with what the reference itself does not know of it."""
    errors = [truth.error(name, str(frame["index"]), frame["quantities"][name]) for frame in frames]
    parts = [frame["quantity_parts"][name] for frame in frames if name in frame.get("quantity_parts", {})]
    solver = max((abs(p["reuse"]) + abs(p["algebraic"]) for p in parts), default=0.0)
    found = _summed(errors) | {"uncertainty": truth.doubt(name), "solver": solver / (truth.scale(name) or 1.0)}
    if name in truth.exact and frames[0]["index"] == 0:
        found |= {"exact": truth.exact[name], "first": errors[0]}
    return found


def _parts(frames: list[Row], main: str, of: str, truth: Truth) -> dict[str, float] | None:
    """The worst of each part of the error over the frames; None where a frame's parts are not known."""
    if any("parts" not in frame for frame in frames):
        return None
    if of == "field":
        return {part: max(frame["parts"][main][part] for frame in frames) for part in PARTS}
    scale = truth.scale(of) or 1.0
    part_of = [frame["quantity_parts"].get(of) for frame in frames]
    if any(parts is None for parts in part_of):
        return None
    return {part: max(abs(parts[part]) for parts in part_of) / scale for part in PARTS}


def effectivity(frames: list[Row], main: str) -> Mapping[str, Any] | None:
    """Estimate over true error of the field: least, median and largest over the frames; None without estimates."""
    known = [f["estimate"] / f["errors"][main] for f in frames if f.get("estimate") is not None and f["errors"][main]]
    if not known:
        return None
    within = all(BOUNDS[0] <= value <= BOUNDS[1] for value in known)
    return {"measure": main, "least": min(known), "median": median(known), "largest": max(known), "within": within}
