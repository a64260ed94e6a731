"""A small model file of a cut of any kind."""

FREE = """model = "free"
[membrane]
length = 6.0
width = 4.0
size = 0.5
clamp = ["bottom", "top"]
notch = 1.0
[tool]
kind = "blade"
length = 6.0
height = 3.0
shift = [-0.05, 0.0, 0.0]
[motion]
direction = [1, 0, 0]
speed = "6 m/s"
ramp = "0.1 ms"
duration = "0.5 ms"
"""
