"""Orders of flow, and of flow with heat and buoyancy: two ranks find those that one finds."""

import json

import pytest


@pytest.mark.slow
@pytest.mark.parametrize(
    "case", [pytest.param("flow.vortices_in_time", marks=pytest.mark.weekly), "thermal.waves_in_time"]
)
def test_two_ranks_find_the_orders_that_one_finds(case, on_ranks, tmp_path):
    found = []
    for ranks in (1, 2):
        done = on_ranks(ranks, "validate", "--case", case, "--json", f"{ranks}.json")
        assert done.returncode == 0, done.stdout + done.stderr
        assert f"validation on {ranks} rank" in done.stdout
        found.append({row["quantity"]: row["value"] for row in json.loads((tmp_path / f"{ranks}.json").read_text())})
    assert len(found[0]) >= 4 and found[1] == pytest.approx(found[0], rel=1e-6)
