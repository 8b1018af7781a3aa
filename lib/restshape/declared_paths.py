"""What declarations name by paths ``module:attribute``, imported where it is first needed."""

from __future__ import annotations

from importlib import import_module
from types import ModuleType

from restshape.errors import UserError


def declared(path: str, owner: str = "a declaration") -> object:
    """What a path ``module:attribute`` names, imported now.

    Args:
        path: as it is declared.
        owner: what declares it, for messages.

    Raises:
        UserError: there is no such module, or nothing of that name in it.
    """
    module, _, attribute = path.partition(":")
    try:
        found = import_module(module)
    except ModuleNotFoundError as error:
        # Another module that this one imports may be missing.
        if not error.name or not f"{module}.".startswith(f"{error.name}."):
            raise
        what = f"{owner} names {path!r}, and there is no module {error.name!r}"
        raise UserError(what, do="mend the path, or install the package that has the module") from None
    try:
        named: object = getattr(found, attribute)
    except AttributeError:
        what = f"{owner} names {path!r}, and its module has no {attribute!r}"
        raise UserError(what, do=_near(found, attribute)) from None
    return named


def _near(module: ModuleType, attribute: str) -> str:
    """What may have been meant: the nearest of a module's names, else those that it defines."""
    from difflib import get_close_matches

    known = [name for name, value in vars(module).items() if getattr(value, "__module__", "") == module.__name__]
    near = get_close_matches(attribute, known, 1)
    return f"did you mean {near[0]!r}?" if near else f"it has: {', '.join(known) or 'nothing of its own'}"
