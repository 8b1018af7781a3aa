"""Newton's iterations from three starts: from nothing, from the last answer, from the predicted one."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from restshape_studies.bench.derivative import LinearisedScene

from restshape.errors import ReplayProblem
from restshape.replay.request import Request
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene

PARTS = (0.01, 0.1, 0.25, 0.5, 1.0)
"""Parts of the drag after which Newton's method is started."""
STARTS = ("cold", "last", "predicted")


def measure(request: Request) -> dict[str, Any]:
    """Newton's iterations after parts of the script's first drag, from each start; None where it finds nothing.

    Args:
        request: of a body of large deformation, with a script that drags, under a policy that factors each matrix.

    Raises:
        UserError: nothing is dragged.

    Returns: parts (of the drag), way [m], and for each start iterations; error of the prediction, relative.
    """
    linearised = LinearisedScene(request)
    goal = linearised.farthest()
    s = linearised.derivative(linearised.Psi)
    found: dict[str, Any] = {"parts": [], "way": [], "error": [], **{name: [] for name in STARTS}}
    for part in PARTS:
        c = part * goal
        if not linearised.lay(np.tensordot(c, linearised.Psi, 1)):
            continue
        predicted = linearised.x + np.tensordot(c, s, 1)
        found["parts"].append(part)
        found["way"].append(float(np.linalg.norm(c)))
        for name, start in zip(STARTS, (np.zeros_like(linearised.x), linearised.x, predicted)):
            found[name].append(_iterations(linearised, start))
        exact = linearised.analysis.x
        found["error"].append(float(np.linalg.norm(predicted - exact) / np.linalg.norm(exact)))
    return found


def _iterations(linearised: LinearisedScene, start: np.ndarray) -> int | None:
    try:
        return int(linearised.solve(start.copy()).newton)
    except ReplayProblem:
        return None


def table_rows(scene: Path, edits: Path, overrides: Sequence[str] = ()) -> list[dict[str, Any]]:
    """Rows of `restshape tables` on figure 5.6 of the thesis: Newton's iterations from three starts.

    Args:
        scene: of a body of large deformation.
        edits: script whose first drag counts.
        overrides: ``key=value`` as after --set.
    """
    read = load_scene(scene, overrides)
    script = load_script(edits, read)
    found = measure(Request.of(read, script, "refactor"))
    words = {
        "cold": "no displacement (A)",
        "last": "the answer before the drag (B)",
        "predicted": "the predicted answer (C)",
    }
    return [
        {
            "table": "figure 5.6",
            "row": f"Newton from {words[name]}",
            "quantity": f"iterations after {100 * part:g} % of a drag",
            "thesis": "fewest from C, drawn without numbers",
            "ours": "no equilibrium found" if found[name][i] is None else found[name][i],
            "unit": "iterations",
            "timing": False,
        }
        for i, part in enumerate(found["parts"])
        for name in STARTS
    ]
