"""What verifies incompressible flow."""

from restshape_studies.verification import Verification

verification = Verification(
    validation="restshape_verification.flow.validation:CASES",
    hard_cases="restshape_verification.flow.stability:CASES",
    random_scenes="restshape_verification.flow.random_scenes:SCENES",
    thesis="restshape_verification.flow.thesis:rows",
)
