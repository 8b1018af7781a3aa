"""`restshape info` and calibrations."""

import json
import subprocess
from dataclasses import replace
from importlib import metadata
from pathlib import Path

import numpy as np
import pytest

from restshape import measurement
from restshape.calibration import Calibration, own_path
from restshape.cli.main import main
from restshape.errors import UserError


@pytest.mark.slow
def test_versions_are_those_of_the_libraries(tmp_path: Path) -> None:
    out = tmp_path / "info.json"
    assert main(["info", "--json", str(out)]) == 0
    facts = json.loads(out.read_text())
    assert facts["programs"]["numpy"] == np.__version__
    assert facts["programs"]["vtk"] == metadata.version("vtk")
    mpi = subprocess.run(["mpiexec", "--version"], capture_output=True, text=True).stdout.split("\n")[0].split()[-1]
    assert mpi in facts["solvers"]["MPI"]
    assert facts["solvers"]["scalar"] == "float64, 8 bytes"
    assert facts["solvers"]["PETSc"].split(".")[:2] == facts["extension"]["PETSc when built"].split(".")[:2]
    assert "-O3" in facts["extension"]["flags"]
    assert ("-march=native" in facts["extension"]["flags"]) is not facts["extension"]["portable"]


def test_out_without_calibrate_is_refused(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert main(["info", "--out", str(tmp_path / "c.json")]) == 2
    assert "--calibrate" in capsys.readouterr().err


@pytest.mark.slow
def test_measured_calibration_predicts_this_machine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A file is written that loads again; its units are positive and within the span of computers of two decades."""
    # Each measurement takes a tenth of its time.
    monkeypatch.setattr(measurement.median_seconds, "__defaults__", (7, 0.02))
    out = tmp_path / "own.json"
    assert main(["info", "--calibrate", "--out", str(out)]) == 0
    own = Calibration.load(out)
    assert 1e-5 < own.refresh_seconds(2_000, 28_000, 66_000) < 1e-1
    assert 1e-6 < own.iteration_seconds(2_000, 28_000, 66_000) < 1e-2
    assert own.refresh_seconds(20_000, 280_000, 1.2e6) > 5 * own.refresh_seconds(2_000, 28_000, 66_000)


def test_nominal_costs_are_those_measured_on_the_target_machine() -> None:
    """Factors in blocks, by scripts/factors.py, at 2,000 and 20,000 unknowns: 0.4 and 9 ms, an iteration 0.05, 0.7."""
    nominal = Calibration.load()
    small, large = (2_048, 27_656, 66_616), (20_000, 276_808, 1_173_536)
    assert nominal.refresh_seconds(*small) == pytest.approx(0.4e-3, rel=0.3)
    assert nominal.refresh_seconds(*large) == pytest.approx(9e-3, rel=0.3)
    assert nominal.iteration_seconds(*small) == pytest.approx(0.05e-3, rel=0.3)
    assert nominal.iteration_seconds(*large) == pytest.approx(0.7e-3, rel=0.3)


def test_calibration_survives_its_file_bit_for_bit(tmp_path: Path) -> None:
    own = replace(Calibration.load(), machine="another", element=1.0 / 3.0)
    own.save(tmp_path / "deep" / "own.json")
    assert Calibration.load(tmp_path / "deep" / "own.json") == own


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda c: c.pop("format"), "not a restshape-calibration file"),
        (lambda c: c["seconds"].pop("element"), "seconds.element"),
        (lambda c: c["seconds"].update(element=-1.0), "seconds.element"),
        (lambda c: c["seconds"].update(element=float("nan")), "seconds.element"),
        (lambda c: c["seconds"].update(element=True), "seconds.element"),
        (lambda c: c["seconds"].update(elemnt=1.0), "seconds.elemnt"),
        (lambda c: c.update(seconds=[]), "seconds.symbolic_nonzero"),
    ],
)
def test_bad_calibration_is_refused(change, message: str, tmp_path: Path) -> None:
    content, path = Calibration.load().as_dict(), tmp_path / "bad.json"
    change(content)
    path.write_text(json.dumps(content))
    with pytest.raises(UserError) as caught:
        Calibration.load(path)
    assert message in str(caught.value) and str(path) in str(caught.value)


def test_missing_and_torn_calibration_are_refused(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="absent"):
        Calibration.load(tmp_path / "absent.json")
    (tmp_path / "torn.json").write_text('{"format": "restshape-ca')
    with pytest.raises(UserError, match="not JSON"):
        Calibration.load(tmp_path / "torn.json")


def test_own_calibration_is_kept_where_xdg_says(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    assert own_path() == tmp_path / "restshape" / "calibration.json"
