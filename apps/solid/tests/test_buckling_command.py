"""`restshape buckling`: its load factors for programs."""

import json

import pytest

from restshape.application import application
from restshape.cli.main import main

COLUMN = application("solid").folder / "scenes" / "column.toml"


def test_load_factors_are_those_of_euler(tmp_path, capsys):
    """P = E I (4.493409 / L)^2 of a column clamped at one end and guided at the other, over its load of 40 kN."""
    found = tmp_path / "a.json"
    assert main(["buckling", str(COLUMN), "--json", str(found)]) == 0
    euler = 210e9 * 0.02 * 0.05**3 / 12.0 * 4.493409**2 / 40e3
    written = json.loads(found.read_text())
    assert written["load_factors"][0] == pytest.approx(euler, rel=0.02) and written["inertia_checked"]
    shown = [line.split() for line in capsys.readouterr().out.splitlines() if line]
    rows = [[str(mode), f"{factor:.6g}"] for mode, factor in enumerate(written["load_factors"], 1)]
    assert shown == [["mode", "load", "factor"], *rows]
