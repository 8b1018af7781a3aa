"""OBJ files: corners and faces alone, for meshio refuses files with other numbers of normals or texture coordinates."""

from __future__ import annotations

import io
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import meshio


def read_wavefront(path: Path) -> meshio.Mesh:
    """What meshio reads from an OBJ file without its normals, texture coordinates and colours.

    Raises:
        Exception: whatever meshio has to say about it; a face counts its corners backwards.
    """
    from meshio.obj._obj import read_buffer

    with path.open(encoding="utf-8", errors="replace") as lines:
        return read_buffer(io.StringIO("".join(_plain(lines))))


def _plain(lines: Iterator[str]) -> Iterator[str]:
    """The lines of corners, by three numbers, and of faces."""
    for number, line in enumerate(lines, start=1):
        words = line.split()
        if words[:1] == ["v"]:
            yield f"{' '.join(words[:4])}\n"
        elif words[:1] == ["f"]:
            if any(word.startswith("-") for word in words[1:]):
                raise ValueError(f"line {number} counts corners backwards")
            yield line if line.endswith("\n") else f"{line}\n"
