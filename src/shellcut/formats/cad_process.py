"""Triangulate a CAD file with Gmsh, in a process of its own: ``cad_process.py FILE OUT ...``.

The kernel of Gmsh, OpenCASCADE, crashes or hangs on some damaged files; here it takes nobody with
it. :mod:`shellcut.formats.cad_surface` starts the process and reads its answer, the arrays
``vertices`` [mm], ``triangles``, ``chord`` [mm], ``n_solid``, ``notes`` and ``problems``. This file
imports nothing of shellcut, so that it starts at once.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np

ANGULAR_DEVIATION = 0.3
"""Largest angle between the triangles along a curved face [rad]: a fillet smaller than the chord
deviation keeps its turn."""

DEVIATION = 5e-4
"""Default chord deviation over the diagonal: 0.01 mm for a cap of 20 mm."""

DEVIATIONS = (1e-5, 0.1)
"""Chord deviations allowed, over the diagonal: below there are millions of triangles, above
nothing of a curved face is left."""

LARGEST = 1e7
"""Diagonal beyond which a face has no end [mm], as OpenCASCADE reads faces without a border."""

MOST_TRIANGLES = 2_000_000
"""Limit of a surface."""

_GAP = 0.1  # faces closer than this part of the chord deviation are sewn


def main(path: str, out: str, deviation: str, scale: str) -> None:
    """Triangulate the file and write the answer.

    deviation : of chords [mm], 0 for the default. scale : mm in a mm of OpenCASCADE, 1 unless the
    user knows the file's unit better than the file.
    """
    import gmsh

    chord, n_solid = 0.0, 0
    problems: list[str] = []
    vertices, triangles = np.zeros((0, 3)), np.zeros((0, 3), np.int64)
    notes: list[str] = []
    gmsh.initialize(readConfigFiles=False, interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    if Path(path).suffix.lower() in (".step", ".stp"):  # IGES is read in mm anyway
        gmsh.option.setString("Geometry.OCCTargetUnit", "MM")
    try:
        chord = _opened(gmsh, path, float(deviation) / float(scale), float(scale))
        problems = _refusals(gmsh)
        n_solid = len(gmsh.model.getEntities(3))
        if not problems:
            vertices, triangles, notes = _triangles(gmsh, chord, float(scale))
    except _Refused as refusal:
        problems = [str(refusal)]
    finally:
        gmsh.finalize()
    surface: dict[str, Any] = {"vertices": vertices, "triangles": triangles, "chord": chord}
    np.savez(out, **surface, n_solid=n_solid, notes=notes, problems=problems)


class _Refused(Exception):
    """The file holds no tool; the message says why."""


def _opened(gmsh: Any, path: str, deviation: float, scale: float) -> float:
    # read the file and set how fine it is triangulated; returns the chord deviation
    _read(gmsh, path)
    if not gmsh.model.getEntities(2):
        raise _Refused("there must be surfaces, got none; export a solid, not a sketch")
    box = gmsh.model.getBoundingBox(-1, -1)
    diagonal = sum((box[k + 3] - box[k]) ** 2 for k in range(3)) ** 0.5
    if not diagonal < LARGEST:
        raise _Refused(
            f"the faces must end within {LARGEST:g} mm, got {diagonal:.3g} mm across; is the "
            "file damaged?"
        )
    chord = deviation if deviation > 0.0 else DEVIATION * diagonal
    least, most = (share * diagonal for share in DEVIATIONS)
    if not least <= chord <= most:
        raise _Refused(
            f"chord_deviation must be {scale * least:.2g} to {scale * most:.2g} mm for a tool with "
            f"a diagonal of {scale * diagonal:.4g} mm, got {scale * chord:g}"
        )
    if not gmsh.model.getEntities(3):
        # IGES, and surface models in STEP: each face has edges of its own
        gmsh.model.remove()
        gmsh.option.setNumber("Geometry.OCCSewFaces", 1)
        gmsh.option.setNumber("Geometry.Tolerance", _GAP * chord)
        _read(gmsh, path)
    gmsh.option.setNumber("Mesh.StlLinearDeflectionRelative", 0)
    gmsh.option.setNumber("Mesh.StlLinearDeflection", chord)
    gmsh.option.setNumber("Mesh.StlAngularDeflection", ANGULAR_DEVIATION)
    return chord


def _read(gmsh: Any, path: str) -> None:
    gmsh.model.add("tool")
    try:
        gmsh.model.occ.importShapes(path, highestDimOnly=False)
    except Exception as reason:  # gmsh raises plain Exception
        raise _Refused(f"Gmsh cannot read it: {reason}; is it damaged or cut short?") from None
    gmsh.model.occ.synchronize()


def _refusals(gmsh: Any) -> list[str]:
    # why the solids cannot be a tool
    return [
        f"solid {solid} has a cavity: fill it, a tool has no inner surfaces"
        for _, solid in gmsh.model.getEntities(3)
        if len(gmsh.model.occ.getSurfaceLoops(solid)[0]) > 1
    ]


def _triangles(gmsh: Any, chord: float, scale: float) -> tuple[Any, Any, list[str]]:
    notes = []
    solids = gmsh.model.getEntities(3)
    faces = [face for _, face in gmsh.model.getEntities(2)]
    loose = [face for face in faces if not len(gmsh.model.getAdjacencies(2, face)[0])]
    if solids and loose:
        notes.append(f"{len(loose)} surfaces beside the solids are left out")
        faces = [face for face in faces if face not in set(loose)]
    gmsh.model.mesh.importStl()
    tags, places, _ = gmsh.model.mesh.getNodes()
    row = np.zeros(int(tags.max(initial=0)) + 1, dtype=np.int64)
    row[tags.astype(np.int64)] = np.arange(len(tags))
    parts = []
    for face in faces:
        _, _, nodes = gmsh.model.mesh.getElements(2, face)
        part = row[np.concatenate([*nodes, np.zeros(0, np.uint64)]).astype(np.int64)]
        parts.append(part.reshape(-1, 3))
        if not len(part):
            notes.append(f"face {face} is degenerate and is left out")
    triangles = np.concatenate([*parts, np.zeros((0, 3), np.int64)])
    if not len(triangles):
        raise _Refused("there must be faces with an area, got none; is the file damaged?")
    if len(triangles) > MOST_TRIANGLES:
        raise _Refused(
            f"the surface must have {MOST_TRIANGLES:,} triangles at most, got {len(triangles):,} "
            f"at chord_deviation = {scale * chord:.3g} mm: enlarge it"
        )
    bodies = f"{len(solids)} solids" if solids else "surfaces, sewn together,"
    notes.insert(
        0,
        f"{bodies} with {len(faces)} faces became {len(triangles)} triangles, at most "
        f"{scale * chord:.3g} mm off a curved face; chord_deviation=... says otherwise",
    )
    return places.reshape(-1, 3), triangles, notes


if __name__ == "__main__":
    main(*sys.argv[1:])
