"""The cases as an expert would have FreeFEM do them: mesh moved, old factors kept, frames begun at the last ones."""

from documented import VERSION, play  # noqa: F401

PROBLEMS = {
    "static": "static_tuned.edp",
    "large_deformation": "large_tuned.edp",
    "motion": "motion_tuned.edp",
    "heat": "heat_tuned.edp",
    "flow": "flow_tuned.edp",
}
NOT_DONE = {"modes": "FreeFEM's EigenValue takes neither modes to begin at nor a factor that is kept"}
