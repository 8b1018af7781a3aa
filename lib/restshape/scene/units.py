"""Numbers with units: what a user writes, turned into SI."""

import math
import re
import sys
from functools import lru_cache

from restshape import bounds
from restshape.errors import UserError, ValueProblem, quoted

Powers = tuple[int, ...]
"""Powers of the base units, in the order of `BASE`."""

BASE = ("m", "kg", "s", "K", "rad", "A", "mol")

NONE: Powers = (0,) * len(BASE)

DIMENSIONS: dict[str, Powers] = {
    "number": (0, 0, 0, 0, 0, 0, 0),
    "length": (1, 0, 0, 0, 0, 0, 0),
    "area": (2, 0, 0, 0, 0, 0, 0),
    "angle": (0, 0, 0, 0, 1, 0, 0),
    "time": (0, 0, 1, 0, 0, 0, 0),
    "frequency": (0, 0, -1, 0, 0, 0, 0),
    "mass": (0, 1, 0, 0, 0, 0, 0),
    "velocity": (1, 0, -1, 0, 0, 0, 0),
    "acceleration": (1, 0, -2, 0, 0, 0, 0),
    "force": (1, 1, -2, 0, 0, 0, 0),
    "moment": (2, 1, -2, 0, 0, 0, 0),
    "bending stiffness": (2, 1, -2, 0, 0, 0, 0),
    "pressure": (-1, 1, -2, 0, 0, 0, 0),
    "stiffness": (0, 1, -2, 0, 0, 0, 0),
    "density": (-3, 1, 0, 0, 0, 0, 0),
    "body force": (-2, 1, -2, 0, 0, 0, 0),
    "temperature": (0, 0, 0, 1, 0, 0, 0),
    "power": (2, 1, -3, 0, 0, 0, 0),
    "current": (0, 0, 0, 0, 0, 1, 0),
    "amount": (0, 0, 0, 0, 0, 0, 1),
}

MASS_BY_AREA: Powers = (-2, 1, 0, 0, 0, 0, 0)
"""What sheets are sold by, and is taken for their density."""

EXAMPLES = {
    "number": "0.3",
    "length": '"12 mm"',
    "area": '"4 cm^2"',
    "angle": '"30 deg"',
    "time": '"0.5 s"',
    "frequency": '"440 Hz"',
    "mass": '"2 kg"',
    "velocity": '"1.5 m/s"',
    "acceleration": '"9.81 m/s^2"',
    "force": '"5 kN"',
    "moment": '"3 N m"',
    "bending stiffness": '"5e-6 N m"',
    "pressure": '"210 GPa"',
    "stiffness": '"35 kN/m"',
    "density": '"7850 kg/m^3"',
    "body force": '"77 kN/m^3"',
    "temperature": '"20 degC"',
    "power": '"60 W"',
    "current": '"2 A"',
    "amount": '"3 mol"',
}

SYMBOLS = {
    "number": "",
    "length": "m",
    "area": "m^2",
    "angle": "rad",
    "time": "s",
    "frequency": "Hz",
    "mass": "kg",
    "velocity": "m/s",
    "acceleration": "m/s^2",
    "force": "N",
    "moment": "J",
    "bending stiffness": "N m",
    "pressure": "Pa",
    "stiffness": "N/m",
    "density": "kg/m^3",
    "body force": "N/m^3",
    "temperature": "K",
    "power": "W",
    "current": "A",
    "amount": "mol",
}
"""SI units of dimensions, as they are shown."""

DECLARED_IN: dict[str, str] = dict.fromkeys(DIMENSIONS, __name__)
"""Modules that dimensions are declared in."""

PREFIXES = {"": 1.0, "p": 1e-12, "n": 1e-9, "u": 1e-6, "µ": 1e-6, "μ": 1e-6, "m": 1e-3, "c": 1e-2}
PREFIXES |= {"k": 1e3, "M": 1e6, "G": 1e9, "T": 1e12}

