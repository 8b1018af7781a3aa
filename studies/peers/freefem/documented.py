"""The cases as FreeFEM's documentation has them: what is handed over as text, and the scripts that compute.

Sources: sections static problems (elasticity), nonlinear elasticity, eigenvalue problems, thermal conduction and
Navier-Stokes of FreeFEM's documentation; matrices of each frame are made from nothing, and factored by UMFPACK.
"""

import os
import subprocess
import tempfile
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
GROUPS = ("fixed", "pulled", "pressed", "heated", "cooled", "inlet", "slip", "walls")
"""Groups of the border's pieces, labelled 1, 2, ...; all others are labelled 9."""
PROBLEMS = {
    "static": "static.edp",
    "large_deformation": "large.edp",
    "motion": "motion.edp",
    "modes": "modes.edp",
    "heat": "heat.edp",
    "flow": "flow.edp",
}


def installed_version():
    """What the program says of itself."""
    with tempfile.TemporaryDirectory() as folder:
        script = Path(folder) / "version.edp"
        script.write_text("cout << version << endl;\n")
        return subprocess.run(command(script), capture_output=True, text=True, check=True).stdout.split()[0]


def command(script):
    """The program with a script, without windows and without words of its own."""
    return ["FreeFem++", "-nw", "-v", "0", "-f", str(script)]


VERSION = f"FreeFEM {installed_version()}"


def write_mesh(path, mesh, given):
    """A mesh in FreeFEM's format."""
    labels = {name: k + 1 for k, group in enumerate(GROUPS) for name in given.get(group, [])}
    sides = [np.column_stack([ends + 1, np.full(len(ends), labels.get(name, 9))]) for name, ends in mesh.facets.items()]
    sides = np.concatenate(sides)
    with path.open("w") as file:
        file.write(f"{len(mesh.points)} {len(mesh.cells)} {len(sides)}\n")
        np.savetxt(file, np.column_stack([mesh.points, np.zeros(len(mesh.points))]), "%.17g %.17g %d")
        np.savetxt(file, np.column_stack([mesh.cells + 1, np.zeros(len(mesh.cells))]), "%d %d %d %d")
        np.savetxt(file, sides, "%d %d %d")


def declarations(folder, frames, given):
    """FreeFEM's declarations of the folder, the number of frames and the numbers of the physics."""
    found = {}
    for name, value in given.items():
        if isinstance(value, float | int):
            found[name] = value
        elif name in ("traction", "body_force"):
            found[f"{name}_x"], found[f"{name}_y"] = value
    lines = [f"real {name.replace('_', '')} = {value!r};" for name, value in found.items()]
    return "\n".join([f'string folder = "{folder}";', f"int frames = {frames};", *lines, ""])


def play(script, case):
    """Answers of all frames, with their seconds of the processor; FreeFEM has no clock that is finer than a second."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for number, mesh in enumerate(case.meshes):
            write_mesh(folder / f"mesh{number}.msh", mesh, case.parameters)
        for frame, places in enumerate(case.places):
            np.savetxt(folder / f"places{frame}.txt", places, "%.17g")
        np.savetxt(folder / "meshes.txt", case.mesh_of, "%d")
        (folder / "given.edp").write_text(declarations(name, len(case.places), case.parameters))
        surroundings = os.environ | {"FF_INCLUDEPATH": f"{name};{HERE}"}
        done = subprocess.run(command(HERE / script), capture_output=True, text=True, env=surroundings)
        if done.returncode:
            raise RuntimeError(done.stdout[-2000:])
        processor = np.loadtxt(folder / "times.txt", ndmin=1).tolist()
        answers = [np.loadtxt(folder / f"answer{frame}.txt") for frame in range(len(case.places))]
    return answers, None, processor
