"""What models alone cannot check in a scene: names that refer to each other, coverage, sense."""

from collections.abc import Iterable

from restshape.application import Application
from restshape.bounds import FILE_NAME_BYTES
from restshape.scene.bodies import bodies_of
from restshape.scene.effect_places import effect_places
from restshape.scene.expressions import CONSTANTS, COORDINATES, FUNCTIONS, Expression
from restshape.scene.formula_checks import check_formulas, check_units
from restshape.scene.load_kind import ENTITIES, any_of
from restshape.scene.model import EdgeLoop, Load, Quantity, Scene, ShapeSpec
from restshape.scene.panels import panels_of
from restshape.scene.permits import outside
from restshape.scene.scene_parameters import Parameters
from restshape.scene.source import Source, name_suggestion, suggestion
from restshape.scene.units import article
from restshape.scene.values import RESERVED


def check_scene(scene: Scene, application: Application, source: Source, parameters: Parameters) -> None:
    """Checks all that needs neither geometry nor a mesh, with the parameters of the scene.

    Raises:
        UserError: the first thing that makes no sense.
    """
    application.editing.check_scene(scene, application, source)
    _check_recording(scene, application, source)
    for physics in application.physics:
        if physics.check:
            physics.check(scene, source)
    check_units(scene, parameters, source)


def _check_recording(scene: Scene, application: Application, source: Source) -> None:
    """Refuses fields of recordings that the application does not have."""
    known = sorted({name for physics in application.physics for name in physics.requested})
    for name in scene.recording.fields:
        if name not in known:
            why = "; ".join(physics.none_requested for physics in application.physics if physics.none_requested)
            what = f"the application {application.name!r} has no fields {name!r} to record{why and f': {why}'}"
            raise source.error(("recording", "fields"), what, suggestion(name, known) or "leave it out")


def check_shaped(scene: Scene, application: Application, source: Source) -> None:
    """Checks a scene with an outline and a mesh.

    Raises:
        UserError: the first thing that makes no sense.
    """
    materials = any(physics.material for physics in application.physics)
    for key in ("material", "mesh") if materials else ("mesh",):
        if key not in scene.model_fields_set:
            raise source.error((key,), f"the key {key!r} is missing", "add it")
    _check_names(scene, source)
    _check_shape(scene, source)
    check_parameters(scene, application, source)
    if materials:
        _check_materials(scene, source)
        if not source.revised:
            _refuse_mixed_thickness(scene, source)
    _check_references(scene, source)
    _check_formulas(scene, source)
    _check_mesh(scene, application, source)


def _check_names(scene: Scene, source: Source) -> None:
    """Refuses a name that stands for two entities."""
    for table, shape in _written_shapes(scene).items():
        taken: dict[str, str] = {}
        for key, kind in shape.named.items():
            for name in getattr(shape, key):
                if name in taken:
                    what = f"name {name!r} used twice: for {taken[name]} and here"
                    raise source.error((*table, key, name), what, "rename one of them")
                taken[name] = f"the {kind} {'.'.join(table)}.{key}.{name}"


def _written_shapes(scene: Scene) -> dict[tuple[str, ...], ShapeSpec]:
    """The shapes as the scene writes them, by their tables: its one shape, or its panels."""
    panels = panels_of(scene)
    return {("panels", name): panel for name, panel in panels.items()} if panels else {("shape",): scene.shape}


def check_file(key: tuple[str, ...], file: str, source: Source) -> None:
    """Refuses a file that is not there, or that the scene may not name.

    Raises:
        UserError: which key names it, and why not.
    """
    if source.recorded:
        what, do = f"the recording names the file {file!r}, and no file but the recording is read", "replay its scene"
        raise source.error(key, what, do)
    path = source.path.parent / file
    if any(len(part.encode(errors="replace")) > FILE_NAME_BYTES for part in path.parts):
        raise source.error(key, f"a part of the name has more than {FILE_NAME_BYTES} bytes", "choose a shorter one")
    if file not in source.named and (refused := outside(file, source.path.parent)):
        raise source.error(key, *refused)
    if not path.is_file():
        raise source.error(key, f"there is no file {str(path)!r}", "paths are relative to the scene's folder")


def _check_shape(scene: Scene, source: Source) -> None:
    """Refuses a shape that is missing, or edges and loops of things that are not there."""
    shape = scene.shape
    for key, file in (("shape", shape.file), ("mesh", scene.mesh.file)):
        if file:
            check_file((key, "file"), file, source)
    if scene.mesh.file:
        if shape.outline or shape.file:
            raise source.error(("mesh", "file"), "the scene has a shape and a mesh file", "keep one of the two")
        return
    if shape.file:
        return
    for table, written in _written_shapes(scene).items():
        _check_edges(written, table, source)


