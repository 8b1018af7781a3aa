"""An example of a fuzz: a scene and edits as text, and how they are replayed."""

import base64
import json
from dataclasses import asdict, dataclass, field
from pathlib import Path

MOST_ELEMENTS = 200
"""Of a scene's first mesh."""
SCENE, EDITS = "scene.toml", "edits.jsonl"
DESCRIBED = "example.json"
"""The whole example."""
RECORDED = "damaged.vtkhdf"
"""A recording that was damaged."""
RECORDING, TABLE, SUMMARY = "frames.vtkhdf", "frames.csv", "summary.json"
BYSTANDER, LINK = "notes.txt", "linked.txt"
"""A file that nothing names, and a link to it."""
ONTO = {
    "the scene": ("--csv", SCENE),
    "the scene as a recording": ("--out", SCENE),
    "the edits": ("--json", EDITS),
    "another file": ("--json", BYSTANDER),
    "another file as a recording": ("--out", BYSTANDER),
    "a link": ("--csv", LINK),
    "a link as a recording": ("--out", LINK),
    "its own other output": ("--csv", "twice", "--json", "twice"),
}
"""Options that would write over a file of the user's, by what it is."""


@dataclass(frozen=True)
class Example:
    """A scene and edits as text, and how they are replayed.

    Args:
        app: application that the scene was made for.
        scene, edits: texts of the two files.
        policy, predict: as after --policy and --predict.
        damaged: what was done to the files; empty where they are as they were made.
        written: the command replays them too, and writes all that it can.
        files: bytes as base64 of other files that the scene names, by their names.
        onto: a file of the user's that the command is asked to write over, one of `ONTO`; none: it is not.
    """

    app: str
    scene: str
    edits: str
    policy: str
    predict: str
    damaged: str = ""
    written: bool = False
    files: dict[str, str] = field(default_factory=dict)
    onto: str = ""

    def write(self, folder: Path) -> None:
        """Write the two files and what else a replay wants to know into a folder."""
        for name, data in self.inputs().items():
            (folder / name).write_bytes(data)
        (folder / DESCRIBED).write_text(json.dumps(asdict(self)) + "\n")

    def inputs(self) -> dict[str, bytes]:
        """What the files hold that are read, by their names."""
        named = {name: base64.b64decode(data) for name, data in self.files.items()}
        return {SCENE: _encoded(self.scene), EDITS: _encoded(self.edits), **named}

    @property
    def words(self) -> list[str]:
        """The words after `restshape` that replay the files."""
        written = ["--out", RECORDING, "--csv", TABLE, "--json", SUMMARY] if self.written else []
        # Whoever watches the example judges how long it takes, by the processor's time.
        ways = ["--policy", self.policy, "--predict", self.predict, "--frame-limit", "none"]
        return ["replay", SCENE, "--edits", EDITS, *ways, *written]

    @property
    def command(self) -> str:
        """The command that replays the files."""
        return " ".join(["restshape", *self.words])


def _encoded(text: str) -> bytes:
    """The bytes of a text, of which some may be none of UTF-8."""
    try:
        return text.encode("utf-8", "surrogateescape")
    except UnicodeEncodeError:
        return text.encode("utf-8", "surrogatepass")
