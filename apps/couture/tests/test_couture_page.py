"""The page on cloth shows commands that run, and numbers that they print."""

import json
import re
import shlex
from pathlib import Path

import pytest

from restshape.cli.main import main

ROOT = Path(__file__).parents[3]
PAGE = (ROOT / "docs" / "couture.md").read_text(encoding="utf-8")
STRIP = ROOT / "apps" / "couture" / "scenes" / "strip.toml"


@pytest.mark.slow
def test_the_napkin(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    block = PAGE.split("```sh\n")[1].split("```")[0]
    lines = [line.split("#")[0].strip() for line in block.splitlines()]
    calls = [shlex.split(line) for line in lines if line.startswith("restshape ")]
    assert [call[1] for call in calls] == ["new", "check", "replay", "report", "drapes", "bench"]
    for call in calls[:3]:
        assert main([*call[1:], *(["--json", "napkin.json"] if call[1] == "replay" else [])]) == 0
    assert main([*calls[3][1:], "--animation", "none"]) == 0
    found = json.loads(Path("napkin.json").read_text())
    assert found["frames"] == int(re.search(r"has (\d+) frames", PAGE)[1])
    lowest = found["quantities"]["lowest"]
    reported = [float(value) for value in re.search(r"corner at (\d+) mm .*?and about (\d+) mm", PAGE, re.S).groups()]
    # Where folds go hangs on the machine's rounding.
    assert [-1e3 * lowest[0], -1e3 * lowest[-1]] == pytest.approx(reported, rel=0.03)
    (drawn,) = (shlex.split(line) for line in lines if line.startswith("restshape drapes"))
    assert main(drawn[1:]) == 0 and Path("napkin.png").stat().st_size > 10_000


@pytest.mark.slow
def test_the_strip(tmp_path):
    rows = re.findall(r"^\| `(\w+)` \| (\d+) \| (-[\d.]+) \|$", PAGE, re.M)
    assert [kind for kind, *_ in rows] == ["morley", "hinge", "nonlinear"]
    for kind, unknowns, tip in rows:
        out = tmp_path / f"{kind}.json"
        assert main(["replay", str(STRIP), "--set", f"effects.cloth.bending={kind}", "--json", str(out)]) == 0
        found = json.loads(out.read_text())
        assert found["unknowns"] == int(unknowns)
        assert 1e3 * found["quantities"]["tip_down"][0] == pytest.approx(float(tip), abs=0.006)
    exact = float(re.search(r"hangs by ([\d.]+) mm", PAGE)[1])
    # The heavy elastica at Gamma = 8, by its ordinary differential equation.
    assert exact == pytest.approx(0.640631 * 50, abs=0.005)