def _check_edges(shape: ShapeSpec, table: tuple[str, ...], source: Source) -> None:
    """Refuses edges and loops of things that are not there."""
    if shape.outline is None:
        raise source.error((*table, "outline"), "the shape has no outline", 'add outline = ["edge", ...] to [shape]')
    for name, edge in shape.edges.items():
        for vertex in getattr(edge, edge.kind):
            _refuse_absent(vertex, shape.vertices, "vertex", (*table, "edges", name, edge.kind), source)
    loops: dict[tuple[str, ...], list[str]] = {(*table, "outline"): shape.outline}
    for key in ("holes", "regions"):
        for name, loop in getattr(shape, key).items():
            if isinstance(loop, EdgeLoop):
                loops[(*table, key, name, "loop")] = loop.loop
    for place, edges in loops.items():
        for edge_name in edges:
            _refuse_absent(edge_name, shape.edges, "edge", place, source)


def _refuse_absent(name: str, known: Iterable[str], kind: str, place: tuple[str, ...], source: Source) -> None:
    """Refuses a name that names nothing of its kind."""
    if name not in known:
        many = "vertices" if kind == "vertex" else f"{kind}s"
        none = f"add it to the {many}, of which there are none, or leave it out"
        do = name_suggestion(name, sorted(known), tuple(RESERVED)) if known else none
        raise source.error(place, f"there is no {kind} {name!r}", do)


def check_parameters(scene: Scene, _: Application, source: Source) -> None:
    """Refuses a parameter that hides what formulas already know.

    Raises:
        UserError: there is one.
    """
    for name in scene.parameters:
        if name in (*COORDINATES, *CONSTANTS, *FUNCTIONS):
            raise source.error(("parameters", name), f"{name!r} has a meaning in formulas already", "rename it")


def _refuse_mixed_thickness(scene: Scene, source: Source) -> None:
    """Refuses a thickness that one material leaves out, and another one has: it would be 1 m.

    Recordings of scenes from before this was refused are still read, and edits may give one after the other.
    """
    given = [name for name, material in scene.material.items() if "thickness" in material.model_fields_set]
    for name, material in scene.material.items():
        if given and name not in given and "thickness" in type(material).model_fields and not source.recorded:
            what = f"its thickness is left out, which is 1 m, and material.{given[0]} has one"
            raise source.error(("material", name), what, 'give both one, such as thickness = "8 mm"')


def _check_materials(scene: Scene, source: Source) -> None:
    """Refuses regions with two materials, and places with none."""
    panels = panels_of(scene)
    named = {panel.material for panel in panels.values()}
    rest = [name for name, material in scene.material.items() if material.region is None and name not in named]
    if panels and None not in named and len(rest) < 2:
        # Each panel names its own.
        rest = [name for name, material in scene.material.items() if material.region is None][:1]
    if len(rest) > 1:
        raise source.error(
            ("material", rest[1]),
            f"the materials {rest[0]!r} and {rest[1]!r} both fill the whole shape",
            "give one of them a region",
        )
    # Of a mesh from a file all cells may belong to regions: there the cells themselves are looked at.
    if not rest and not scene.mesh.file:
        first = next(iter(scene.material))
        raise source.error(
            ("material", first), "outside of the regions there is no material", "let one material have no region"
        )
    owner: dict[str, str] = {}
    for name, material in scene.material.items():
        for region in material.region or []:
            if region in owner:
                raise source.error(
                    ("material", name, "region"),
                    f"the region {region!r} has two materials, {owner[region]!r} and {name!r}",
                    "take it out of one",
                )
            owner[region] = name
            if not (scene.shape.file or scene.mesh.file):
                _refuse_absent(region, _filled(scene.shape), "region", ("material", name, "region"), source)


def _filled(shape: ShapeSpec) -> list[str]:
    """What a material may fill: regions, and groups that hold one or other groups."""
    parts = {*shape.regions, *shape.groups}
    return [*shape.regions, *(name for name, members in shape.groups.items() if parts.intersection(members))]


def _check_references(scene: Scene, source: Source) -> None:
    """Refuses supports, loads, quantities, sizes and groups on entities that are not there."""
    in_file = scene.shape.file or scene.mesh.file
    kinds = {} if in_file else {**source.edited, **scene.shape.kinds()}
    for name, quantity in scene.quantities.items():
        _check_place(name, quantity, kinds, source)
    if in_file:
        return
    places: dict[tuple[str, ...], list[str]] = {
        scene.shape.written_key(("shape", "groups", n)): g for n, g in scene.shape.groups.items()
    }
    places |= {("supports", name, "on"): support.on for name, support in scene.supports.items()}
    places |= {("loads", name, "on"): load.on for name, load in scene.loads.items()}
    places |= {("quantities", name, "at"): [q.at] for name, q in scene.quantities.items() if q.at is not None}
    places |= {key: list(names) for key, names in effect_places(scene)}
    places |= {("mesh", "near", name): [name] for name in scene.mesh.near}
    for place, names in places.items():
        for name in names:
            if name in bodies_of(scene) and name not in kinds:
                what = f"{name!r} is a body, which cannot be named here"
                raise source.error(place, what, f"name a part of the shape; the body's own keys are in [bodies.{name}]")
            if name in scene.supports and name not in kinds:
                what = f"{name!r} is a support, which cannot be named here"
                constrained = " or ".join(map(repr, scene.supports[name].on))
                raise source.error(place, what, f"name the part of the shape that it holds: {constrained}")
            _refuse_absent(name, kinds, "entity", place, source)
    for name, load in scene.loads.items():
        _check_load(name, load, kinds, source)


