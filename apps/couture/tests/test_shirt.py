"""The shirt: from flat panels to a certified rest, on a mesh of few nodes, and the commands that show and time it."""

import json

import pytest
from restshape_verification.couture import garment_times

from restshape.cli.main import main

FEW = ('mesh.size="75 mm"', "mesh.levels=1", "effects.drape.levels=1", "effects.cloth.bending=hinge")
"""A mesh of about 200 nodes."""


@pytest.mark.slow
def test_a_shirt_comes_to_rest_on_a_body(tmp_path, capsys):
    words = [word for one in FEW for word in ("--set", one)]
    main(["garments", "--garments", "shirt", "--bodies", "standard", *words, "--json", str(tmp_path / "found.json")])
    found = json.loads((tmp_path / "found.json").read_text())["shirt, standard"]
    assert found["converged"] == 1 and found["tangent_positive_definite"] == 1 and found["crossings"] == 0
    # It hangs from the shoulders, and all of its seams are closed.
    assert found["seam_gap"] < 1e-3 and 1.38 < found["high"] < 1.46 and 0.8 < found["low"] < 0.95
    assert "shirt, standard" in capsys.readouterr().out


@pytest.mark.parametrize("words", [["--garments", "kilt"], ["--bodies", "tall"]])
def test_garments_and_bodies_that_are_not_known_are_refused(words, capsys):
    assert main(["garments", *words]) == 2
    assert "is none of the" in capsys.readouterr().err


@pytest.mark.weekly
def test_a_shirt_is_timed(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(garment_times, "SIZES", {"coarse": ("75 mm", 1, "1", "2")})
    words = [word for one in FEW for word in ("--set", one)]
    assert main(["garment-times", *words, "--json", str(tmp_path / "times.json")]) == 0
    rows = json.loads((tmp_path / "times.json").read_text())
    assert "at rest and stable" in capsys.readouterr().out
    assert [row["quantity"].split()[0] for row in rows][:2] == ["flat", "the"] and len(rows) >= 3 + 4
