"""What verifies the applications here: what is named by its path is in `verification`, and imported when asked for."""

from restshape_studies.verification import StudyParameter, Verification

from restshape.application import Command

BENDING = ("morley", "hinge", "nonlinear")
CASES = "sample_applications.verification"

plane = Verification(
    validation=f"{CASES}:VALIDATION",
    hard_cases=f"{CASES}:HARD",
    random_scenes=f"{CASES}:RANDOM",
    commands=(Command("sample-of-plane", "print nothing", "sample_applications.names_command"),),
)
STEP, STEPS = "effects.dynamics.time_step", "effects.dynamics.steps"
moving = Verification(
    parameters=(
        StudyParameter(STEP, factors=(2.0, 0.5), reference=0.25, against=STEPS),
        StudyParameter("effects.dynamics.mass", ("consistent", "lumped"), reference="consistent"),
    )
)
modes = Verification(
    parameters=(
        StudyParameter("effects.modal.model", ("solid", "plate"), reference="solid", grid=True),
        StudyParameter("mesh.layers", (1, 2, 3), reference=2),
    )
)
cloth = Verification(
    parameters=(StudyParameter("effects.cloth.bending", values=BENDING, reference="morley", grid=True),),
    scale=f"{CASES}:cloth_scale",
)
