"""What verifies bridges."""

from restshape_studies.verification import Verification

from restshape.application import Command

verification = Verification(
    hard_cases="restshape_verification.bridge.stability:CASES",
    thesis="restshape_verification.bridge.thesis:rows",
    random_scenes="restshape_verification.bridge.random_scenes:SCENES",
    commands=(
        Command(
            "bridge-study", "compare analysis in every frame with that on demand", "restshape_verification.bridge.study"
        ),
    ),
)
