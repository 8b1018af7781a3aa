"""SVG text made ready to be read: bounded, without what is not drawn, with the names of groups handed down."""

from __future__ import annotations

import re
from dataclasses import dataclass
from xml.etree import ElementTree

import numpy as np

from restshape.bounds import NESTING, OUTLINE_PIECES
from restshape.errors import UserError, printable, quoted
from restshape.scene.units import quantity
from restshape.shape.drawings.layer_names import REGION

SVG = "{http://www.w3.org/2000/svg}"
LABEL = "{http://www.inkscape.org/namespaces/inkscape}label"
HREFS = ("href", "{http://www.w3.org/1999/xlink}href")
GROUP_NAME = "restshape-group-"
"""Begins the attributes that hand down names of groups, numbered: shapes inherit all of them, the outer first."""
OWN_NAME = "restshape-name"
"""The attribute with the name of a shape itself."""
REGION_NAME = "restshape-region"
"""The attribute that hands down the name of a region."""
NO_SHAPE = "restshape-mark"
"""The class of groups that are no part of a shape: cut lines, notches."""
SHAPES = ("path", "rect", "circle", "ellipse", "line", "polyline", "polygon")
SILENT = ("defs", "symbol", "style", "title", "desc", "view")
"""Elements that no one expects to see."""
GROUPS = ("g", "use", "a", "switch", "svg")
NOT_DRAWN = ("clipPath", "mask", "marker", "pattern", "text", "image", "foreignObject", "metadata", "script", "filter")
LENGTHS = ("x", "y", "x1", "y1", "x2", "y2", "cx", "cy", "r", "rx", "ry", "width", "height")
PIXELS = {"px": 1.0, "in": 96.0, "pt": 96.0 / 72.0, "pc": 16.0, "cm": 96.0 / 2.54, "mm": 96.0 / 25.4}
"""User units in one of each unit, as CSS has them."""
WITH_UNIT = re.compile(rf"\s*([-+.\deE]+?)\s*({'|'.join(PIXELS)})\s*")
NO_NUMBER = re.compile("nan|inf", re.IGNORECASE)
"""What programs write for numbers that are none; no path, no transform and no length has these letters."""
PATH_CHARACTERS = 100
"""Characters of a path that count as one more shape."""
ATTRIBUTE_CHARACTERS = 20_000
"""Characters of other attributes, and of a style sheet: expressions that read them take the square of that."""


@dataclass(frozen=True)
class SvgTree:
    """A drawing in its own user units.

    Args:
        text: as XML.
        scale: metres in a user unit, along x and y.
        sized: whether the drawing says how large it is.
        names: of all its groups and shapes.
    """

    text: bytes
    scale: tuple[float, float]
    sized: bool
    names: tuple[str, ...]


def svg_tree(data: bytes, where: str) -> SvgTree:
    """The drawing that a file holds.

    Args:
        data: of the file.
        where: its name, for messages.

    Raises:
        UserError: it is no SVG, is nested too deeply, or draws too much.
    """
    try:
        root = ElementTree.fromstring(data)
    except ElementTree.ParseError as error:
        raise UserError(f"this is no SVG: {error}", where, "save it as plain SVG") from error
    if _tag(root) != "svg":
        raise UserError(f"this is no SVG: it is <{_tag(root)}>", where, "save it as plain SVG")
    _refuse_deep(root, where)
    scale, sized = _scale(root, where)
    names = _simplified(root, where)
    _refuse_much(root, where)
    for key in ("width", "height", "viewBox", "x", "y"):
        root.attrib.pop(key, None)
    return SvgTree(ElementTree.tostring(root), scale, sized, tuple(dict.fromkeys(names)))


def not_drawn(data: bytes) -> list[str]:
    """The tags of what a drawing has that is no part of a shape: texts, images, and elements that are not known."""
    found, waiting = [], [ElementTree.fromstring(data)]
    while waiting:
        for child in waiting.pop():
            tag = _tag(child)
            if NO_SHAPE in child.get("class", "").split():
                continue
            if tag in NOT_DRAWN or (tag and tag not in (*SHAPES, *GROUPS, *SILENT) and not tag.startswith("{")):
                found += [tag] if tag != "metadata" else []
            else:
                waiting.append(child)
    return found


def metadata_of(data: bytes, name: str) -> str:
    """The text of the metadata of an SVG that have this id; "" where there are none."""
    root = ElementTree.fromstring(data)
    return next(("".join(one.itertext()) for one in root.iter(f"{SVG}metadata") if one.get("id") == name), "")


def _tag(element: ElementTree.Element) -> str:
    """The tag of an element of SVG without its namespace; that of others with it, "" of comments."""
    return element.tag.removeprefix(SVG) if isinstance(element.tag, str) else ""


def _refuse_deep(root: ElementTree.Element, where: str) -> None:
    level, depth = [root], 0
    while level:
        level, depth = [child for element in level for child in element], depth + 1
        if depth > NESTING:
            raise UserError(f"groups within each other are deeper than {NESTING}", where, "ungroup some of them")


