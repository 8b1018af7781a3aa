"""The types of the layers below the applications agree; which ones are checked stands in pyproject.toml."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
LIBRARY = ROOT / "lib" / "restshape"
CHECKED = ("algebra", "analysis", "fem", "mesh", "outputs", "replay", "scene", "sensitivity", "shape")
"""Packages in which no type is left open, nor in the modules beside them."""
BORDERS = {
    "arrays.py": "numpy: the shape of an array has no type",
    "scene/annotations.py": "pydantic makes models of annotations at run time",
    "scene/rewritten.py": "tomlkit: documents, whose items depend on what they hold",
    "shape/drawings/dxf.py": "ezdxf: entities of drawings, whose attributes depend on their kind",
    "shape/drawings/dxf_blocks.py": "ezdxf",
    "shape/drawings/geo_model.py": "gmsh",
    "shape/drawings/geo_operations.py": "gmsh",
    "shape/drawings/plane_faces.py": "gmsh",
    "shape/patterns/pattern_drawing.py": "ezdxf",
    "shape/patterns/pattern_notes.py": "ezdxf",
    "shape/drawings/step_names.py": "gmsh",
    "shape/drawings/svg.py": "svgelements: shapes, whose attributes depend on their kind",
    "shape/drawings/svg_segments.py": "svgelements",
}
"""Files of these packages that may use `Any`, and what it is the border to."""
ANALYSES = """
from restshape.analysis.analysis import Analysis, State
from restshape.analysis.buckling.buckling import BucklingAnalysis
from restshape.analysis.modal.modal import ModalAnalysis
from restshape.analysis.static.nonlinear import NonlinearSteadyAnalysis
from restshape.analysis.motion.nonlinear_transient import NonlinearTransientAnalysis
from restshape.analysis.static.steady import SteadyAnalysis
from restshape.analysis.motion.transient import TransientAnalysis
from restshape.fem.eigenproblem import Eigenproblem
from restshape.fem.problem import PrestressedProblem, SteadyProblem, TransientProblem
from restshape.physics.cloth.cloth_problem import ClothProblem
from restshape.physics.cloth.relaxation.relaxation_analysis import RelaxationAnalysis
from restshape.physics.heat.conduction import HeatConduction

heat: SteadyAnalysis[HeatConduction]
modes: ModalAnalysis
buckling: BucklingAnalysis
steady: NonlinearSteadyAnalysis
motion: TransientAnalysis
large_motion: NonlinearTransientAnalysis
cloth: RelaxationAnalysis
"""
EACH_IS_AN_ANALYSIS = """
of_heat: Analysis[HeatConduction] = heat
of_modes: Analysis[Eigenproblem] = modes
of_buckling: Analysis[PrestressedProblem] = buckling
of_solids: Analysis[SteadyProblem] = steady
of_motion: Analysis[TransientProblem] = motion
of_large_motion: Analysis[TransientProblem] = large_motion
of_cloth: Analysis[ClothProblem] = cloth
solved: HeatConduction | None = of_heat.state.problem
"""
WRONG = (
    ("from restshape.fem.elements import LINEAR_ELASTICK", 'has no attribute "LINEAR_ELASTICK"'),
    ("from restshape.fem import elements; elements.STVKK", 'has no attribute "STVKK"'),
    ("of_cloth: Analysis[ClothProblem] = heat", "Incompatible types in assignment"),
    ("heat.state.interrupted = True", 'Property "interrupted" defined in "SteadyState" is read-only'),
    (
        "state: State[SteadyProblem] = steady.state; state.interrupted = True",
        'Property "interrupted" defined in "State"',
    ),
    ("answer: Analysis[int]", 'must be a subtype of "Problem"'),
)


@pytest.fixture(scope="module")
def check(tmp_path_factory):
    """Runs the type checker on what is given, on what it has already read in this module."""
    command = [sys.executable, "-m", "mypy", "--cache-dir", str(tmp_path_factory.mktemp("mypy"))]

    def run(*words: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run([*command, *words], cwd=ROOT, capture_output=True, text=True, check=False)

    return run


@pytest.mark.cli
@pytest.mark.slow
def test_types_agree(check):
    # What others could read again is written in the weekly tests.
    found = check("--no-incremental")
    assert found.returncode == 0, found.stdout + found.stderr


@pytest.mark.cli
@pytest.mark.slow
@pytest.mark.weekly
def test_each_analysis_is_one_of_its_problem(check, tmp_path):
    program = tmp_path / "analyses.py"
    program.write_text(ANALYSES + EACH_IS_AN_ANALYSIS)
    found = check(str(program))
    assert found.returncode == 0, found.stdout + found.stderr


@pytest.mark.cli
@pytest.mark.slow
@pytest.mark.weekly
def test_the_type_checker_finds_what_is_wrong(check, tmp_path):
    program, first = tmp_path / "wrong.py", len(ANALYSES.splitlines()) + 1
    program.write_text(ANALYSES + "\n".join(line for line, _ in WRONG) + "\n")
    found = check(str(program))
    errors = [line for line in found.stdout.splitlines() if ": error: " in line]
    assert found.returncode == 1 and len(errors) == len(WRONG), found.stdout
    for number, (error, (_, words)) in enumerate(zip(errors, WRONG), start=first):
        assert f":{number}: error: " in error and words in error


@pytest.mark.slow
def test_any_stands_at_borders_alone():
    used = {
        path.relative_to(LIBRARY).as_posix()
        for path in (*LIBRARY.glob("*.py"), *(path for name in CHECKED for path in (LIBRARY / name).rglob("*.py")))
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if "Any" in (getattr(node, "id", ""), getattr(node, "attr", ""))
    }
    assert used == set(BORDERS)
