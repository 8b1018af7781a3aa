"""What verifies plates that sound."""

from restshape_studies.verification import StudyParameter, Verification

from restshape.application import Command

verification = Verification(
    validation="restshape_verification.metallophone.validation:CASES",
    hard_cases="restshape_verification.metallophone.stability:CASES",
    thesis="restshape_verification.metallophone.thesis:rows",
    parameters=(
        StudyParameter("effects.modal.model", ("solid", "plate"), reference="solid", grid=True),
        StudyParameter("mesh.layers", (1, 2, 3), reference=2),
    ),
    random_scenes="restshape_verification.metallophone.random_scenes:SCENES",
    commands=(
        Command(
            "bar-accuracy",
            "compare models of a free bar with 3D elasticity",
            "restshape_verification.metallophone.accuracy",
        ),
    ),
)
