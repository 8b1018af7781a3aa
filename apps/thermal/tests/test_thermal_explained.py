"""What `restshape explain` says of heat in a fluid: each effect that is on has a price."""

import json

import pytest
from restshape_apps.thermal import application

SCENE = application.folder / "scenes" / "thermal.toml"


@pytest.mark.slow
def test_heat_buoyancy_and_gravity_have_a_price(command, tmp_path):
    done = command("explain", SCENE, "--frames", "4", "--seconds", "0", "--json", "out.json")
    assert done.returncode == 0, done.stderr
    rows = {row["effect"]: row for row in json.loads((tmp_path / "out.json").read_text())}
    # Rounding decides whether frames without heat take as many steps of Newton's method: else heat has no price.
    priced = "by a way of other length" not in rows["heat"]["how"]
    for name in ("convection", "heat", "buoyancy", "gravity"):
        determined = not rows[name]["how"].startswith("not determined")
        assert rows[name]["on"] and determined is (priced or name != "heat"), rows[name]
    if priced:
        assert rows["heat"]["share"] > 0.2 and rows["heat"]["unknowns"] > 1000
    # Gravity alone costs nothing. Its share is a difference of times: four spreads, or half of what heat costs.
    heat = rows["heat"]["share"] if priced else rows["flow"]["share"]
    assert abs(rows["gravity"]["share"]) < max(4 * rows["gravity"]["spread"], 0.5 * heat)
    assert "within that of heat" in rows["temperature_difference"]["how"]
    assert sum(row["share"] for row in rows.values()) == pytest.approx(1.0, abs=1e-9)
