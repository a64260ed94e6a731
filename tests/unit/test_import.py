"""What ``import shellcut`` loads: a second's start is felt at each call of the command."""

import pkgutil
import subprocess
import sys
from importlib import import_module

import shellcut

# Parts of SciPy, and packages that are optional or of one file format only.
LATER = (
    *("scipy.interpolate", "scipy.linalg", "scipy.optimize", "scipy.sparse", "scipy.spatial"),
    *("ezdxf", "gmsh", "matplotlib", "meshio", "pandas", "PIL", "rich", "shapely"),
)


def test_heavy_packages_wait_until_they_are_used():
    script = f"import sys, shellcut; print([n for n in {LATER!r} if n in sys.modules])"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert done.stdout.strip() == "[]", done.stderr or done.stdout


def test_no_function_hides_a_package():
    for found in pkgutil.iter_modules(shellcut.__path__):
        if found.name != "__main__":
            module = import_module(f"shellcut.{found.name}")
            assert getattr(shellcut, found.name) is module, found.name
    import shellcut.report.page as page

    assert page is shellcut.report.page


def test_what_a_user_builds_with_is_public():
    from shellcut import material

    # a law of one's own is written in a file beside these
    inner = {"LAWS", "Material", "MaterialPoint", "PointLaw", "PointState", "register"}
    assert set(material.__all__) - inner <= set(shellcut.__all__)
    assert {"meshing", "tool_shapes"} <= set(shellcut.__all__)
