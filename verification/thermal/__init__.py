"""What verifies heat that bodies conduct and that fluids carry."""

from restshape_studies.verification import StudyParameter, Verification
from restshape_verification.flow import PARAMETERS

verification = Verification(
    validation="restshape_verification.thermal.validation:CASES",
    hard_cases="restshape_verification.thermal.stability:CASES",
    thesis="restshape_verification.thermal.thesis:rows",
    random_scenes="restshape_verification.thermal.random_scenes:SCENES",
    scale="restshape_verification.flow.scale:fluid_scale",
    parameters=(
        StudyParameter(
            "effects.storage.time_step",
            factors=(2.0, 0.5),
            reference=0.25,
            against="effects.storage.steps",
            effect="storage",
        ),
        StudyParameter("effects.storage.capacity", ("consistent", "lumped"), reference="consistent", effect="storage"),
        *PARAMETERS,
        StudyParameter("effects.heat.coupling", ("monolithic", "split"), reference="monolithic", effect="heat"),
    ),
)
