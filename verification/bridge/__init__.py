"""What verifies bridges."""

from restshape_studies.verification import Verification

verification = Verification(
    hard_cases="restshape_verification.bridge.stability:CASES",
    thesis="restshape_verification.bridge.thesis:rows",
    random_scenes="restshape_verification.bridge.random_scenes:SCENES",
)
