"""What -vv logs of a relaxation agrees with itself and with the frame's row."""

import csv
import re
from pathlib import Path

import pytest

STRIP = Path(__file__).parents[1] / "scenes/strip.toml"


@pytest.mark.slow
def test_a_relaxation_logs_its_strategy_and_why_it_ends(tmp_path, restshape):
    rows = tmp_path / "rows.csv"
    done = restshape("replay", STRIP, "--csv", rows, "-vv")
    assert done.returncode == 0, done.stderr
    with rows.open() as file:
        (row,) = csv.DictReader(file)
    assert re.search(r"^physics: Cold start: mesh of \d+ nodes$", done.stderr, re.M)
    damped = re.search(
        r"^physics: TS fall .*: (\d+) steps, \d+ matrices, (\d+) kinetic-energy peaks", done.stderr, re.M
    )
    monitored = re.findall(r"^algebra: +(\d+) TS dt \S+ Function norm", done.stderr, re.M)
    assert len(monitored) == int(damped[1]) + 1
    assert len(re.findall("TS kinetic-energy peak", done.stderr)) == int(damped[2]) > 0
    (refined,) = re.findall(r"^physics: Newton refinement converged: (\d+) iterations$", done.stderr, re.M)
    (ended,) = re.findall(r"^physics: Relaxation converged: (\d+) steps", done.stderr, re.M)
    assert int(refined) < int(ended) and row["converged"] == row["tangent_positive_definite"] == "1"
