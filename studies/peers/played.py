"""A case played by restshape, in a process of its own: what peers are handed, answers and times.

python -m restshape_studies.peers.played CASE FRAMES FOLDER
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from restshape_studies.bench.process import pin
from restshape_studies.peers.cases import CASES, PeerCase

import restshape
from restshape import Run
from restshape.application import application
from restshape.scene.load import load_scene
from restshape.surroundings import start_petsc

if TYPE_CHECKING:
    from restshape.replay.loop import Replay

PLAIN = ("solve.jumps=false",)


def scene_path(name: str) -> Path:
    """The scene of an installed application, such as ``app/scene``."""
    app, _, scene = name.partition("/")
    return application(app).folder / "scenes" / f"{scene}.toml"


def run_of(case: PeerCase, frames: int) -> Run:
    """The frames of a case, without estimates of errors."""
    scene = load_scene(scene_path(case.scene), (*PLAIN, *case.overrides))
    script = restshape.new_script(scene, case.events(max(frames, 1)))
    return restshape.replay(scene, script, case.policy, measured="residual")


class Handing:
    """Collects what peers are handed, and restshape's answers.

    Args:
        case: that is played.
    """

    def __init__(self, case: PeerCase) -> None:
        self.case = case
        self.arrays: dict[str, np.ndarray] = {}
        self.answers: dict[str, np.ndarray] = {}
        self.mesh_of: list[int] = []
        self.edges: list[str] = []
        self._cells: np.ndarray | None = None

    def take(self, replay: Replay, row: dict[str, Any]) -> None:
        """A frame's mesh and answer."""
        mesh, frame = replay.moving.mesh, len(self.mesh_of)
        self.arrays[f"places_{frame}"] = np.array(mesh.X)
        if self._cells is None or not np.array_equal(self._cells, mesh.cells):
            number = self.mesh_of[-1] + 1 if self.mesh_of else 0
            self._cells = np.array(mesh.cells)
            self.arrays[f"cells_{number}"] = self._cells
            sides = mesh.facets
            self.edges = [edge.name for edge in mesh.outline.edges]
            for k, name in enumerate(self.edges):
                self.arrays[f"facets_{number}_{name}"] = sides[mesh.facet_edge == k]
            self.mesh_of.append(number)
        else:
            self.mesh_of.append(self.mesh_of[-1])
        self.answers[f"answer_{frame}"] = self._answer(replay, row)

    def _answer(self, replay: Replay, row: dict[str, Any]) -> np.ndarray:
        if self.case.answer == "frequencies":
            return np.array(replay.analysis.state.frequencies)
        at_nodes, _ = replay.analysis.fields()
        return np.array(at_nodes[self.case.answer])

    def write(self, folder: Path) -> None:
        """Writes what peers read, and beside it the answers, which they do not."""
        case = {"problem": self.case.problem, "parameters": self.case.parameters}
        (folder / "case.json").write_text(json.dumps(case | {"mesh_of": self.mesh_of, "edges": self.edges}))
        np.savez(folder / "arrays.npz", **self.arrays)
        np.savez(folder / "restshape.npz", **self.answers)


def play(case: PeerCase, frames: int, folder: Path) -> dict[str, Any]:
    """Plays a case: seconds of each frame, of the clock and of the processor, its level, and sizes.

    Args:
        case: to play; frames: of the edit, 0 for the first shape alone; folder: that arrays are written into.
    """
    run = run_of(case, frames)
    handing, rows = Handing(case), run.rows()
    sizes: dict[str, int] = {}
    found: dict[str, Any] = {"seconds": [], "processor": [], "levels": []}
    while True:
        clock, used = time.perf_counter(), time.process_time()
        row = next(rows, None)
        if row is None:
            break
        found["seconds"].append(time.perf_counter() - clock)
        found["processor"].append(time.process_time() - used)
        found["levels"].append(int(row["level"]))
        handing.take(run.replay, row)
        sizes = {key: int(row[key]) for key in ("elements", "unknowns")}
        if not frames:
            break
    handing.write(folder)
    return found | sizes | {"version": restshape.__version__}


def main(name: str, frames: str, folder: str) -> int:
    """Play the case, and write ``times.json`` beside the arrays."""
    pin()
    start_petsc(())
    found = play(CASES[name], int(frames), Path(folder))
    (Path(folder) / "times.json").write_text(json.dumps(found))
    return 0


if __name__ == "__main__":
    raise SystemExit(main(*sys.argv[1:]))
