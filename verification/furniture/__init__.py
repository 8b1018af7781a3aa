"""What verifies furniture."""

from restshape_studies.verification import Verification

verification = Verification(
    validation="restshape_verification.furniture.validation:CASES",
    hard_cases="restshape_verification.furniture.stability:CASES",
    thesis="restshape_verification.furniture.thesis:rows",
    random_scenes="restshape_verification.furniture.random_scenes:SCENES",
    study="restshape_verification.furniture.plank_page:study_and_write",
    frame_check="restshape_verification.furniture.frame_check:plank_problem",
)
