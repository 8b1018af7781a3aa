"""Places, directions and angles in space as scenes write them, and numbers in place of their formulas."""

from typing import Annotated, TypeVar

from restshape.scene.expressions import Expression, Value
from restshape.scene.units import UnitError
from restshape.scene.values import InSI, Strict

Size = Annotated[Value, InSI("length", formula=True)]
Ratio = Annotated[Value, InSI("number", formula=True)]
Turn = Annotated[Value, InSI("angle", formula=True)]
Form = TypeVar("Form", bound=Strict)
Place = tuple[Size, Size, Size]
Direction = tuple[Ratio, Ratio, Ratio]
Angles = tuple[Turn, Turn, Turn]
ORIGIN = (0.0, 0.0, 0.0)


def number(value: Value, parameters: dict[str, float]) -> float:
    """A value as a number.

    Raises:
        UnitError: its formula gives none.
    """
    if not isinstance(value, Expression):
        return value
    found = float(value.evaluate(0.0, 0.0, parameters))
    if not abs(found) < float("inf"):
        raise UnitError(f"the formula {value.text!r} gives {found}", "change it, or the parameters")
    return found


def evaluated(form: Form, parameters: dict[str, float]) -> Form:
    """A copy of a model, of numbers and tuples of numbers, with numbers in place of formulas.

    Raises:
        UnitError: a formula gives no number.
    """
    names = type(form).model_fields
    return form.model_copy(update={name: _number_of(getattr(form, name), parameters) for name in names})


def _number_of(value: Value | tuple[Value, ...], parameters: dict[str, float]) -> float | tuple[float, ...]:
    """A number in place of a formula, and in tuples of them."""
    if isinstance(value, tuple):
        return tuple(number(part, parameters) for part in value)
    return number(value, parameters)
