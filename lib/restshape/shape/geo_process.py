"""A whole .geo script run by gmsh, in a process of its own: ``python -m restshape.shape.geo_process FILE OUT``."""

import dataclasses
import json
import os
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from restshape.errors import UserError
from restshape.shape.geo_model import gmsh_model, opened_by_gmsh
from restshape.shape.unordered_curves import Curve

LIMIT = 60.0
"""Seconds that a script may run."""


def curves_apart(path: Path) -> list[Curve]:
    """The curves that a script of gmsh's draws, which may run any command while it does.

    Raises:
        UserError: it fails, ends early, or runs too long.
    """
    with tempfile.TemporaryDirectory(prefix="restshape-") as folder:
        out = Path(folder) / "curves.json"
        command = [sys.executable, "-P", "-m", "restshape.shape.geo_process", str(path.resolve()), str(out)]
        with subprocess.Popen(command, stdout=subprocess.DEVNULL, start_new_session=True) as process:
            try:
                process.wait(LIMIT)
            except BaseException as error:
                os.killpg(process.pid, signal.SIGKILL)
                if not isinstance(error, subprocess.TimeoutExpired):
                    raise
                what, do = f"gmsh has not ended after {LIMIT:g} s", "look for a loop without end"
                raise UserError(what, path.name, do) from None
        result = json.loads(out.read_text()) if out.is_file() else {}
    if "error" in result:
        raise UserError(*result["error"])
    if "curves" not in result:
        what = f"gmsh ended with code {process.returncode} before it was done"
        raise UserError(what, path.name, "take Exit out of it")
    return [Curve(**{**curve, "points": np.array(curve["points"])}) for curve in result["curves"]]


def main() -> int:
    """Run the script named first, and write its curves, or what is wrong, into the file named second."""
    path, out = map(Path, sys.argv[1:])
    try:
        with gmsh_model(path) as gmsh:
            curves = opened_by_gmsh(gmsh, path)
    except UserError as error:
        result: dict[str, object] = {"error": [error.what, error.where, error.do]}
    else:
        result = {"curves": [{**dataclasses.asdict(curve), "points": curve.points.tolist()} for curve in curves]}
    out.write_text(json.dumps(result))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
