"""What the first frame would refuse of a scene of cloth, found without relaxing it."""

from __future__ import annotations

from restshape.mesh.generate import generate
from restshape.mesh.importer import read_mesh
from restshape.physics.cloth.relaxation.beginning import beginning, start_notes
from restshape.physics.cloth.relaxation.binding import begins_across
from restshape.physics.cloth.scene import cloth_arguments, cloth_problem
from restshape.scene.model import Scene
from restshape.scene.plan import Plan
from restshape.shape.outline import Outline


def check_start(scene: Scene, plan: Plan, outline: Outline) -> list[str]:
    """What there is to note of cloth at its initial placement.

    Raises:
        UserError: contact would begin between neighbours, bodies hold the cloth between them, or it crosses itself
            though it is to touch itself.
    """
    spec = scene.mesh
    mesh = read_mesh(scene.folder / spec.file, spec.unit)[0] if spec.file else generate(outline, spec)
    arguments = cloth_arguments(scene, plan, mesh)
    problem = cloth_problem(mesh, arguments)
    begun = beginning(problem, arguments)
    notes = start_notes(problem, begun, scene)
    return [*notes, *([] if problem.begin(begun.x) else [begins_across(problem, begun.x, scene)])]
