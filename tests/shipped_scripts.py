"""Every shipped edit script, replayed whole on its scene, how its frames end, and how far its quantities jump.

python tests/shipped_scripts.py           replay all, compare with apps/*/tests/statuses.json; 1 at a difference, and
                                          where a quantity jumps by more than 0.5 % (also: make weekly)
python tests/shipped_scripts.py --write   replay all, write these files
"""

import csv
import json
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Mapping
from pathlib import Path

from restshape.application import applications
from restshape.scene.load import load_scene

ROOT = Path(__file__).parents[1]
TABLE = "tests/statuses.json"
"""Of an application: counts by the name of the script."""
COARSE = {
    "a5": 0.008,
    "b5": 0.008,
    "bar_150": 0.009,
    "bar_200": 0.009,
    "bridge": 0.4,
    "building": 1.7,
    "catenary": 0.04,
    "column": 0.03,
    "csm3": 0.02,
    "d5": 0.008,
    "darts": 0.05,
    "e5": 0.008,
    "f5": 0.008,
    "fish": 0.014,
    "g5": 0.008,
    "longer": 0.04,
    "pins": 0.1,
    "sewn_skirt": 0.05,
    "shirt": 0.075,
    "sphere-drag": 0.09,
    "sphere-longer": 0.09,
    "stool": 0.05,
    "strip": 0.01,
    "supported": 0.4,
    "tabard": 0.05,
}
"""Mesh sizes [m] at which long scripts are replayed every day, where larger than those of their scenes, at which
`make weekly` replays them.

At both sizes their frames end alike.
"""
WEEKLY = {"growing", "shirt", "stool", "fish-rests", "building", "bridge", "sphere-longer"}
"""Scripts that make weekly alone replays: they take longest, and others of their kind are replayed every day."""
JUMP = 0.005
"""Share of its largest value by which a quantity may jump where the mesh changes, at the scenes' own meshes."""
Counts = dict[str, int]


def shipped_scripts() -> list[Path]:
    """The edit scripts of all installed applications."""
    scripts = sorted((ROOT / "apps").glob("*/edits/*.jsonl"))
    return [path for path in scripts if application_folder(path).name in applications()]


def application_folder(script: Path) -> Path:
    """The folder of the application that a script belongs to."""
    return script.parents[1]


def scene_of(script: Path) -> Path:
    """The scene that a script's header names."""
    with script.open(encoding="utf-8") as lines:
        return application_folder(script) / "scenes" / json.loads(next(lines))["scene"]


def daily_size(script: Path) -> float | None:
    """The mesh size [m] at which a script is replayed every day; None: that of its scene."""
    size = COARSE.get(script.stem)
    return size if size and size > load_scene(scene_of(script)).mesh.size else None


def coarser(scene: Path, size: float) -> list[str]:
    """What sets a mesh of a scene to a size [m]: one alone where nested ones lead a cold start, which is as coarse."""
    nested = "levels" in load_scene(scene).effects.get("drape", {})
    return [f"mesh.size={size!r}", *(["mesh.levels=1", "effects.drape.levels=1"] if nested else [])]


def status(row: Mapping[str, str]) -> str:
    """How a frame ends: refused, not converged, or solved; with limits also what they report."""
    if row["refused"]:
        return "refused"
    if row.get("converged") == "0":
        return "not converged"
    return f"solved, {row['constraint_status']}" if row.get("constraint_status") else "solved"


def counted(script: Path, folder: Path, run: Callable[..., int], size: float | None = None) -> Counts:
    """How many frames of a script, replayed whole under the policy auto, end how.

    Args:
        script: one of `shipped_scripts`.
        folder: for the table of its frames.
        run: runs a `restshape` command and gives its exit code.
        size: of the mesh [m]; None: the scene's own.

    Raises:
        AssertionError: the command fails.
    """
    table = folder / f"{script.stem}.csv"
    mesh = [word for one in (coarser(scene_of(script), size) if size else ()) for word in ("--set", one)]
    files = ("--csv", table, "--json", summary_of(script, folder))
    code = run("replay", scene_of(script), "--edits", script, "--policy", "auto", *files, *mesh)
    assert code == 0, f"restshape replay of {script.name} ends with {code}"
    with table.open(newline="", encoding="utf-8") as lines:
        return dict(sorted(Counter(map(status, csv.DictReader(lines))).items()))


def summary_of(script: Path, folder: Path) -> Path:
    """Where `counted` writes the summary of a replay."""
    return folder / f"{script.stem}.json"


def large_jumps(summary: Path) -> dict[str, float]:
    """Shares above `JUMP` by which quantities of a replay jump where the mesh changes, but at singular places."""
    found = json.loads(summary.read_text(encoding="utf-8"))
    shares = {name: one["share"] or 0.0 for name, one in found["jumps"].items() if name not in found["singular"]}
    return {name: share for name, share in shares.items() if share > JUMP}


def expected(script: Path) -> Counts:
    """The counts that are committed; none for a script that has no entry."""
    path = application_folder(script) / TABLE
    return json.loads(path.read_text(encoding="utf-8")).get(script.stem, {}) if path.is_file() else {}


def main(words: list[str]) -> int:
    """Replay all; 1 where a count differs from the committed one, or a jump is large, and nothing is to be written."""
    from restshape.cli.main import main as restshape

    found: dict[Path, dict[str, Counts]] = {}
    differing = 0
    with tempfile.TemporaryDirectory() as folder:
        for script in shipped_scripts():
            counts = counted(script, Path(folder), lambda *command: restshape([*map(str, command)]))
            found.setdefault(application_folder(script) / TABLE, {})[script.stem] = counts
            if counts != expected(script):
                differing += 1
                print(f"{script.relative_to(ROOT)}: {counts}, committed {expected(script)}")
            if jumps := large_jumps(summary_of(script, Path(folder))):
                differing += 1
                print(f"{script.relative_to(ROOT)}: jumps of the mesh {jumps}, of the largest value")
    if "--write" in words:
        for path, table in found.items():
            path.write_text(json.dumps(table, indent=2) + "\n", encoding="utf-8")
        return 0
    return 1 if differing else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
