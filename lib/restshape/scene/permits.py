"""Which files a scene may name, and whether gmsh may run the scripts among them: what the user has said about it.

It is kept in the environment, for the processes that a command starts are bound by it, too.
"""

import os
from pathlib import Path

from restshape.application import applications
from restshape.errors import quoted

FOLDERS = "RESTSHAPE_ALLOW_PATH"
"""Folders, separated as those of PATH are, whose files scenes may name."""
MESHES = "meshes"
SCRIPTS = "RESTSHAPE_TRUST_GEO"
"""1 where gmsh runs .geo files as the scripts that they are."""


def allow(folder: Path) -> None:
    """From now on scenes may name the files in this folder and below it."""
    os.environ[FOLDERS] = os.pathsep.join(filter(None, (os.environ.get(FOLDERS), str(folder.resolve()))))


def trust_scripts() -> None:
    """From now on gmsh runs .geo files as scripts."""
    os.environ[SCRIPTS] = "1"


def scripts_trusted() -> bool:
    """Whether gmsh may run .geo files as scripts."""
    return os.environ.get(SCRIPTS) == "1"


def may_name(file: Path, folder: Path) -> bool:
    """Whether a scene in a folder may name a file: it lies there or below, or in a folder that the user allows.

    Scenes of installed applications may name what ships with their application, and the meshes beside all of them, too.
    Links are followed first, so what counts is where the file really lies.
    """
    homes = [folder.resolve(), *map(Path, filter(None, os.environ.get(FOLDERS, "").split(os.pathsep)))]
    homes += _shipped(folder.resolve())
    return any(file.resolve().is_relative_to(home) for home in homes)


def outside(file: str, folder: Path) -> tuple[str, str] | None:
    """What is wrong with a file that a scene in a folder may not name, and what to do; None where it may."""
    if "\0" in file:
        return f"{quoted(file)} is no name of a file: it holds a null character", "write the name of a file"
    path = folder / file
    if may_name(path, folder):
        return None
    link = " through a link" if Path(os.path.abspath(path)).is_relative_to(folder.absolute()) else ""
    what = f"the file {file!r} lies outside of the scene's folder{link}"
    return what, f"put it beside the scene, or allow its folder: --allow-path {path.resolve().parent}"


def _shipped(folder: Path) -> list[Path]:
    """The application that a scene's folder belongs to, and the folder of meshes beside it; none of other scenes."""
    homes = {known.folder.resolve() for known in applications().values()}
    return [place for home in homes if folder.is_relative_to(home) for place in (home, home.parent.parent / MESHES)]
