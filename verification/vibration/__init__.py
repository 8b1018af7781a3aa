"""What verifies solids that vibrate."""

from restshape_studies.verification import StudyParameter, Verification

from restshape.application import Command

verification = Verification(
    validation="restshape_verification.vibration.validation:CASES",
    hard_cases="restshape_verification.vibration.stability:CASES",
    parameters=(
        StudyParameter(
            "effects.dynamics.time_step", factors=(2.0, 0.5), reference=0.25, against="effects.dynamics.steps"
        ),
        StudyParameter("effects.dynamics.mass", ("consistent", "lumped"), reference="consistent"),
    ),
    thesis="restshape_verification.vibration.thesis:rows",
    random_scenes="restshape_verification.vibration.random_scenes:SCENES",
    commands=(
        Command(
            "resonance",
            "find where a window meets the resonance of a building",
            "restshape_verification.vibration.resonance",
        ),
    ),
)