PREFIXED: dict[str, tuple[float, Powers]] = {
    "m": (1.0, DIMENSIONS["length"]),
    "g": (1e-3, DIMENSIONS["mass"]),
    "s": (1.0, DIMENSIONS["time"]),
    "N": (1.0, DIMENSIONS["force"]),
    "Pa": (1.0, DIMENSIONS["pressure"]),
    "Hz": (1.0, DIMENSIONS["frequency"]),
    "J": (1.0, DIMENSIONS["moment"]),
    "W": (1.0, DIMENSIONS["power"]),
    "A": (1.0, DIMENSIONS["current"]),
    "mol": (1.0, DIMENSIONS["amount"]),
    "C": (1.0, (0, 0, 1, 0, 0, 1, 0)),
    "V": (1.0, (2, 1, -3, 0, 0, -1, 0)),
    "ohm": (1.0, (2, 1, -3, 0, 0, -2, 0)),
    "F": (1.0, (-2, -1, 4, 0, 0, 2, 0)),
    "Wb": (1.0, (2, 1, -2, 0, 0, -1, 0)),
}

PLAIN: dict[str, tuple[float, Powers]] = {
    "in": (0.0254, DIMENSIONS["length"]),
    "ft": (0.3048, DIMENSIONS["length"]),
    "t": (1e3, DIMENSIONS["mass"]),
    "min": (60.0, DIMENSIONS["time"]),
    "h": (3600.0, DIMENSIONS["time"]),
    "bar": (1e5, DIMENSIONS["pressure"]),
    "psi": (6894.757293168361, DIMENSIONS["pressure"]),
    "ksi": (6894757.293168361, DIMENSIONS["pressure"]),
    "lb": (0.45359237, DIMENSIONS["mass"]),
    "lbf": (4.4482216152605, DIMENSIONS["force"]),
    "rad": (1.0, DIMENSIONS["angle"]),
    "deg": (math.pi / 180, DIMENSIONS["angle"]),
    "°": (math.pi / 180, DIMENSIONS["angle"]),
    "K": (1.0, DIMENSIONS["temperature"]),
    "%": (0.01, DIMENSIONS["number"]),
    "cent": (1.0, DIMENSIONS["number"]),
}

ZEROS = {"degC": 273.15, "°C": 273.15}
"""Temperatures [K] at which scales begin that are no units: a difference on them is one in K."""

SCALED = {f"scale_{k}": scale for k, scale in enumerate(ZEROS)}
"""Scales by the names that mark them in formulas."""

LEAST = {"temperature": (0.0, "absolute zero, 0 K or -273.15 degC")}
"""The least value in SI units that there is of a dimension, and what it is."""

UNITS = PLAIN | {
    p + name: (scale * f, powers) for name, (f, powers) in PREFIXED.items() for p, scale in PREFIXES.items()
}

WORDS = {"m": "meter metre", "in": "inch inche", "ft": "foot feet", "s": "sec second", "min": "minute", "h": "hr hour"}
WORDS |= {"g": "gram", "kg": "kilogram kilo", "N": "newton", "deg": "degree", "rad": "radian", "mm": "millimeter"}
"""Units as people write them out, without an s at the end."""
WRITTEN_OUT = {word: name for name, words in WORDS.items() for word in words.split()}

UNKNOWN = "is not a known unit"
KNOWN_UNITS = (
    f"use {', '.join([*PREFIXED, *PLAIN, 'degC'])}, or a prefix and one of {', '.join(PREFIXED)}, as in mm, kN or GPa"
)
"""What to write in place of a unit that is not known."""