def _simplified(root: ElementTree.Element, where: str) -> list[str]:
    """Takes out what draws no outline, and hands names down; all names."""
    names, number = [], 0
    for element in list(root.iter()):
        for child in list(element):
            if _tag(child) in NOT_DRAWN or not _tag(child) or NO_SHAPE in child.get("class", "").split():
                element.remove(child)
        for place, child in enumerate(element):
            if _tag(child) == "symbol":
                if "viewBox" in child.attrib:
                    do = "turn copies of symbols into paths, or unlink them"
                    raise UserError(f"the symbol {child.get('id', '')!r} has a viewBox", where, do)
                child.tag = f"{SVG}g"
                element[place] = ElementTree.Element(f"{SVG}defs")
                element[place].append(child)
    for element in root.iter():
        tag, name = _tag(element), element.get(LABEL) or element.get("id") or ""
        _plain_numbers(element, where)
        if name and (name.lower().startswith(REGION) or REGION in element.get("class", "").split()):
            element.set(REGION_NAME, name)
        if name and tag in GROUPS and element is not root:
            number += 1
            element.set(f"{GROUP_NAME}{number}", name)
            names.append(name)
        elif name and tag in SHAPES:
            element.set(OWN_NAME, name)
            names.append(name)
    return names


def _plain_numbers(element: ElementTree.Element, where: str) -> None:
    """Turns lengths with a unit into user units; refuses texts that take too long to read, and what is no number."""
    for key, text in element.attrib.items():
        if key in (*LENGTHS, "d", "points", "transform") and (none := NO_NUMBER.search(text)):
            around = text[max(none.start() - 15, 0) : none.end() + 15]
            name = element.get(LABEL) or element.get("id") or ""
            what = f"{_tag(element)} {quoted(printable(name)) if name else 'without an id'}"
            what += f": {key} has no number at {quoted(printable(around))}"
            raise UserError(what, where, "write a finite number there")
        found = WITH_UNIT.fullmatch(text) if key in LENGTHS and len(text) < 100 else None
        if found:
            try:
                element.set(key, repr(float(found[1]) * PIXELS[found[2]]))
            except ValueError:
                raise UserError(f"{key} = {text!r} is no length", where, "save it as plain SVG") from None
        elif len(text) > ATTRIBUTE_CHARACTERS and key not in ("d", "points"):
            raise UserError(f"the attribute {key} has {len(text)} characters", where, "save it as plain SVG")
    if _tag(element) == "style" and len(element.text or "") > ATTRIBUTE_CHARACTERS:
        what = f"a style sheet has more than {ATTRIBUTE_CHARACTERS} characters"
        raise UserError(what, where, "save it as plain SVG")


def _refuse_much(root: ElementTree.Element, where: str) -> None:
    """Refuses more shapes than an outline may have pieces, copies (``use``) counted, before any is made."""
    by_id = {element.get("id"): element for element in root.iter()}
    known: dict[ElementTree.Element, tuple[int, int]] = {}

    def counted(element: ElementTree.Element, depth: int) -> tuple[int, int]:
        """How many shapes an element stands for, and how deep it is."""
        inner = known.get(element, (0, 0))
        if depth + inner[1] > 2 * NESTING:
            what = f"copies (use) within each other are deeper than {2 * NESTING}"
            raise UserError(what, where, "unlink the copies; none may hold itself")
        if element in known:
            return inner
        parts = list(element)
        if _tag(element) == "use":
            link = next((element.get(key, "") for key in HREFS if key in element.attrib), "")
            parts += [by_id[link[1:]]] if link.startswith("#") and link[1:] in by_id else []
        own = 1 + (len(element.get("d", "")) + len(element.get("points", ""))) // PATH_CHARACTERS
        found = [counted(part, depth + 1) for part in parts]
        known[element] = own + sum(one[0] for one in found), 1 + max((one[1] for one in found), default=0)
        return known[element]

    count = counted(root, 0)[0]
    if count > OUTLINE_PIECES:
        what = f"the drawing has {count:.6g} shapes with their copies, more than {OUTLINE_PIECES}"
        raise UserError(what, where, "draw less, or simplify its paths")


def _scale(root: ElementTree.Element, where: str) -> tuple[tuple[float, float], bool]:
    """Metres in a user unit along x and y, and whether the drawing says so by its width or height."""
    view = root.get("viewBox", "").replace(",", " ").split()
    sides = [_physical(root.get(key, "")) for key in ("width", "height")]
    sized = any(physical for _, physical in sides)
    pixel = 1.0 / PIXELS["in"] * quantity("1 in", "length")
    try:
        box = [float(word) for word in view[2:4]]
    except ValueError:
        box = []
    if len(view) != 4 or len(box) != 2 or not all(0.0 < side < np.inf for side in box):
        if view:
            raise UserError(f"viewBox = {root.get('viewBox')!r} is no box", where, "save it as plain SVG")
        return (pixel, pixel), sized
    found = [pixel * side / one if side else None for (side, _), one in zip(sides, box)]
    x, y = found
    if x is None or y is None:
        one = x or y or pixel
        return (one, one), sized
    if root.get("preserveAspectRatio", "").startswith("none"):
        return (x, y), sized
    return (min(x, y), min(x, y)), sized


def _physical(text: str) -> tuple[float, bool]:
    """Pixels of a side of a drawing, 0 where it says none, and whether it says so in a unit of length."""
    found = WITH_UNIT.fullmatch(f"{text} px" if re.fullmatch(r"[-+.\deE]+", text.strip()) else text)
    if not found:
        return 0.0, False
    try:
        side = float(found[1]) * PIXELS[found[2]]
    except ValueError:
        return 0.0, False
    return (side if 0.0 < side < np.inf else 0.0), found[2] != "px"
