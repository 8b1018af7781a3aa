"""A .geo or STEP file read in a process of its own: ``python -m restshape.shape.drawings.geo_process FILE OUT HOW``.

HOW is run, draw or step.

Neither a script that gmsh runs nor OpenCASCADE can be stopped in any other way, and damaged files may crash them.
"""

import dataclasses
import json
import os
import signal
import subprocess
import sys
import tempfile
from pathlib import Path
from types import ModuleType

import numpy as np

from restshape.bounds import READING_MEMORY
from restshape.errors import UserError
from restshape.memory import bounded_memory
from restshape.shape.drawings.geo_model import curves_of, gmsh_model, opened_by_gmsh
from restshape.shape.drawings.geo_script import draw
from restshape.shape.drawings.loose_curve import Curve, LooseCurves
from restshape.shape.drawings.plane_faces import step_curves

LIMIT = 60.0
"""Seconds that reading may take."""
GRACE = 10
"""Seconds after which it ends by itself."""
REMEDIES = {
    "run": "look for a loop without end",
    "draw": "use fewer or simpler Booleans, or draw the outline without them",
    "step": "export the part, or one of its faces, once more, or as DXF",
}
"""What to do where that is not enough, by how the file is read."""


def found_apart(path: Path, how: str) -> LooseCurves:
    """The curves that a file draws.

    Args:
        path: of the file.
        how: "run": gmsh runs it as the script that it is; "draw": only statements that draw are read; "step": its
            plane faces.

    Raises:
        UserError: it fails, ends early, or runs too long.
    """
    with tempfile.TemporaryDirectory(prefix="restshape-") as folder:
        out = Path(folder) / "curves.json"
        command = [
            sys.executable,
            "-P",
            "-m",
            "restshape.shape.drawings.geo_process",
            str(path.resolve()),
            str(out),
            how,
        ]
        with subprocess.Popen(command, stdout=subprocess.DEVNULL, start_new_session=True) as process:
            try:
                process.wait(LIMIT)
            except BaseException as error:
                os.killpg(process.pid, signal.SIGKILL)
                if not isinstance(error, subprocess.TimeoutExpired):
                    raise
                raise UserError(f"gmsh has not ended after {LIMIT:g} s", path.name, REMEDIES[how]) from None
        result = json.loads(out.read_text()) if out.is_file() else {}
    if "error" in result:
        raise UserError(*result["error"])
    if "curves" not in result:
        what = f"gmsh ended with code {process.returncode} before it was done"
        raise UserError(what, path.name, "take Exit out of it" if how == "run" else REMEDIES[how])
    curves = [Curve(**{**curve, "points": np.array(curve["points"])}) for curve in result["curves"]]
    return LooseCurves(curves, tuple(result["notes"]))


def main() -> int:
    """Read the file named first, and write its curves, or what is wrong, into the file named second."""
    path, out, how = Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3]
    # Whoever started it may have ended since.
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    signal.alarm(int(LIMIT) + GRACE)
    try:
        with gmsh_model(path) as gmsh, bounded_memory(READING_MEMORY):
            found = _found(gmsh, path, how)
    except UserError as error:
        result: dict[str, object] = {"error": [error.what, error.where or path.name, error.do]}
    except MemoryError:
        what = f"reading this drawing would take more than {READING_MEMORY >> 30} GB of memory"
        result = {"error": [what, path.name, REMEDIES[how]]}
    else:
        curves = [{**dataclasses.asdict(curve), "points": curve.points.tolist()} for curve in found.curves]
        result = {"curves": curves, "notes": found.notes}
    out.write_text(json.dumps(result))
    return 0


def _found(gmsh: ModuleType, path: Path, how: str) -> LooseCurves:
    """What the file draws, read in this process."""
    if how == "run":
        return LooseCurves(opened_by_gmsh(gmsh, path))
    if how == "step":
        return step_curves(gmsh, path)
    draw(gmsh, path.read_text(encoding="utf-8-sig"), path.name)
    return LooseCurves(curves_of(gmsh.model, path.name))


if __name__ == "__main__":
    raise SystemExit(main())
