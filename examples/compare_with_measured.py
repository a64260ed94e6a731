"""A run beside a measured curve
=============================

Compare the quick opening test with a table in the format of a test machine: semicolons, decimal
commas, degrees and N·cm. **The table is made up for this example; no machine measured it.** ::

    python examples/compare_with_measured.py --out DIR

writes the run, the table, comparison.png and comparison.json into DIR. On the command line, with
the same table::

    shellcut run opening --set mesh=quick --set motion.angle_deg=40 --set duration=2.5e-3 -o out
    shellcut compare out DIR/made_up.csv --x angle=Winkel --y torque=Drehmoment --window 10
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt

from shellcut import compare, opening_test

parser = argparse.ArgumentParser(description="a run beside a measured curve")
parser.add_argument("--out", type=Path, required=True, help="folder for the results")
options = parser.parse_args()

# %%
# Model
# -----
# The quick opening test, and the table that stands for a measurement.

case = opening_test("quick", angle_deg=40.0, duration=2.5e-3)

MADE_UP = """\
Erfunden: kein Messwert (made up: not measured)
Nr;Winkel [Grad];Drehmoment [Ncm]
1;0,0;0,00
2;4,0;0,31
3;8,0;5,87
4;12,0;9,62
5;16,0;12,10
6;20,0;13,34
7;24,0;14,02
8;28,0;14,45
9;32,0;14,20
10;36,0;14,71
"""

# %%
# Run
# ---

case.run(options.out, n_snapshot=0, progress=False)
table = options.out / "made_up.csv"
table.write_text(MADE_UP, encoding="utf-8")

# %%
# Picture
# -------
# Nodes are 5° apart along the cut; a window of twice that removes their sawtooth.

found = compare(options.out, table, columns=("Winkel", "Drehmoment"), window=10.0)
picture = plt.imread(found.plot(options.out / "comparison.png"))
plt.figure(figsize=(picture.shape[1] / 100, picture.shape[0] / 100), dpi=100).figimage(picture)
found.to_json(options.out / "comparison.json")

# %%
# Check
# -----
# The table was made up to lie near the run: peaks farther apart than a tenth would mean that
# columns or units were misread.

print(found)
assert abs(found.peak_simulated / found.peak_measured - 1.0) < 0.1
