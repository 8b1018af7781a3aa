"""What verifies furniture."""

from restshape_studies.verification import Verification

from restshape.application import Command

verification = Verification(
    validation="restshape_verification.furniture.validation:CASES",
    hard_cases="restshape_verification.furniture.stability:CASES",
    thesis="restshape_verification.furniture.thesis:rows",
    random_scenes="restshape_verification.furniture.random_scenes:SCENES",
    study="restshape_verification.furniture.plank_page:study_and_write",
    frame_check="restshape_verification.furniture.frame_check:plank_problem",
    commands=(
        Command("design-sessions", "try one target by three strategies", "restshape_verification.furniture.sessions"),
        Command(
            "fasteners", "print the strength of one fastener", "restshape_verification.furniture.fastener_strengths"
        ),
        Command(
            "pliant-joints",
            "print how utilisations follow the compliance of joints",
            "restshape_verification.furniture.pliant_joints",
        ),
        Command(
            "between-brackets",
            "put a board between two weak brackets",
            "restshape_verification.furniture.between_brackets",
        ),
        Command(
            "furniture-times",
            "print how long furniture takes, and what is missed",
            "restshape_verification.furniture.times_command",
        ),
    ),
)
