"""Scenes that are installed, by their names, and edit scripts that come with a scene."""

from collections.abc import Sequence
from pathlib import Path

from restshape.cli.list import scene_of
from restshape.errors import UserError


def named_scenes(words: Sequence[Path], installed: Sequence[Path]) -> list[Path]:
    """Scene files: those named by their path, and installed ones named `plate`, or `solid/plate`.

    Args:
        words: as on the command line; what names neither stays as it is.
        installed: scene files `.../APP/scenes/NAME.toml`.

    Raises:
        UserError: several installed scenes have such a name.
    """
    return [_named_scene(word, installed) for word in words]


def _named_scene(word: Path, installed: Sequence[Path]) -> Path:
    if word.is_file():
        return word
    known = {path: f"{path.parents[1].name}/{path.stem}" for path in installed}
    found = [path for path, name in known.items() if str(word) in (name, path.stem)]
    if len(found) > 1:
        names = ", ".join(known[path] for path in found)
        raise UserError(f"{len(found)} installed scenes have this name", str(word), f"name one of {names}")
    return found[0] if found else word


def script_of(scene: Path) -> Path | None:
    """The edit script in `../edits`, or beside it, whose header names the scene; of several the scene's namesake."""
    return next(iter(scripts_of(scene)), None)


def scripts_of(scene: Path) -> list[Path]:
    """All such scripts, the scene's namesake first."""
    folders = (scene.parent.parent / "edits", scene.parent)
    found = [path for folder in folders for path in sorted(folder.glob("*.jsonl")) if scene_of(path) == scene.name]
    return sorted(found, key=lambda path: path.stem != scene.stem)


def refuse_shared_script(scenes: Sequence[Path], edits: Path | None) -> None:
    """Makes sure that a script is named for one scene alone, and that all words that name scenes do.

    Raises:
        UserError: a scene is not there, as a number behind a list without commas; or a script is for several.
    """
    missing = next((path for path in scenes if not path.exists()), None)
    if missing:
        number = str(missing).replace(".", "", 1).isdigit()
        do = "write the numbers of an option with commas between and no space: 1,2,4" if number else "check the path"
        raise UserError("there is no such scene", str(missing), do)
    if edits and len(scenes) > 1:
        raise UserError("a script belongs to one scene", "--edits", "name one scene")