NUMBER_UNIT = re.compile(
    r"\s*([+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?)"
    r"\s*((?:(?<=\s)1/)?(?![eE][+-]?\d)[A-Za-zµμ°%](?:[\w\sµμ°%^*/.²³·-]|/\s*\([A-Za-zµμ°%][\w\sµμ°%^*.²³·-]*\))*)?\s*$"
)
MEASURE = re.compile(r"(?<![\w.])((?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?)\s*([A-Za-zµμ°%]+)(?!\w)(\s*(?:\^|\*\*))?")
FACTOR = re.compile(r"([*/·\s]*)([A-Za-zµμ°%]+)(?:\^?(-?\d+))?\s*")
GROUP = re.compile(r"/\s*\(([^()]*)\)")


class UnitError(ValueProblem):
    """A number with a unit that cannot be read, or of the wrong dimension."""


def declare_dimension(name: str, unit_text: str, example: str, least: float | None = None) -> str:
    """The name of a dimension, known from now on to all that reads numbers and formulas.

    Args:
        name: as messages say it, such as ``conductivity``.
        unit_text: its SI unit, such as ``W/(m K)``.
        example: a number that may stand in a scene, such as ``50 W/(m K)``.
        least: the least value in SI units that there is of it; None where there is none.

    Raises:
        UserError: the name stands for another dimension already; the message names both modules.
    """
    factor, powers = unit(unit_text)
    if factor != 1.0:
        raise UnitError(f"{unit_text!r} is no SI unit")
    module = str(sys._getframe(1).f_globals.get("__name__"))
    if DIMENSIONS.setdefault(name, powers) != powers:
        what = f"the dimension {name!r} is that of {unit_text} in {module}, and that of {in_units(DIMENSIONS[name])}"
        raise UserError(f"{what} in {DECLARED_IN[name]}", do="give one of them another name")
    DECLARED_IN.setdefault(name, module)
    EXAMPLES.setdefault(name, f'"{example}"')
    SYMBOLS.setdefault(name, unit_text)
    if least is not None:
        LEAST.setdefault(name, (least, f"{least:g}"))
    return name


def reads_as_quantity(text: str) -> bool:
    """Whether the text is a number, with or without something that looks like a unit."""
    match = NUMBER_UNIT.match(text) if len(text) <= bounds.QUANTITY_CHARACTERS else None
    if match is not None and _subtracts(match[2] or ""):
        return False
    if match is None or "(" not in (match[2] or ""):
        return match is not None
    # In a formula a parenthesis may hold parameters: of a unit it holds several factors that are all units.
    words = [re.findall(r"[A-Za-zµμ°%]+", group) for group in GROUP.findall(match[2])]
    return all(len(group) > 1 and all(word in UNITS for word in group) for group in words)


def _subtracts(unit: str) -> bool:
    """Whether what follows a number is no unit, as in "25 mm - t": a minus in one stands before an exponent alone.

    A name such as N-m is one that is not known.
    """
    ends = [*re.finditer(r"\s*-\s*", unit)]
    apart = any(one[0] != "-" for one in ends)
    named = any(re.match(r"[A-Za-zµμ°%]", unit[one.end() :]) for one in ends)
    return apart or (named and not all(word in UNITS for word in re.findall(r"[A-Za-zµμ°%]+", unit)))


@lru_cache(maxsize=1024)
def unit(text: str) -> tuple[float, Powers]:
    """The factor to SI of a unit such as ``kg/m^3`` or ``W/(m K)``, and its powers of the base units.

    Raises:
        UnitError: a unit that is not known.
    """
    plain = text.strip().replace("²", "^2").replace("³", "^3").removeprefix("1")
    factor, powers = 1.0, NONE
    for group in GROUP.findall(plain):
        scale, own = _product(group, text)
        if not scale:
            raise UnitError(f"{quoted(text.strip())} is too large a unit", "write a smaller one")
        factor, powers = factor / scale, tuple(p - q for p, q in zip(powers, own))
    rest = GROUP.sub(" ", plain)
    scale, own = _product(rest, text) if rest.strip() else (1.0, NONE)
    return factor * scale, tuple(p + q for p, q in zip(powers, own))


