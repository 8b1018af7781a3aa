"""Quantities of modes that are compared with a tone, or with the first mode."""

from typing import Annotated

from pydantic import AfterValidator, Field

from restshape.analysis.modal.pitch import frequency_of
from restshape.errors import UserError, ValueProblem
from restshape.scene.quantity import QuantityKind
from restshape.scene.units import declare_dimension
from restshape.scene.values import Whole

INTERVAL = declare_dimension("interval", "cent", "5 cent")


def tone_name(name: str) -> str:
    """The name of a tone, as it is.

    Raises:
        ValueProblem: no tone has this name.
    """
    try:
        frequency_of(name)
    except UserError as error:
        raise ValueProblem(error.what, error.do) from None
    return name


ToneName = Annotated[str, AfterValidator(tone_name)]
Overtone = Annotated[Whole, Field(ge=2)]
"""2, 3, ...: that of mode 1 over itself is 1."""

COMPARED_TONES = {
    "cents": QuantityKind(
        ToneName,
        INTERVAL,
        "sum",
        True,
        '"C5": how far the frequency of mode 1, or of the one that `mode` names, lies above this tone; a negative '
        "number below it",
        takes=("mode",),
    ),
    "ratio": QuantityKind(
        Overtone, "number", "sum", True, "2: the frequency of mode 2 over that of mode 1, wherever both have gone since"
    ),
}
