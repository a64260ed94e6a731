"""How much of each tolerance is used: ``python tests/verification/tolerances.py [ARGUMENT ...]``.

Runs pytest with the arguments, on tests/regression by default, and lists every comparison with a
number that is nearer to its bound than 70 %: of ``a == approx(b)`` the difference over what is
allowed, of ``a < b`` the smaller over the larger, of the cases of run.py, from a file that it has
written, the error over the band. Comparisons of arrays and by NumPy's functions are not seen.
"""

import argparse
import json
import re
import sys
import tempfile
from pathlib import Path

import numpy as np
import pytest

REGRESSION = str(Path(__file__).parents[1] / "regression")
SHOWN = 0.7


def use_of(explained):
    """Return the use of a comparison that pytest explains, with its two sides, or None."""
    found = re.match(r"(.+?) (==|<=?|>=?) (.+?)(?: ± (\S+))?$", explained.splitlines()[0])
    if not found:
        return None
    left, sign, right, allowed = found.groups()
    if (sign == "==") != (allowed is not None):
        return None
    try:  # numbers, or sums of some, as Python writes them
        a, b, band = (float(eval(text, {"np": np})) for text in (left, right, allowed or "0"))
    except (NameError, SyntaxError, TypeError, ValueError):
        return None
    if sign == "==":
        return abs(a - b) / band if band > 0.0 else None, f"{a:.6g}", f"{b:.6g} ± {band:.2g}"
    low, high = (a, b) if sign[0] == "<" else (b, a)
    return low / high if low > 0.0 and high > 0.0 else None, f"{a:.4g}", f"{sign} {b:.4g}"


class Uses:
    """A plugin of pytest that keeps the largest use of each comparison that holds."""

    def __init__(self):
        self.found, self.n_seen = {}, 0

    def pytest_assertion_pass(self, item, lineno, orig, expl):
        use = use_of(expl)
        if use is None or use[0] is None:
            return
        self.n_seen += 1
        place = f"{item.path.name}:{lineno} {item.name}"
        self.found[place] = max(self.found.get(place, use), use)


def of_gates(file):
    """Return the uses of the cases' gates in a file that run.py has written."""
    return {
        f"{result['id']} {check['quantity']}": (
            abs(check["error"]) / check["band"],
            f"{check['ours']:.6g}",
            f"{check['reference']:.6g} ± {check['band']:.2g}{' of it' * (not check['absolute'])}",
        )
        for result in json.loads(file.read_text())
        for check in result["checks"]
        if check["gate"] and check["band"] > 0.0
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--json", type=Path, help="gates, from a file of run.py; runs no tests")
    options, arguments = parser.parse_known_args()
    if options.json is not None:
        uses = of_gates(options.json)
        n_seen, status = len(uses), 0
    else:
        plugin = Uses()
        # Tests compiled without the hook must not be taken from the cache.
        with tempfile.TemporaryDirectory() as sys.pycache_prefix:
            told = ["-o", "enable_assertion_pass_hook=true", "-n", "0"]
            status = pytest.main([*told, *(arguments or [REGRESSION])], plugins=[plugin])
        uses, n_seen = plugin.found, plugin.n_seen
    near = sorted(((use, place) for place, use in uses.items() if use[0] > SHOWN), reverse=True)
    print(f"\n{n_seen} comparisons, {len(near)} of them use more than {100 * SHOWN:.0f} %")
    for (use, measured, bound), place in near:
        print(f"{100 * use:5.1f} %  {measured:>10} {bound:<22} {place}")
    return int(status)


if __name__ == "__main__":
    sys.exit(main())