def _product(plain: str, text: str) -> tuple[float, Powers]:
    """The factor and the powers of units that are multiplied and divided.

    Args:
        plain: of these, without parentheses.
        text: the whole unit, for messages.
    """
    factor, powers, position = 1.0, NONE, 0
    while position < len(plain):
        match = FACTOR.match(plain, position)
        if match is None or match[2] not in UNITS or match[1].count("/") > 1:
            raise _unknown_unit(match[2] if match else "", text)
        scale, own = UNITS[match[2]]
        # a slash holds for the factor behind it only: "N/m s" is (N/m) s
        sign = -1 if "/" in match[1] else 1
        exponent = sign * _exponent(match[3] or "1", text)
        factor *= scale**exponent
        powers = tuple(p + exponent * q for p, q in zip(powers, own))
        position = match.end()
    return factor, powers


def _exponent(digits: str, text: str) -> int:
    """The power of a unit.

    Raises:
        UnitError: it is larger than any that is meant.
    """
    if len(digits) > 3 or abs(int(digits)) > bounds.UNIT_POWER:
        raise UnitError(
            f"{quoted(text.strip())} has a unit to a power beyond {bounds.UNIT_POWER}", "write a smaller one"
        )
    return int(digits)


def _unknown_unit(word: str, text: str) -> UnitError:
    """The error of a word that is no unit; empty where the text cannot be read at all."""
    if word in ZEROS:
        return UnitError(f"{quoted(text.strip())} holds a scale of temperatures, which is no unit", "write K")
    word = word or text.strip()
    alike = [name for name in UNITS if name.lower() == word.lower() and name != word]
    if written := WRITTEN_OUT.get(word.lower().removesuffix("s")):
        alike = [written]
    elif word == "degF":
        return UnitError(f"{quoted(text.strip())} {UNKNOWN}", "write degC: (77 - 32)*5/9 = 25 degC")
    do = f"did you mean {' or '.join(map(repr, alike))}?" if alike else KNOWN_UNITS
    return UnitError(f"{quoted(text.strip())} {UNKNOWN}", do)


def spelled(powers: Powers) -> str:
    """A name for people of a dimension given by its powers."""
    named = [name for name, own in DIMENSIONS.items() if own == powers]
    if named:
        return named[0]
    return f"quantity in {in_units(powers)}"


def in_units(powers: Powers) -> str:
    """The SI unit of a dimension given by its powers, as `unit` reads it, such as ``kg/m^2``."""
    ordered = [*BASE[1::-1], *BASE[2:]], [*powers[1::-1], *powers[2:]]
    named = [(base, p) for base, p in zip(*ordered) if p]
    above, below = (
        [base if abs(p) == 1 else f"{base}^{abs(p)}" for base, p in named if p * sign > 0] for sign in (1, -1)
    )
    return "/".join([" ".join(above) or "1", *below])


def article(noun: str) -> str:
    """The noun with its indefinite article."""
    return f"{'an' if noun[0] in 'aeiou' else 'a'} {noun}"


def quantity(value: object, dimension: str | None) -> float:
    """The value in SI units.

    Args:
        value: a number (taken as SI), or text such as ``"12 mm"``.
        dimension: one of DIMENSIONS; None takes any.

    Raises:
        UnitError: not a finite number, an unknown unit, a unit of another dimension, or beyond what there can be of it.
    """
    number, dimension = finite_quantity(value, dimension)
    refuse_impossible(number, dimension)
    return number


