"""The live page: its types hold, and what it computes of messages, colours and places under the pointer is right."""

from __future__ import annotations

import base64
import json
import os
import shutil
import subprocess
from pathlib import Path

import matplotlib
import numpy as np
import pytest

from restshape.live.frame_message import FrameEncoder, PicturePart
from restshape.report.style import COLOURS, SIGNED

ROOT = Path(__file__).parents[2]
TOOLS = ROOT / "node_modules" / ".bin"


@pytest.fixture(scope="module", autouse=True)
def _node() -> None:
    if not (TOOLS / "esbuild").exists() or shutil.which("node") is None:
        pytest.skip("node and esbuild are not here: make setup installs what the page is built with")


def colours(name: str) -> list[list[int]]:
    """The colours of a map of matplotlib, RGB bytes."""
    return [[int(part) for part in matplotlib.colormaps[name](i, bytes=True)[:3]] for i in range(256)]


def message() -> bytes:
    """A frame with a triangle."""
    arrays = {"points": np.array([[0, 0, 0], [1, 0, 0], [0, 2, 0]], dtype="<f4"), "cells": np.array([[0, 1, 2]])}
    header = {"type": "frame", "number": 0, "id": 0, "columns": {}, "errors": {}, "limits": {}, "held": None}
    return b"".join(
        bytes(piece) for piece in FrameEncoder()(header, [PicturePart("shape", "surface", "shape", arrays)])
    )


@pytest.mark.parametrize("name", ["drawing", "software"])
def test_pure_functions_of_drawing_and_hand(tmp_path: Path, name: str) -> None:
    bundle, known = tmp_path / f"{name}.test.mjs", tmp_path / "known.json"
    wanted = {"viridis": colours(COLOURS), "RdBu": colours(SIGNED), "message": base64.b64encode(message()).decode()}
    known.write_text(json.dumps(wanted), encoding="utf-8")
    source = Path(__file__).parent / "page" / f"{name}.test.ts"
    how = ["--bundle", "--platform=node", "--format=esm", "--log-level=warning", f"--outfile={bundle}"]
    subprocess.run([TOOLS / "esbuild", source, *how], check=True, cwd=ROOT)
    environment = {**os.environ, "PAGE_KNOWN": str(known)}
    done = subprocess.run(["node", "--test", bundle], capture_output=True, text=True, check=False, env=environment)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_types_of_the_page_hold() -> None:
    done = subprocess.run(
        [TOOLS / "tsc", "-p", "lib/restshape/live/page"], capture_output=True, text=True, check=False, cwd=ROOT
    )
    assert done.returncode == 0, done.stdout
