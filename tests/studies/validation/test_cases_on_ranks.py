"""Validation cases whose equations ranks share pass on two ranks as on one."""

import json

import pytest
from restshape_studies.verification import verifications

SHARED = (
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
    "period",
    "energy",
    "order",
    "pipe",
    "balance",
    "derivatives",
    "kovasznay",
    "beams",
    "identities",
    "rates",
)
"""Names of cases, of any application. Others are of what ranks compute whole, or take minutes.

`patch` and rates of convergence have their turn in `test_ranks.py` and `test_parity_on_ranks.py`.
"""
EVERY_DAY = ("balance",)
CASES = [
    (f"{application}.{case}", case)
    for application, found in verifications().items()
    for case in found.load_validation()
    if case in SHARED
]


def test_all_are_cases():
    assert {case for _, case in CASES} == set(SHARED)


@pytest.mark.mpi
@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [pytest.param(name, id=name, marks=[] if case in EVERY_DAY else [pytest.mark.weekly]) for name, case in CASES],
)
def test_it_passes_on_two_ranks(tmp_path, restshape, name):
    done = restshape("validate", "--case", name, "--json", "v.json", ranks=2)
    assert done.returncode == 0, done.stdout + done.stderr
    rows = json.loads((tmp_path / "v.json").read_text())
    assert rows and all(row["case"] == name and row["passed"] for row in rows)
