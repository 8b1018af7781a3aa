"""What models alone cannot check in a scene of elastic solids."""

from restshape.outputs.si_numbers import counted_are
from restshape.physics.elasticity.ground_record import read_record
from restshape.scene.checks import check_file
from restshape.scene.expressions import Expression
from restshape.scene.model import Quantity, Scene
from restshape.scene.source import Source, suggestion

NO_TONES = ("only free vibrations have tones", "use an application that has [effects.modal]")
ELSEWHERE = {
    "cents": NO_TONES,
    "ratio": NO_TONES,
    "frequency": (
        "without modes there are no frequencies",
        "add [effects.modal], in an application that has it",
    ),
    "mode": ("only free vibrations have frequencies", "use an application that has [effects.modal]"),
    "load_factor": (
        "without buckling there are no load factors",
        "add [effects.buckling], in an application that has it",
    ),
}
"""Quantities that solids, static or in motion, have not: why, and what to do."""
OF_MODES = ("frequency", "mode", "cents", "ratio", "area")
"""Kinds of quantities that free vibrations have."""
COMPONENTS = {
    "solid": ("x", "y", "z"),
    "plate": ("z", "rx", "ry"),
    "plane_stress": ("x", "y"),
    "plane_strain": ("x", "y"),
}
"""What supports may fix of bodies that vibrate freely, by their model."""


def elsewhere(quantity: Quantity) -> tuple[str, tuple[str, ...], str] | None:
    """Why solids, static or in motion, have no such quantity, its key where that says more, and what to do; or None."""
    for kind, (why, do) in ELSEWHERE.items():
        if getattr(quantity, kind):
            return why, (kind,) if kind == "load_factor" else (), f"leave it out, or {do}"
    return None


def check_static_solids(scene: Scene, source: Source) -> None:
    """Checks a scene of elastic solids in the plane, in static equilibrium.

    Raises:
        UserError: the first thing that makes no sense.
    """
    check_solids(scene, source)
    for name, quantity in scene.quantities.items():
        if quantity.energy and quantity.energy != "strain":
            what = f"a solid in static equilibrium has no {quantity.energy!r} energy"
            raise source.error(("quantities", name, "energy"), what, 'use "strain"')


def check_solids(scene: Scene, source: Source) -> None:
    """Checks what scenes of elastic solids in the plane have in common, static or in motion.

    Raises:
        UserError: the first thing that makes no sense.
    """
    check_goals(scene, source)
    for name, material in scene.material.items():
        if isinstance(material.thickness, Expression):
            what = f"the application {scene.app!r} knows one thickness a material only"
            raise source.error(("material", name, "thickness"), what, "give a number")
        if material.orthotropic is not None:
            what = f"the application {scene.app!r} knows isotropic materials only"
            raise source.error(("material", name), what, "give E and nu")
    _refuse_no_thickness(scene, source)
    for name, quantity in scene.quantities.items():
        missing = elsewhere(quantity)
        found = (quantity.load_factor and "buckling" in scene.effects) or (
            quantity.frequency and "modal" in scene.effects
        )
        if missing and not source.recorded and not found:
            raise source.error(("quantities", name, *missing[1]), missing[0], missing[2])


def _refuse_no_thickness(scene: Scene, source: Source) -> None:
    """Refuses a thickness that is left out where stress follows from it: plane stress under forces in N.

    In plane strain forces are those on a metre of depth.
    """
    # Recordings of scenes from before this was refused are still read.
    if source.recorded or scene.effects.get("solid", {}).get("model", "plane_stress") != "plane_stress":
        return
    force = next((name for name, load in scene.loads.items() if load.force is not None), None)
    if force is None:
        return
    for name, material in scene.material.items():
        if "thickness" not in material.model_fields_set:
            what = f"stress is the force of loads.{force} by the thickness, which is left out"
            raise source.error(("material", name), what, 'add thickness = "8 mm"; until now it was 1 m')


