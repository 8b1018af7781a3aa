"""What each rank has whole, as it has the mesh whole: bytes of mesh and map, beside those that ranks share.

python scripts/whole_mesh.py [UNKNOWNS ...]

Without numbers: 200,000 and 1,000,000 unknowns of `plate.toml`, whose hole is dragged for three frames, on one rank.
Counted are arrays, not what C++ has besides. Matrix and preconditioner go with the ranks, about: where what is whole
takes as much on a rank as its part of them, is said at last.
"""

import sys
from collections.abc import Mapping
from itertools import islice
from math import sqrt
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from restshape_apps.solid import application
from restshape_studies.bench.large import CASES
from restshape_studies.bench.order import sizes
from restshape_studies.bench.rank_process import own_work
from restshape_studies.bench.size import write_script

from restshape.cli.options import print_table
from restshape.interface.run import Run
from restshape.replay.request import Request
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene

SCENE = application.folder / "scenes" / "plate.toml"
UNKNOWNS, FRAMES = 1950.0, 4
"""Of the scene as it is, about; the first frame, the press and two of the drag."""
HEADS = ("unknowns", "mesh, map, places [MB]", "bytes an unknown", "matrix, preconditioner [MB]", "equal on")


def array_bytes(root: object) -> int:
    """Bytes of all arrays that restshape's objects below one have, each once."""
    found, seen, left = dict[int, int](), set[int](), [root]
    while left:
        one: Any = left.pop()
        if id(one) in seen:
            continue
        seen.add(id(one))
        if isinstance(one, np.ndarray):
            while isinstance(one.base, np.ndarray):
                one = one.base
            found[id(one)] = one.nbytes
        elif isinstance(one, Mapping):
            left += one.values()
        elif isinstance(one, list | tuple | set):
            left += one
        elif type(one).__module__.startswith("restshape"):
            left += getattr(one, "__dict__", {}).values()
    return sum(found.values())


def row_of(unknowns: float, folder: Path) -> tuple[str, ...]:
    """The row of a mesh with about so many unknowns."""
    script = folder / "drag.jsonl"
    write_script(script, CASES["plane"].events())
    scene = load_scene(SCENE, ("solve.jumps=false",))
    scene = load_scene(SCENE, ("solve.jumps=false", *sizes(scene, sqrt(UNKNOWNS / unknowns))))
    run = Run(Request.of(scene, load_script(script, scene), "auto", None), summed=False)
    count = [row["unknowns"] for row in islice(run.rows(), FRAMES)][-1]
    whole, work = array_bytes(run.replay.moving), own_work(run.replay)
    shared = work["matrix"] + work["preconditioner"]
    ranks = f"{shared / whole:.1f} ranks"
    return f"{count:,}", f"{1e-6 * whole:.1f}", f"{whole / count:.0f}", f"{1e-6 * shared:.0f}", ranks


def main() -> None:
    """Print the table."""
    with TemporaryDirectory() as folder:
        rows = [row_of(float(number), Path(folder)) for number in sys.argv[1:] or ("2e5", "1e6")]
    print_table("what is whole on each rank", HEADS, rows, right=HEADS[1:])


if __name__ == "__main__":
    main()
