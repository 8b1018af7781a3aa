"""Edit scripts that come with a scene."""

from pathlib import Path

from restshape.cli.list import scene_of


def script_of(scene: Path) -> Path | None:
    """The edit script in `../edits`, or beside it, whose header names the scene; of several the scene's namesake."""
    folders = (scene.parent.parent / "edits", scene.parent)
    found = [path for folder in folders for path in sorted(folder.glob("*.jsonl")) if scene_of(path) == scene.name]
    return next((path for path in found if path.stem == scene.stem), found[0] if found else None)
