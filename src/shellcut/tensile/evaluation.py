"""Tensile tests of a film, evaluated: :func:`evaluate_tensile`."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np

from shellcut.files.file_list import claim
from shellcut.files.whole_file import write_text
from shellcut.formats.errors import FileError
from shellcut.results.comparison import finite
from shellcut.view.curves import PALETTE, Curve, Diagram, draw_curves

from .columns import Choice
from .direction import MEASURES, Direction
from .figures import figures_of
from .specimen import SpecimenSize, read_specimens

Paths = str | os.PathLike[str] | Sequence[str | os.PathLike[str]]

PICTURE = "tensile.png"
"""Of the command, beside the files of :meth:`TensileTest.write`."""

_LAW = ("strength", "plateau", "opening_a", "opening_p", "opening_u", "onset")


@dataclass(frozen=True, eq=False)
class TensileTest:
    """The directions of a film, with figures, hardening curves and proposed laws.

    Examples
    --------
    >>> path = Path("sheet.csv")
    >>> rows = [(0, 0), (0.05, 1), (0.1, 2), (0.15, 3), (0.2, 4), (0.25, 5), (0.8, 16), (1, 0)]
    >>> _ = path.write_text(chr(10).join(["strain [%];CD [MPa]", *(f"{x};{y}" for x, y in rows)]))
    >>> print(str(evaluate_tensile(path)).splitlines()[2])
    Young's modulus       2000 MPa
    """

    directions: dict[str, Direction]
    """By name, as MD and CD; the name is empty if none was given."""
    offset: float
    """Plastic strain at yield [-]."""
    files: tuple[Path, ...] = ()
    """The tables that were read."""

    def columns(self) -> list[str]:
        """Return in words from which columns of the files strains and stresses come."""
        files: dict[str, list[str]] = {}
        for specimen in (one.specimen for of in self.directions.values() for one in of.figures):
            files.setdefault(specimen.columns, []).append(specimen.name)
        return [f"{', '.join(names)}: {columns}" for columns, names in files.items()]

    def sentences(self) -> list[str]:
        """Return what to know before the figures are used, in all directions."""
        said = self.columns() + [
            f"{name}: {text}" if name else text
            for name, one in self.directions.items()
            for text in one.sentences()
        ]
        if len(self.directions) > 1:
            said.append(
                "a cut along one direction is opened across it: take the law of the specimens cut "
                "across the blade's way"
            )
            said.append(
                "a material file holds one direction for all: where yield stresses differ, take "
                "r_values, or the direction in which the film is pulled"
            )
        return said

    def __str__(self) -> str:
        """Return the figures as a table, the laws, and the sentences."""
        names = [name or "film" for name in self.directions]
        each = list(self.directions.values())
        rows = [["", *names], ["specimens", *(str(len(d.figures)) for d in each)]]
        for measure, (title, unit) in MEASURES.items():
            if measure == "yield_stress":
                title += f" ({100 * self.offset:g} %)"
            rows.append([title, *(d.spread(measure).text(unit) for d in each)])
        rows.append(["fracture energy", *(d.fracture_energy.text("kJ/m²") for d in each)])
        laws = [one.law() for one in each]
        for name in _LAW[:-1]:
            unit = "MPa" if name in ("strength", "plateau") else "mm"
            cells = ["-" if law is None else f"{getattr(law, name):.4g} {unit}" for law in laws]
            rows.append([f"law: {name}", *cells])
        width = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
        table = [
            "  ".join(c.ljust(w) for c, w in zip(r, width, strict=True)).rstrip() for r in rows
        ]
        return "\n".join([*table, "", *(f"- {text}" for text in self.sentences())])

    def figures(self) -> dict[str, Any]:
        """Return all figures as plain values: means, deviations, laws; unknown ones are None."""
        found: dict[str, Any] = {}
        for name, one in self.directions.items():
            law = one.law()
            spreads = {measure: one.spread(measure) for measure in MEASURES}
            spreads["fracture_energy"] = one.fracture_energy
            found[name or "film"] = {
                "n_specimen": len(one.figures),
                "gauge_length": one.gauge_length,
                "specimens": [each.specimen.name for each in one.figures],
                **{key: finite(asdict(spread)) for key, spread in spreads.items()},
                "law": None if law is None else {key: getattr(law, key) for key in _LAW},
            }
        return {"offset": self.offset, "directions": found, "sentences": self.sentences()}

    def write(self, folder: str | os.PathLike[str]) -> list[Path]:
        """Write ``tensile.json``, and a direction's ``hardening``, ``material`` and ``law``.

        Returns
        -------
        list of Path
            Of the files; names end in the direction, as ``hardening_MD.csv``.

        Raises
        ------
        FileExistsError
            If one of them was read here, or is somebody else's; nothing is written then.
        """
        texts = {"tensile.json": json.dumps(self.figures(), indent=2, ensure_ascii=False) + "\n"}
        for name, one in self.directions.items():
            end = f"_{name}" if name else ""
            strain, stress, scatter, n = one.hardening()
            if n:
                rows = [f"# {n} specimens, up to the strength; deviation over the specimens"]
                rows += ["plastic strain [-],true stress [MPa],deviation [MPa]"]
                rows += [
                    f"{x:.6g},{y:.6g},{s:.3g}"
                    for x, y, s in zip(strain, stress, np.nan_to_num(scatter), strict=True)
                ]
                texts[f"hardening{end}.csv"] = "\n".join(rows) + "\n"
            if section := one.material():
                texts[f"material{end}.toml"] = section
            if law := one.law():
                lines = [f"# fracture energy {law.fracture_energy:.6g} N/mm, from tensile tests"]
                lines += ["[cohesive]", *(f"{key} = {getattr(law, key):.6g}" for key in _LAW)]
                texts[f"law{end}.toml"] = "\n".join(lines) + "\n"
        claim(folder, [*texts, PICTURE], self.files)
        written = [Path(folder) / name for name in texts]
        for path, text in zip(written, texts.values(), strict=True):
            write_text(path, text, errors="backslashreplace")
        return written

    def plot(self, path: str | os.PathLike[str]) -> Path:
        """Draw the curves of all specimens, and the proposed laws over the falling parts.

        Raises
        ------
        ImportError
            If Matplotlib is not installed.
        """
        strains, falls = [], []
        for k, (name, one) in enumerate(self.directions.items()):
            style = k % len(PALETTE)
            label = f"{name or 'film'}, {len(one.figures)} specimens"
            for f in one.figures:
                strain = 100.0 * (f.specimen.strain - f.slack)
                strains.append(Curve(label, f.specimen.stress, f"c{style}", x=strain))
            law = one.law()
            if law is None:
                continue
            length = float(one.gauge_length or 0.0)
            for f in one.falling:
                opened = length * f.opening_per_length
                falls.append(Curve(f"{label}, falling", f.falling_stress, f"c{style}", x=opened))
            opening = np.linspace(0.0, law.opening_u, 400)
            stress = [law.traction(x) for x in opening]
            said = f"G = {law.fracture_energy:.3g} kJ/m², gauge length {length:g} mm"
            falls.append(Curve(f"law {name or 'film'}: {said}", stress, f"law{style}", x=opening))
        stress_axis = "nominal stress", "MPa"
        why = "" if falls else "no fall recorded: no law"
        draw_curves(
            path,
            [
                Diagram([], strains, "strain", "%", *stress_axis),
                Diagram([], falls, "opening", "mm", *stress_axis, title=why),
            ],
            columns=2,
            size=(11.0, 5.0),
        )
        return Path(path)


def evaluate_tensile(
    files: Paths | Mapping[str, Paths],
    *,
    gauge_length: float | None = None,
    width: float | None = None,
    thickness: float | None = None,
    offset: float = 0.002,
    columns: Choice = None,
    units: str | Sequence[str] | None = None,
) -> TensileTest:
    """Evaluate tensile tests: modulus, yield, strength, hardening curve, a cohesive law.

    Parameters
    ----------
    files : path, paths, or mapping from directions to paths
        Tables of stress and strain, nominal or true, or of force and extension, one specimen or
        several in each. Name and unit in a heading say what a column is; a word of it, as in
        "stress MD [MPa]", may name the direction.
    gauge_length : float, optional, [mm]
        Length over which the strain was measured; needed for the law, and for extensions.
    width, thickness : float, optional, [mm]
        Of the specimens; needed for forces.
    offset : float
        Plastic strain at yield [-].
    columns : str or sequence of str and int, optional
        Columns to use in all files, by heading or number from 1, as ``"Strain, Stress"`` (separated
        by semicolons where a heading has a comma); their units say which is which. By default
        those whose names and units agree.
    units : str or sequence of str, optional
        Units of these columns, or of strain and stress, as ``"%, MPa"``, or of all columns; by
        default those of the headings.

    Returns
    -------
    TensileTest

    Raises
    ------
    FileError
        For files that cannot be read: all of them, with lines.
    ValueError
        For dimensions and offsets that are not above 0, unknown units, and a file given twice.

    Examples
    --------
    >>> path = Path("film.csv")
    >>> rows = [(0, 0), (0.05, 1), (0.1, 2), (0.15, 3), (0.2, 4), (0.25, 5), (0.8, 16)]
    >>> rows += [(20, 20), (40, 24), (42, 8), (46, 0)]
    >>> text = "strain [%],stress [MPa]" + "".join(f"{chr(10)}{x},{y}" for x, y in rows)
    >>> _ = path.write_text(text)
    >>> film = evaluate_tensile(path, gauge_length=50.0).directions[""]
    >>> round(film.spread("young").mean), film.spread("strength").mean
    (2000, 24.0)
    """
    tables = {
        direction: _listed(paths)
        for direction, paths in (files if isinstance(files, Mapping) else {"": files}).items()
    }
    each = [path for paths in tables.values() for path in paths]
    if twice := {f"{path} is given twice: name it once" for path in each if each.count(path) > 1}:
        raise ValueError("\n".join(sorted(twice)))
    piece = SpecimenSize(gauge_length=gauge_length, width=width, thickness=thickness)
    if not (isfinite(offset) and 0.0 < offset < 1.0):
        raise ValueError(f"offset must be a strain between 0 and 1, got {offset!r}")
    found: dict[str, Direction] = {}
    problems: list[str] = []
    for direction, paths in tables.items():
        for path in paths:
            try:
                specimens = read_specimens(path, piece, direction, columns, units)
            except FileError as problem:
                problems.append(str(problem))
                continue
            for specimen in specimens:
                into = found.setdefault(
                    specimen.direction, Direction(specimen.direction, [], gauge_length)
                )
                try:
                    into.figures.append(figures_of(specimen, offset))
                except ValueError as problem:
                    problems.append(f"{path}: {specimen.name}: {problem}")
    if problems:
        raise ValueError("\n".join(problems))
    if not found:
        raise ValueError("there must be at least one file")
    return TensileTest(found, offset, tuple(each))


def _listed(paths: Paths) -> list[Path]:
    if isinstance(paths, str | os.PathLike):
        return [Path(paths)]
    return [Path(path) for path in paths]
