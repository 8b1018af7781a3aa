"""What verifies incompressible flow."""

from restshape_studies.verification import StudyParameter, Verification

PARAMETERS = (
    StudyParameter(
        "effects.flow.time_step", factors=(2.0, 0.5), reference=0.25, against="effects.flow.steps", effect="flow"
    ),
    StudyParameter("effects.flow.scheme", ("bdf2", "backward_euler"), reference="bdf2", effect="flow"),
    StudyParameter("effects.flow.carry", ("auto", "ale", "remap"), reference="auto", effect="flow"),
)
"""What studies of accuracy vary of flow in time."""
verification = Verification(
    validation="restshape_verification.flow.validation:CASES",
    hard_cases="restshape_verification.flow.stability:CASES",
    random_scenes="restshape_verification.flow.random_scenes:SCENES",
    scale="restshape_verification.flow.scale:fluid_scale",
    parameters=PARAMETERS,
    thesis="restshape_verification.flow.thesis:rows",
)
