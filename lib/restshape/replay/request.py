"""What is to be replayed, and how."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, Self

from restshape import __version__
from restshape.application import Application, application_of
from restshape.calibration import Calibration
from restshape.policy import Policy
from restshape.policy import policy as policy_named
from restshape.replay.constraints import recorded_limits
from restshape.replay.rounding import load_scales
from restshape.scene.edit_script import Script
from restshape.scene.model import Scene
from restshape.surroundings import cpu_model

Measured = Literal["all", "residual", "nothing"]
"""What is known of each answer besides: its errors too, its residual alone, or nothing."""


@dataclass(frozen=True)
class Request:
    """One replay: all that its result depends on, but for the number of ranks.

    Args:
        scene: what the user wrote.
        script: its edits.
        application: of the scene.
        policy: what is reused.
        calibration: seconds a unit of counted work.
        petsc: words for PETSc's options database.
        predict: "none", "linear": frames of a drag by the design derivative at one of them, or "gmls": by those at
            several.
        overrides: ``key=value`` of the command line, which the scene has taken in.
        guided: as in `Context`.
        measured: beside each frame, off its time; no other column depends on it but notes of what is measured.
    """

    scene: Scene
    script: Script
    application: Application
    policy: Policy
    calibration: Calibration
    petsc: tuple[str, ...] = ()
    predict: str = "none"
    overrides: tuple[str, ...] = ()
    guided: bool = True
    measured: Measured = "all"

    @classmethod
    def of(
        cls,
        scene: Scene,
        script: Script | None = None,
        policy: str | None = None,
        guess: str | None = None,
        calibration: Calibration | None = None,
        petsc: Sequence[str] = (),
        predict: str = "none",
        overrides: Sequence[str] = (),
        guided: bool = True,
        measured: Measured = "all",
    ) -> Self:
        """What is asked for of a scene and a script, where nothing is said by its application's own ways.

        Args:
            scene: where it starts; script: its edits; None: the first shape alone.
            policy: its name; None: the scene's. guess: initial guess of iterative solves; None: the policy's best.
            calibration: None: the nominal one.
            petsc, predict, overrides, guided, measured: as of the class.
        """
        chosen = policy_named(policy or scene.solve.policy, guess)
        edits, known = script or Script.empty(scene), calibration or Calibration.load()
        app, words, given = application_of(scene), tuple(petsc), tuple(overrides)
        return cls(scene, edits, app, chosen, known, words, predict, given, guided, measured)

    def origin(self) -> dict[str, object]:
        """What results say of where they come from: scene, script, overrides, version, units and machine."""
        return {
            "scene": self.scene.path.name,
            "script": self.script.path.name if self.script.path else "",
            "overrides": list(self.overrides),
            "restshape": __version__,
            "units": {name: quantity.unit for name, quantity in self.scene.quantities.items()},
            "machine": cpu_model(),
        }

    def header(self) -> dict[str, object]:
        """What a recording says of how it was made."""
        return {
            **self.origin(),
            "scene_values": self.scene.raw,
            "script_text": self.script.path.read_text(errors="replace") if self.script.path else self.script.text,
            "title": self.scene.title,
            "load_scales": load_scales(self.scene),
            "limits": recorded_limits(self.scene.quantities),
            "app": self.application.name,
            "policy": self.policy.name,
            "guess": self.policy.guess,
            "predict": self.predict,
            "prediction": self._prediction() if self.predict == "gmls" else {},
            "calibration": self.calibration.as_dict(),
            "petsc_options": list(self.petsc),
        } | self._of_physics()

    def _of_physics(self) -> dict[str, object]:
        """What the physics of the application add."""
        return {
            key: value for one in self.application.physics for key, value in one.recorded_header(self.scene).items()
        }

    def _prediction(self) -> dict[str, object]:
        """What the scene says of how several samples are mixed, with the number of nested meshes filled in."""
        return self.scene.predict.model_dump() | {"levels": self.scene.predicted_levels}
