"""Print name and licence of every package of this environment, as its metadata tell."""

import json
from importlib.metadata import distributions

licences = {}
for package in distributions():
    said = package.metadata
    declared = said["License-Expression"], (said["License"] or "").split("\n")[0]
    classified = [c for c in said.get_all("Classifier") or [] if c.startswith("License")]
    licences[said["Name"].lower()] = " ".join(filter(None, [*declared, *classified]))
print(json.dumps(licences))
