"""`restshape bench nested`: drags on a coarse mesh beside those on the fine one alone."""

import pytest
from restshape_studies.bench.nested import WAYS, nested_drags

from restshape.application import application
from restshape.cli.main import main


@pytest.mark.slow
def test_a_coarse_mesh_makes_frames_of_drags_quicker(tmp_path):
    scene = application("couture").folder / "scenes" / "longer.toml"
    found = nested_drags(scene, "hinge", 0.02, 4, tmp_path, lambda _: None)
    assert list(found) == list(WAYS)
    coarse, bare, still, both, every, fine = found.values()
    assert coarse["unknowns"] == fine["unknowns"] and still["steps"] == both["steps"] == 0 < coarse["steps"]
    assert coarse["nodes"] > 3 * coarse["coarse"]
    assert all(one["frames"] == 4 for one in found.values())
    assert all(0.0 < one["estimate"] < 0.2 for one in (coarse, still, every, fine))
    assert bare["estimate"] is both["estimate"] is None


@pytest.mark.parametrize("words", [["longer.toml"], ["--mm", "0.1"], ["--along", "1"], ["--levels", "1"]])
def test_what_makes_no_sense_is_refused(words, capsys):
    assert main(["bench", "nested", *words]) == 2
    assert "try:" in capsys.readouterr().err
