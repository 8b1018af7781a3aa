"""What verifies cantilevers."""

from restshape_studies.verification import Verification

verification = Verification(
    hard_cases="restshape_verification.cantilever.stability:CASES",
    thesis="restshape_verification.cantilever.thesis:rows",
    random_scenes="restshape_verification.cantilever.random_scenes:SCENES",
)
