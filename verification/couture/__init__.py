"""What verifies cloth."""

from restshape_studies.verification import StudyParameter, Verification

from restshape.application import Command

verification = Verification(
    validation="restshape_verification.couture.validation:CASES",
    hard_cases="restshape_verification.couture.stability:CASES",
    thesis="restshape_verification.couture.thesis:rows",
    parameters=(
        StudyParameter("effects.cloth.bending", values=("morley", "hinge", "nonlinear"), reference="morley", grid=True),
    ),
    scale="restshape_verification.couture.scale:scale_of",
    drapes="restshape_verification.couture.drapes:drapes",
    drags="restshape_verification.couture.drags:drags",
    random_scenes="restshape_verification.couture.random_scenes:SCENES",
    commands=(
        Command(
            "cloth-cycles",
            "show what makes cloth cycle for ever, and what cures it",
            "restshape_verification.couture.cycles",
        ),
        Command(
            "cloth-paths",
            "say whether edits of cloth in half as many frames end in the same drape, or in which two",
            "restshape_verification.couture.paths",
        ),
        Command(
            "garments",
            "drape garments to measure on the mannequins, and say how each rests and fits",
            "restshape_verification.couture.garments",
        ),
        Command(
            "garment-times",
            "time a shirt: from flat panels to rest, after edits, and steps of its motion, beside the thesis's",
            "restshape_verification.couture.garment_times",
        ),
    ),
)
