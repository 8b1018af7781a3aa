"""The bridge study with one scripted designer: what is known of the same edits, analysed in every frame or on demand.

Both scripts start from the same scene and hold the same edits at the same times; they differ in when the analysis runs.
That is an illustration of figure 4.14 of the thesis, which shows what six people did; it proves nothing about people.
"""

import argparse
from dataclasses import dataclass
from typing import Any

import numpy as np

from restshape.application import application
from restshape.cli.options import add_json, write_json
from restshape.errors import one_line
from restshape.interface.replays import replay_files
from restshape.outputs.kinds import PictureFile
from restshape.replay.constraints import FAILS, HOLDS, UNCERTAIN
from restshape.scene.load import load_scene

FOLDER = application("bridge").folder
SCENE = FOLDER / "scenes" / "bridge.toml"
WAYS = {"every frame": FOLDER / "edits" / "bridge.jsonl", "on demand": FOLDER / "edits" / "bridge-on-demand.jsonl"}


@dataclass
class SessionCourse:
    """What one way of analysing reports, by frames.

    Args:
        t: (n,) edit time [s].
        score: (n,) area [m^2], always known.
        stress: (n,) largest von Mises stress [Pa]; not a number where it is not known.
        holds: (n,) whether the design is known to hold.
        uncertain: (n,) whether its stress is nearer to the limit than it is known.
        fails: (n,) whether it is known to fail.
        analysed: frames that were solved; in the others nothing had changed, or nobody asked.
        milliseconds: that the frames took, the first left out.
    """

    t: np.ndarray
    score: np.ndarray
    stress: np.ndarray
    holds: np.ndarray
    uncertain: np.ndarray
    fails: np.ndarray
    analysed: int
    milliseconds: float

    @property
    def best(self) -> np.ndarray:
        """The smallest area (n,) [m^2] that is known to hold so far."""
        return np.minimum.accumulate(np.where(self.holds, self.score, np.inf))


def study() -> dict[str, SessionCourse]:
    """Both ways by name."""
    return {name: followed(replay_files(SCENE, edits, "auto")["rows"]) for name, edits in WAYS.items()}


def followed(rows: list[dict]) -> SessionCourse:
    """What the rows of a replay report."""
    t, score, stress = (np.array([row[key] for row in rows]) for key in ("t", "q_score", "q_strength"))
    statuses = np.array([row["constraint_status"] for row in rows])
    solved = sum(row["iterations"] > 0 for row in rows)
    taken = float(sum(row["ms"] for row in rows[1:]))
    holds, uncertain, fails = (statuses == status for status in (HOLDS, UNCERTAIN, FAILS))
    return SessionCourse(t, score, stress, holds, uncertain, fails, solved, taken)


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument("--picture", type=PictureFile, metavar="FILE", help="score against edit time (.png)")
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    """Print what each way finds, and draw it; 0."""
    ways = study()
    print("illustration with one scripted designer, after figure 4.14 of the thesis; not a user study")
    for name, way in ways.items():
        found = f"{way.holds.sum()} known to hold, {way.fails.sum()} to fail, {way.uncertain.sum()} uncertain"
        print(
            f"analysis {name}: smallest area known to hold {way.best[-1]:.2f} m^2; {way.analysed} of {len(way.t)} "
            f"frames solved, {found}"
        )
    if args.picture:
        from restshape_studies.pictures.score import draw_score

        draw_score(args.picture, ways, load_scene(SCENE).quantities["strength"].max)
        print(f"wrote {one_line(args.picture)}")
    write_json(args, {name: _plain(way) for name, way in ways.items()})
    return 0


def _plain(way: SessionCourse) -> dict[str, Any]:
    """What one way reports, for programs: lists by frames, null where nothing is known."""
    known = {name: getattr(way, name).tolist() for name in ("t", "score", "holds", "uncertain", "fails")}
    unsure = {name: [float(x) if np.isfinite(x) else None for x in getattr(way, name)] for name in ("stress", "best")}
    return {**known, **unsure, "analysed": way.analysed, "ms": way.milliseconds}