def finite_quantity(value: object, dimension: str | None) -> tuple[float, str | None]:
    """The same, however large it is, and its dimension as far as that is known.

    Raises:
        UnitError: not a finite number, an unknown unit, or a unit of another dimension.
    """
    example = f"write a number or {EXAMPLES[dimension]}" if dimension else 'write a number or "12 mm"'
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise UnitError(f"a number is wanted here, not {value!r}", example)
    factor, zero = 1.0, 0.0
    if isinstance(value, str):
        match = NUMBER_UNIT.match(value) if len(value) <= bounds.QUANTITY_CHARACTERS else None
        if match is None:
            raise UnitError(f"{quoted(value)} is not a number with a unit", example)
        if match[2]:
            zero = ZEROS.get(match[2].strip(), 0.0)
            factor, powers = UNITS["K"] if zero else _unit_of(value, match[2])
            if zero and dimension not in (None, "temperature") and powers == DIMENSIONS[dimension]:
                what = f"{value!r} is a temperature on a scale, but {article(dimension)} is wanted"
                raise UnitError(what, f"write the difference in K: {example}")
            if dimension is not None and powers != DIMENSIONS[dimension]:
                example = _meant(match, factor, powers, dimension) or example
                raise UnitError(f"{value!r} is {article(spelled(powers))}, but {article(dimension)} is wanted", example)
        value = match[1]
    number = _as_float(value) * factor + zero
    if not math.isfinite(number):
        shown = quoted(value) if isinstance(value, str) else "the number" if isinstance(value, int) else value
        raise UnitError(f"{shown} is not a finite number", "write a finite number")
    return number, "temperature" if zero else dimension


def _meant(match: re.Match[str], factor: float, powers: Powers, dimension: str) -> str:
    """What to write in place of a number whose unit is one of another dimension; empty where nothing is known.

    Args:
        match: of NUMBER_UNIT, with a unit.
        factor: to SI of that unit.
        powers: of that unit.
        dimension: that is wanted.
    """
    number, text = match[1], match[2].strip()
    if dimension == "density" and powers == MASS_BY_AREA:
        return (
            "divide it by the thickness, for rho times thickness is the mass by area: "
            f'{number} {text} that are 0.4 mm thick have rho = "{float(number) * factor / 4e-4:.6g} kg/m^3"'
        )
    if dimension == "temperature" and text == "C":
        return f'C is the coulomb: write "{number} degC"'
    if dimension == "temperature" and text == "F":
        return f'F is the farad, and degrees Fahrenheit are not read: write "{(float(number) - 32) / 1.8:.6g} degC"'
    if re.search(r"\*\s*t\b", text):
        given = f"{number} {text[: text.index('*')].strip()}"
        return f't is the tonne in a unit; if it is the time, write a = "{given}" in [parameters], and "a*t/(1 s)" here'
    return ""


def _unit_of(value: str, text: str) -> tuple[float, Powers]:
    """The unit of a number, as `unit` gives it.

    Raises:
        UnitError: it is not known; of what is rather a formula, it says how to write that.
    """
    try:
        return unit(text)
    except UnitError as error:
        if error.what.endswith(UNKNOWN) and (do := _as_formula(value)):
            what = f"{quoted(value)} reads as one number with the unit {quoted(text.strip())}, which is not known"
            raise UnitError(what, do) from None
        raise error


def _as_formula(value: str) -> str:
    """How to write numbers with units as a formula that begins with one of them; empty where none does.

    A number with one unit stands in parentheses; one with a compound unit, which formulas do not read, is a parameter.
    """
    sign = "-" if value.strip()[:1] == "-" else ""
    pieces = re.split(r"(?<![\^*])\s*([*/+-])\s*(?=[\d.])", value.strip().lstrip("+-"))
    found = [_leading(piece) for piece in pieces[::2]]
    numbers = [one for one in found if one is not None]
    if len(numbers) < len(found) or (len(pieces) == 1 and not numbers[0][1]):
        return ""
    plain = all(re.fullmatch(r"\S*\s*[A-Za-zµμ°%]*", number) for number, _ in numbers)
    units = [re.search(r"[A-Za-zµμ°%]$|[A-Za-zµμ°%]\W", number) is not None for number, _ in numbers]
    names = [
        number if not has_unit else f"({number})" if plain else "abcdef"[k % 6]
        for k, ((number, _), has_unit) in enumerate(zip(numbers, units))
    ]
    written = sign + "".join(name + rest + op for name, (_, rest), op in zip(names, numbers, [*pieces[1::2], ""]))
    if plain:
        return f'if it is a formula, write "{written}"'
    given = ", ".join(f'{name} = "{number}"' for name, (number, _) in zip(names, numbers) if name != number)
    return f'if it is a formula, write {given} in [parameters], and "{written}" here'


