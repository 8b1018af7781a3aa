"""The picture of single frames of a recording of cloth."""

import numpy as np
import pytest
from cloths_recorded import record_cloth
from PIL import Image
from plates import record_plate

from restshape.cli.main import main


@pytest.fixture
def cloth(tmp_path):
    record_cloth(tmp_path / "cloth.vtkhdf", (0.0, -0.1))
    return tmp_path / "cloth.vtkhdf"


@pytest.mark.slow
def test_the_picture_of_single_frames(cloth, tmp_path, capsys):
    path = tmp_path / "a.png"
    assert main(["drapes", str(cloth), "--frames", "0", "-1", "--out", str(path)]) == 0
    with Image.open(path) as image:
        assert len(np.unique(np.asarray(image.convert("RGB")).reshape(-1, 3), axis=0)) > 500
    assert main(["drapes", str(cloth), "--frames", "2", "--out", str(path)]) == 2
    assert main(["drapes", str(cloth), "--out", str(tmp_path / "none" / "a.png")]) == 2
    record_plate(tmp_path / "plate.vtkhdf", frames=2)
    assert main(["drapes", str(tmp_path / "plate.vtkhdf"), "--out", str(path)]) == 2
    printed = capsys.readouterr().err
    for message in ("there is no frame 2", "not of cloth", "cannot be written"):
        assert message in printed


@pytest.mark.slow
def test_the_first_and_last_of_one_frame_are_drawn_once(tmp_path):
    record_cloth(tmp_path / "one.vtkhdf", (0.0,))
    sizes = []
    for words in ([], ["--frames", "0"]):
        path = tmp_path / "a.png"
        assert main(["drapes", str(tmp_path / "one.vtkhdf"), *words, "--out", str(path)]) == 0
        with Image.open(path) as image:
            sizes.append(image.size)
    assert sizes[0] == sizes[1]
