"""What commands do not import on the way to their first result: each of these takes longer than the result itself."""

import subprocess
import sys
from pathlib import Path

import pytest

BRACKET = Path(__file__).resolve().parents[2] / "docs" / "examples" / "bracket.toml"
UNNEEDED = ("scipy", "gmsh", "meshio", "rich.progress", "matplotlib", "numpy.typing", "h5py", "ezdxf")


@pytest.fixture
def imported(outside, tmp_path):
    """The modules that a command has imported at its end, in a process of its own."""

    def imported(*words):
        program = "import sys\nfrom restshape.cli.main import main\ncode = main(sys.argv[1:])\n"
        program += "print('modules', *sys.modules)\nsys.exit(code)"
        command = [sys.executable, "-c", program, *map(str, words)]
        done = subprocess.run(command, env=outside, cwd=tmp_path, capture_output=True, text=True, timeout=60)
        assert done.returncode == 0, done.stderr
        return set(done.stdout.splitlines()[-1].split())

    return imported


def test_the_first_frame_of_the_bracket_needs_no_large_library(imported):
    modules = imported("replay", BRACKET)
    assert "restshape.analysis.steady" in modules
    assert not modules.intersection(UNNEEDED)
    # Analyses that the scene does not call for.
    assert not {name for name in modules if name.endswith((".buckling", ".transient", ".nonlinear"))}
