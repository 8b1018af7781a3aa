"""The panels of the live page: how numbers are written, forms made of schemas, plots and tones drawn up."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from pathlib import Path

import pytest

from restshape.cli.schema import script_schema

ROOT = Path(__file__).parents[2]
ESBUILD = ROOT / "node_modules" / ".bin" / "esbuild"


def test_pure_functions_of_the_panels(tmp_path: Path) -> None:
    if not ESBUILD.exists() or shutil.which("node") is None:
        pytest.skip("node and esbuild are not here: make setup installs what the page is built with")
    bundle = tmp_path / "panels.test.mjs"
    source = Path(__file__).parent / "page" / "panels.test.ts"
    how = ["--bundle", "--platform=node", "--format=esm", "--log-level=warning", f"--outfile={bundle}"]
    schema = tmp_path / "schema.json"
    schema.write_text(json.dumps(script_schema()), encoding="utf-8")
    subprocess.run([ESBUILD, source, *how], check=True, cwd=ROOT)
    known = {**os.environ, "SCRIPT_SCHEMA": str(schema)}
    done = subprocess.run(["node", "--test", bundle], capture_output=True, text=True, check=False, env=known)
    assert done.returncode == 0, done.stdout + done.stderr
