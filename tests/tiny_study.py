"""A study whose runs take a second each."""

SETTINGS = {
    "membrane.length": 6,
    "membrane.width": 4,
    "membrane.size": 0.5,
    "notch": 1,
    "travel": 2.0,
    # Said, or each study would make sure that the kernels of the other path are there, too.
    "fracture.path": "edges",
    "output.frames": 2,
    "output.rows": 300,
}
ANGLES = {"wedge_half_angle_deg": "10,14,18,22"}