def _leading(piece: str) -> tuple[str, str] | None:
    """The number at the beginning of a text with its known unit, and what stands behind it; None without a number."""
    match = NUMBER_UNIT.match(piece)
    if match is None:
        number = re.match(r"[\d.]+(?:[eE][+-]?\d+)?\s*(?=[*/+-])", piece)
        return (number[0], piece[number.end() :]) if number else None
    if not match[2]:
        return match[1], ""
    position = 0
    while (factor := FACTOR.match(match[2], position)) and factor[2] in UNITS:
        position = factor.end()
    if position == 0:
        return None
    rest = match[2][position:]
    return f"{match[1]} {match[2][:position].strip()}", rest if rest[:1] in "*/-+" else ""


def _as_float(value: float | str) -> float:
    """A whole number, or the text of a number, as a float; infinite where it is too large for one."""
    try:
        return float(value)
    except OverflowError:
        return math.inf


def refuse_impossible(number: float, dimension: str | None) -> None:
    """Refuses a number in SI units that no quantity of a dimension can have.

    Raises:
        UnitError: it is less than the least one, or beyond all that can be computed with.
    """
    largest = bounds.LENGTH if dimension == "length" else bounds.NUMBER
    if abs(number) > largest:
        symbol = f" {SYMBOLS[dimension]}" if dimension and SYMBOLS[dimension] else ""
        raise UnitError(
            f"{number:.6g}{symbol} is beyond {largest:g}{symbol}", "write a smaller number, or check its unit"
        )
    least, what = LEAST.get(dimension or "", (-math.inf, ""))
    if number < least:
        raise UnitError(
            f"a {dimension} of {number:.6g} {SYMBOLS[dimension or '']} is below {what}", "write a higher one"
        )


def on_scale(number: float, scale: str) -> float:
    """The temperature [K] of a number on a scale.

    Raises:
        UnitError: it is below absolute zero.
    """
    refuse_impossible(number + ZEROS[scale], "temperature")
    return number + ZEROS[scale]


MARKED = {f"unit_{k}": powers for k, (_, powers) in enumerate(UNITS.values())}
"""Powers of units by the names that mark numbers with units in formulas."""
MARKS = dict(zip(UNITS, MARKED))


def in_si(formula: str, marked: bool = False) -> str:
    """The formula with numbers such as ``3 mm`` in it replaced by those in SI units.

    Temperatures on scales are marked, for a sign before them belongs to them: ``(20.0@scale_0)`` is ``20 degC``.

    Args:
        formula: as it is written.
        marked: other numbers with units are marked as well, by the names in `MARKED`.

    Raises:
        UnitError: a power right behind a unit, which could mean the unit or the number.
    """

    def replaced(match: re.Match[str]) -> str:
        if match[2] not in UNITS and match[2] not in ZEROS:
            return match[0]
        if match[3]:
            raise UnitError(f"{match[0].strip()!r} could mean two things", f"write ({match[1]} {match[2]})^...")
        if match[2] in ZEROS:
            mark = next(name for name, scale in SCALED.items() if scale == match[2])
            return f"({float(match[1])!r}@{mark})"
        mark = f"@{MARKS[match[2]]}" * marked
        return f"({float(match[1]) * UNITS[match[2]][0]!r}{mark})"

    return MEASURE.sub(replaced, formula)


def length_unit(text: str, where: str) -> float:
    """Metres in one unit of length named by the text.

    Raises:
        UserError: no such unit, or not of length.
    """
    try:
        return quantity(f"1 {text}", "length")
    except UnitError as error:
        raise UserError(error.what, where, 'use "m", "cm", "mm", "in" or "ft"') from error
