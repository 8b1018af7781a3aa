"""The stubs say what the modules that are built take and give, and which elements are compiled."""

import subprocess
import sys
from pathlib import Path

import pybind11
import pytest

ROOT = Path(__file__).parents[1]


@pytest.mark.cli
@pytest.mark.skipif(pybind11.version_info < (3,), reason="older versions write other types into their signatures")
def test_stubs_are_those_of_the_built_modules():
    command = [sys.executable, "scripts/stubs.py", "--check"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
