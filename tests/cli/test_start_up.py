"""What commands do not import on the way to their first result: each of these takes longer than the result itself."""

import os
import subprocess
import sys
from pathlib import Path

import petsc4py
import pytest

from restshape.cli import early_libraries
from restshape.surroundings import DISCOVERY, LONE, POINT_TO_POINT, start_petsc

BRACKET = Path(__file__).resolve().parents[2] / "docs" / "examples" / "bracket.toml"
UNNEEDED = ("scipy", "gmsh", "meshio", "matplotlib", "numpy.typing", "h5py", "ezdxf")
UNNEEDED += ("slepc4py", "multiprocessing", "asyncio", "http", "restshape.replay.recording.vtkhdf", "rich")


@pytest.fixture
def imported(outside, tmp_path):
    """The modules that a command has imported at its end, in a process of its own."""

    def imported(*words):
        program = "import sys\nfrom restshape.cli.main import main\ncode = main(sys.argv[1:])\n"
        program += "print('modules', *sys.modules)\nsys.exit(code)"
        command = [sys.executable, "-c", program, *map(str, words)]
        done = subprocess.run(command, env=outside, cwd=tmp_path, capture_output=True, text=True, timeout=60)
        assert done.returncode == 0, done.stderr
        return set(done.stdout.splitlines()[-1].split())

    return imported


def test_the_first_frame_of_the_bracket_needs_no_large_library(imported):
    modules = imported("replay", BRACKET)
    assert "restshape.analysis.static.steady" in modules
    assert not modules.intersection(UNNEEDED)
    # Analyses that the scene does not call for.
    analyses = {name for name in modules if name.startswith("restshape.analysis.")}
    assert not {name for name in analyses if name.endswith((".buckling", ".transient", ".nonlinear"))}


@pytest.mark.slow
def test_a_recording_is_written_without_its_library_in_the_process_that_solves(imported, tmp_path):
    modules = imported("replay", BRACKET, "--out", "a.vtkhdf")
    assert (tmp_path / "a.vtkhdf").stat().st_size > 0
    assert not modules.intersection(UNNEEDED)


def test_libraries_of_the_kernels_are_loaded_while_modules_of_python_are_imported(outside):
    """Without the kernels' own module, which waits for them with all of Python."""
    program = "import sys\nfrom restshape.cli.early_libraries import KERNELS, loading_libraries\n"
    program += "with loading_libraries():\n    pass\nprint(KERNELS in sys.modules, open('/proc/self/maps').read())\n"
    program += "sys.modules[KERNELS] = None\nwith loading_libraries():\n    import threading\n"
    program += "    print('threads', threading.active_count())"
    done = subprocess.run([sys.executable, "-c", program], env=outside, capture_output=True, text=True, timeout=60)
    assert done.stdout.startswith("False ") and "/_kernels." in done.stdout and "/libpetsc" in done.stdout
    assert done.stdout.endswith("threads 1\n"), "what is there is not loaded again"


def test_without_another_thread_libraries_are_loaded_as_they_are_imported(monkeypatch):
    def refuse(_):
        raise RuntimeError("can't start new thread")

    monkeypatch.delitem(sys.modules, early_libraries.KERNELS, raising=False)
    monkeypatch.setattr(early_libraries.Thread, "start", refuse)
    done = []
    with early_libraries.loading_libraries():
        done.append(True)
    assert done


@pytest.mark.slow
def test_the_machine_is_asked_for_its_name_only_where_results_say_it(outside, tmp_path):
    program = "import sys\nfrom restshape.cli.main import main\nimport restshape.replay.request as request\n"
    program += "request.cpu_model = lambda: print('asked') or 'a machine'\nsys.exit(main(sys.argv[1:]))"
    for more, count in (([], 0), (["--json", "a.json"], 1)):
        command = [sys.executable, "-c", program, "replay", str(BRACKET), *more]
        done = subprocess.run(command, env=outside, cwd=tmp_path, capture_output=True, text=True, timeout=60)
        assert done.returncode == 0 and done.stdout.count("asked") == count, done.stderr


@pytest.mark.parametrize(
    "environment, chosen",
    [
        ({}, LONE),
        ({"OMPI_COMM_WORLD_SIZE": "2"}, {}),
        ({"PMI_RANK": "0"}, {}),
        ({POINT_TO_POINT: "cm"}, LONE | {POINT_TO_POINT: "cm"}),
        ({DISCOVERY: "xml"}, LONE | {DISCOVERY: "xml"}),
    ],
)
def test_a_process_without_others_does_not_look_for_network_cards(monkeypatch, environment, chosen):
    """Nor do ranks hear of that, whoever starts them."""
    names = ("OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK", *LONE)
    for name in names:
        monkeypatch.delenv(name, raising=False)
    for name, value in environment.items():
        monkeypatch.setenv(name, value)
    met = []
    monkeypatch.setattr(petsc4py, "init", lambda words: met.append({name: os.environ.get(name) for name in LONE}))
    start_petsc()
    assert met == [dict.fromkeys(LONE) | chosen]
    assert {name: os.environ[name] for name in names if name in os.environ} == environment
