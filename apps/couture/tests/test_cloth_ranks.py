"""Cloth that touches itself and bodies comes to the same rest on two ranks as on one."""

import json

import pytest
from restshape_verification.couture.drapes import drapes

from restshape.application import application

SEWN = (application("couture").folder / "scenes" / "sewn_skirt.toml").read_text()
pytestmark = [pytest.mark.mpi, pytest.mark.slow]


@pytest.mark.parametrize(("name", "size"), [("skirt", 0.08), ("poncho", 0.07), ("sewn", 0.05)])
def test_ranks_come_to_the_same_rest(tmp_path, on_ranks, name, size):
    """Steps of block Jacobi's tolerance would be others on each number of ranks, and lead to other folds."""
    path, energies = tmp_path / f"{name}.toml", []
    path.write_text(SEWN if name == "sewn" else drapes()[name])
    for ranks in (1, 2):
        done = on_ranks(ranks, "replay", path, "--json", f"{ranks}.json", "--set", f"mesh.size={size}")
        assert done.returncode == 0, done.stdout + done.stderr
        summary = json.loads((tmp_path / f"{ranks}.json").read_text())
        energies += summary["quantities"]["potential"]
    assert energies[1] == pytest.approx(energies[0], rel=1e-4)
