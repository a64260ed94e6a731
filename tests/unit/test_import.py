"""What ``import shellcut`` loads: a second's start is felt at each call of the command."""

import subprocess
import sys

# SciPy loads its parts when they are first used, by their dotted names: 0.3 s of the 0.9 s that
# the import took. The others are optional, or of one file format only.
LATER = (
    *("scipy.interpolate", "scipy.linalg", "scipy.optimize", "scipy.sparse", "scipy.spatial"),
    *("ezdxf", "gmsh", "matplotlib", "meshio", "pandas", "PIL", "pyvista", "rich", "svgpathtools"),
    "vtkmodules",
)


def test_heavy_packages_wait_until_they_are_used():
    script = f"import sys, shellcut; print([n for n in {LATER!r} if n in sys.modules])"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert done.stdout.strip() == "[]", done.stderr or done.stdout
