"""Validation cases whose equations ranks share pass on two ranks as on one."""

import json

import pytest
from restshape_studies.verification import verifications

SHARED = {
    "solid": (
        "kirsch",
        "cook",
        "incompressible",
        "timoshenko",
        "slender",
        "cook_quadratic",
        "le1",
        "uniaxial",
        "strip",
        "elastica",
        "columns",
        "elastic_columns",
        "ring",
        "load_factors",
    ),
    "vibration": ("period", "energy", "order"),
    "thermal": ("pipe", "balance", "derivatives"),
    "metallophone": ("beams", "plates", "identities", "rates"),
}
"""By application. Others are of furniture and cloth, which ranks compute whole, or take minutes.

`solid.patch` and rates of convergence have their turn in `test_ranks.py` and `test_parity_on_ranks.py`.
"""
EVERY_DAY = ("thermal.balance",)
CASES = [f"{application}.{case}" for application, cases in SHARED.items() for case in cases]


def test_all_are_cases():
    known = {f"{app}.{case}" for app, found in verifications().items() for case in found.load_validation()}
    assert set(CASES) <= known


@pytest.mark.mpi
@pytest.mark.slow
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[] if name in EVERY_DAY else [pytest.mark.weekly]) for name in CASES]
)
def test_it_passes_on_two_ranks(tmp_path, restshape, name):
    done = restshape("validate", "--case", name, "--json", "v.json", ranks=2)
    assert done.returncode == 0, done.stdout + done.stderr
    rows = json.loads((tmp_path / "v.json").read_text())
    assert rows and all(row["case"] == name and row["passed"] for row in rows)
