"""What verifies static solids."""

from restshape_studies.verification import Verification

from restshape.application import Command

verification = Verification(
    validation="restshape_verification.solid.validation:CASES",
    hard_cases="restshape_verification.solid.stability:CASES",
    thesis="restshape_verification.solid.thesis:rows",
    random_scenes="restshape_verification.solid.random_scenes:SCENES",
    commands=(
        Command(
            "incompressible", "print which elements lock at nu = 0.4999", "restshape_verification.solid.incompressible"
        ),
    ),
)