def _check_load(name: str, load: Load, kinds: dict[str, str], source: Source) -> None:
    """Refuses a load on a kind of entity that it cannot act on."""
    accepted = load.kinds[load.kind].on
    for entity in load.on:
        if kinds[entity] not in accepted:
            raise source.error(
                ("loads", name, "on"),
                f"{article(load.kind)} cannot act on {entity!r}, which is {ENTITIES[kinds[entity]]}",
                f"name {any_of(accepted)}",
            )


def _check_place(name: str, quantity: Quantity, kinds: dict[str, str], source: Source) -> None:
    """Refuses a quantity that is taken at certain kinds of entities, and names none or another one.

    Args:
        kinds: of the entities by name; empty where a file holds them.
    """
    wanted, what, at = quantity.kinds[quantity.kind].on, quantity.kind.replace("_", " "), quantity.at
    if wanted and at is None:
        do = f'say where, as in at = "left": at {any_of(wanted)}'
        raise source.error(("quantities", name), f"a {what} needs a place", do)
    if wanted and at in kinds and kinds[at] not in wanted:
        found = f"a {what} cannot be taken at {at!r}, which is {ENTITIES[kinds[at]]}"
        raise source.error(("quantities", name, "at"), found, f"name {any_of(wanted)}")


def _check_formulas(scene: Scene, source: Source) -> None:
    """Refuses formulas that name what is neither a coordinate nor a parameter, and closed forms that name places."""
    for name, quantity in scene.quantities.items():
        refuse_places(("quantities", name, "reference"), quantity.reference, "a closed form", source)
    check_formulas(scene, scene.parameters, source)


def refuse_places(place: tuple[str, ...], value: object, what: str, source: Source) -> None:
    """Refuses a formula of places where one number is wanted.

    Args:
        place: its key.
        value: a formula, or a number.
        what: it is, for people.
        source: for messages.

    Raises:
        UserError: it names a coordinate.
    """
    if isinstance(value, Expression) and value.names.intersection(COORDINATES):
        raise source.error(place, f"{what} is one number: it cannot name x or y", "use [parameters] only")


def _check_mesh(scene: Scene, application: Application, source: Source) -> None:
    """Refuses a mesh without a size, and element orders, layers and levels that the application does not have."""
    if scene.mesh.size is None and scene.mesh.file is None:
        raise source.error(("mesh", "size"), "the mesh has no size", 'add size = "20 mm" to [mesh]')
    if "unit" in scene.mesh.model_fields_set and scene.mesh.file is None:
        raise source.error(
            ("mesh", "unit"),
            "this is the unit of the numbers of mesh.file, which the scene does not have",
            "leave it out: drawings say their unit, and the numbers of a .geo are metres (Dilate scales them)",
        )
    if scene.mesh.order not in (None, *application.orders):
        raise source.error(
            ("mesh", "order"),
            f"the application {application.name!r} has no elements of order {scene.mesh.order}",
            f"use one of: {', '.join(str(order) for order in application.orders)}",
        )
    if scene.mesh.layers is not None and "layers" not in application.mesh_keys:
        raise source.error(
            ("mesh", "layers"), f"the application {application.name!r} has no layers of elements", "leave it out"
        )
    if scene.mesh.levels > 1 and "levels" not in application.mesh_keys:
        raise source.error(
            ("mesh", "levels"), f"the application {application.name!r} has one mesh only", "leave it out"
        )
    _check_predicted_levels(scene, application, source)


def _check_predicted_levels(scene: Scene, application: Application, source: Source) -> None:
    """Refuses drags on more nested meshes than there are."""
    wanted, there = scene.predict.levels or 1, scene.mesh.levels
    if wanted <= there:
        return
    nested = "levels" in application.mesh_keys
    raise source.error(
        ("predict", "levels"),
        f"the mesh has {there} level{'s' * (there > 1)}, and {wanted} are asked for"
        if nested
        else f"the application {application.name!r} has one mesh only",
        f"set mesh.levels to {wanted} or more" if nested else "leave it out",
    )
