"""Modes on two ranks, which share matrices, search vectors and factor: they are those of one rank."""

import json

import numpy as np
import pytest
from modal import EDITS, SCENES

pytestmark = pytest.mark.mpi

SOLID = ("--set", 'mesh.size="9 mm"', "--set", "mesh.layers=1", "--set", "effects.modal.modes=3")
PLATE = (*SOLID[:2], "--set", "effects.modal.model=plate", "--set", "effects.modal.modes=3")


DAILY = {("auto", "tetrahedra"), ("auto", "plate"), ("thesis", "plate")}
"""Policies and models of every day; the others have their turn each week."""


def played():
    for name in ("auto", "thesis", "refactor"):
        for model, words in (("tetrahedra", SOLID), ("plate", PLATE)):
            marks = [] if (name, model) in DAILY else [pytest.mark.weekly]
            yield pytest.param(name, words, marks=marks, id=f"{name}-{model}")


@pytest.mark.parametrize(("name", "words"), list(played()))
def test_frequencies_are_those_of_one_rank(tmp_path, on_ranks, words, name):
    scene, edits, found = SCENES / "bar_100.toml", EDITS / "bar_100_short.jsonl", []
    for ranks in (1, 2):
        reported = ("--json", f"{ranks}.json", "--csv", f"{ranks}.csv", "--policy", name, "--parity")
        done = on_ranks(ranks, "replay", scene, "--edits", edits, *words, *reported)
        assert done.returncode == 0, done.stdout + done.stderr
        lines = [line.split(",") for line in (tmp_path / f"{ranks}.csv").read_text().splitlines()]
        columns = [lines[0].index(f"f_{k}") for k in (1, 2, 3)]
        found.append(np.array([[float(line[c]) for c in columns] for line in lines[1:]]))
    one, two = (json.loads((tmp_path / f"{ranks}.json").read_text()) for ranks in (1, 2))
    assert (one["ranks"], two["ranks"]) == (1, 2) and one["frames"] == two["frames"] == len(found[0])
    assert one["parity"]["holds"] and two["parity"]["holds"]
    # The mesh is numbered by ranks, so that sums round otherwise; the thesis's iteration ends at the tolerance of 1e-3.
    np.testing.assert_allclose(found[1], found[0], rtol=1e-5 if name == "thesis" else 1e-8)