def check_motion(scene: Scene, source: Source) -> None:
    """Checks a scene of elastic solids in motion: a record of the ground's motion can be read.

    Raises:
        UserError: the first thing that makes no sense.
    """
    check_solids(scene, source)
    _check_modes(scene, source, 0)
    file = scene.effects.get("ground", {}).get("file")
    for name, quantity in scene.quantities.items():
        if quantity.energy in ("edit", "remesh") and quantity.at is not None:
            what = f"{quantity.energy!r} energy is that of the whole body"
            raise source.error(("quantities", name, "at"), what, "leave `at` out")
    # A recording names files, and none of them is read.
    if file is not None and not source.recorded:
        key = ("effects", "ground", "file")
        check_file(key, file, source)
        read_record(source.path.parent / file)


def check_vibrations(scene: Scene, source: Source) -> None:
    """Checks a scene of free vibrations: a support fixes what bodies of the model have, to 0.

    Raises:
        UserError: the first thing that makes no sense.
    """
    check_goals(scene, source)
    for name, quantity in scene.quantities.items():
        if quantity.kind not in OF_MODES:
            what = f"modes have no {quantity.kind}: their size means nothing"
            do = 'ask for frequency = 1, mode = 1, cents = "C5", ratio = 2 or area = true'
            raise source.error(("quantities", name, quantity.kind), what, do)
    _check_modes(scene, source, 5)
    _check_hanging(scene, source)
    model = scene.effects.get("modal", {}).get("model", "solid")
    # Recordings of scenes from before this was refused are still read.
    for name, support in () if source.recorded or model not in COMPONENTS else scene.supports.items():
        for axis in support.fix:
            if axis not in COMPONENTS[model]:
                what = f"a body of effects.modal.model = {model!r} has no component {axis!r} that could be fixed"
                raise source.error(("supports", name, "fix"), what, f"fix some of {', '.join(COMPONENTS[model])}")
    for name, support in scene.supports.items():
        for axis in (axis for axis, value in support.fix.items() if value != 0.0):
            what = "what a support prescribes has no meaning for free vibrations"
            raise source.error(("supports", name, "fix", axis), what, f'fix = ["{axis}"]')


def _check_modes(scene: Scene, source: Source, usual: int) -> None:
    """Refuses quantities of modes that are not computed; `usual` are where the scene does not say how many.

    Raises:
        UserError: the first one.
    """
    modes = scene.effects.get("modal", {}).get("modes", usual)
    for name, quantity in () if source.recorded else scene.quantities.items():
        keys = ("frequency", "ratio", *(("mode",) if quantity.kind == "cents" else ()))
        for key, rank in ((key, quantity.number(key)) for key in keys):
            if rank is not None and rank > modes:
                do = f"set effects.modal.modes to {rank} or more"
                raise source.error(("quantities", name, key), f"only {counted_are(modes, 'mode')} computed", do)


def _check_hanging(scene: Scene, source: Source) -> None:
    """Refuses hanging points of what has none, and those of modes that are not computed.

    Raises:
        UserError: the first thing that makes no sense.
    """
    modal = scene.effects.get("modal", {})
    asked = modal.get("hanging")
    if asked is None or source.recorded:
        return
    key, model, modes = ("effects", "modal", "hanging"), modal.get("model", "solid"), modal.get("modes", 5)
    if model in ("plane_stress", "plane_strain"):
        what = f'model = "{model}" has motion in the plane only, which has no nodal lines'
        raise source.error(key, what, 'use model = "plate" or "solid", or leave hanging out')
    if scene.supports:
        raise source.error(key, "what supports hold is not hung", "leave the supports out, or hanging")
    for name, wanted in (("mode", asked.get("mode", 1)), ("weights", len(asked.get("weights", ())))):
        if wanted > modes:
            do = f"set effects.modal.modes to {wanted} or more"
            raise source.error((*key, name), f"only {counted_are(modes, 'mode')} computed", do)


def check_goals(scene: Scene, source: Source) -> None:
    """Refuses a distance from a goal that is not there.

    Raises:
        UserError: the first one.
    """
    for name, quantity in scene.quantities.items():
        if quantity.distance is not None and quantity.distance not in scene.goal:
            what = f"there is no goal {quantity.distance!r}"
            do = suggestion(quantity.distance, sorted(scene.goal)) or f"add [goal.{quantity.distance}]"
            raise source.error(("quantities", name, "distance"), what, do)
