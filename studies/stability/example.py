"""An example of a fuzz: a scene and edits as text, and how they are replayed."""

import json
from dataclasses import asdict, dataclass
from pathlib import Path

MOST_ELEMENTS = 200
"""Of a scene's first mesh."""
SCENE, EDITS = "scene.toml", "edits.jsonl"
RECORDING, TABLE, SUMMARY = "frames.vtkhdf", "frames.csv", "summary.json"


@dataclass(frozen=True)
class Example:
    """A scene and edits as text, and how they are replayed.

    Args:
        app: application that the scene was made for.
        scene, edits: texts of the two files.
        policy, predict: as after --policy and --predict.
        damaged: what was done to the files; empty where they are as they were made.
        written: the command replays them too, and writes all that it can.
    """

    app: str
    scene: str
    edits: str
    policy: str
    predict: str
    damaged: str = ""
    written: bool = False

    def write(self, folder: Path) -> None:
        """Write the two files and what else a replay wants to know into a folder."""
        (folder / SCENE).write_text(self.scene, encoding="utf-8", errors="surrogatepass")
        (folder / EDITS).write_text(self.edits, encoding="utf-8", errors="surrogatepass")
        (folder / "example.json").write_text(json.dumps(asdict(self)) + "\n")

    @property
    def words(self) -> list[str]:
        """The words after `restshape` that replay the files."""
        written = ["--out", RECORDING, "--csv", TABLE, "--json", SUMMARY] if self.written else []
        return ["replay", SCENE, "--edits", EDITS, "--policy", self.policy, "--predict", self.predict, *written]

    @property
    def command(self) -> str:
        """The command that replays the files."""
        return " ".join(["restshape", *self.words])
