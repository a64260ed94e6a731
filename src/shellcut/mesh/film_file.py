"""A film from a mesh file of another program: :func:`read_film`.

Cells that a five-parameter shell cannot use are refused with their number and ids, or treated by
an explicit choice; nothing is left out silently. Assumptions and omissions are logged as warnings
of the logger ``shellcut.film_file``, which Python shows by default.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Collection
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal, TypeAlias

import numpy as np

from shellcut.arguments import Option, checked
from shellcut.arrays import Floats, Ints, norm, product, unit
from shellcut.formats.abaqus import read_abaqus
from shellcut.formats.errors import FileError, check_finite, named, naming, point_text
from shellcut.formats.file_mesh import LINE, N_CORNER, POINT, QUAD, TRIANGLE, CellBlock, FileMesh
from shellcut.formats.gmsh import read_gmsh
from shellcut.formats.length_unit import FileUnit, unit_in_mm
from shellcut.formats.lsdyna import read_lsdyna
from shellcut.formats.vtk import read_vtk
from shellcut.numerics.consistent_winding import common_winding

from .checks import check_film_size, check_quads
from .mesh import Mesh, MeshError
from .quad_geometry import first_at_place

Triangles: TypeAlias = Literal["refuse", "split"]
Quadratic: TypeAlias = Literal["refuse", "corners"]

_log = logging.getLogger("shellcut.film_file")

READERS: dict[str, Callable[[str | Path], FileMesh]] = {
    ".msh": read_gmsh,
    ".inp": read_abaqus,
    **dict.fromkeys((".k", ".key", ".dyn"), read_lsdyna),
    **dict.fromkeys((".vtu", ".vtp", ".vtk"), read_vtk),
}
"""The reader for each file name suffix."""


_ALIKE = 3.0
"""Ratio of the angles at the two ends of a side up to which the film is curved, not folded."""


@checked
def read_film(
    path: Annotated[str | Path, Option("", "the mesh; its suffix selects the format", form="path")],
    *,
    unit: FileUnit = None,
    triangles: Annotated[
        Triangles,
        Option(
            "",
            "what to do with triangles, and quads with a repeated node: split makes three quads of "
            "each, then four of every quad",
        ),
    ] = "refuse",
    quadratic: Annotated[
        Quadratic,
        Option("", "what to do with quadratic cells: corners uses corners and straight sides"),
    ] = "refuse",
    leave_out: Annotated[
        Collection[str],
        Option("", "kinds of other cells to leave out, by the names in the message", form="names"),
    ] = (),
    merge: Annotated[
        float | None, Option("mm", "nodes closer than this are merged", above=0, unset="no merging")
    ] = None,
    max_fold_deg: Annotated[float, Option("deg", "largest angle between two quads")] = 60.0,
    refine: Annotated[
        int, Option("", "number of times that each quad is divided in four", least=0, most=6)
    ] = 0,
) -> Mesh:
    """Read the mesh of a film: Gmsh .msh, Abaqus .inp, LS-DYNA .k, VTK .vtu, .vtp and .vtk.

    Returns
    -------
    Mesh
        In mm, nodes in the order of the file, without those that no quad uses. Groups of nodes,
        points and lines become node sets, groups of quads become quad sets. Quads are turned to
        agree with their neighbours, in the direction of the majority of a connected sheet.

    Raises
    ------
    FileError
        If the file cannot be read, contains no film, or cells for which no choice was made.
    MeshError
        If the mesh is not a smooth sheet, see :meth:`Mesh.from_arrays`.

    Examples
    --------
    >>> import logging, pathlib, tempfile
    >>> deck = '''*NODE
    ... 1, 0., 0.
    ... 2, 3., 0.
    ... 3, 3., 2.
    ... 4, 0., 2.
    ... *ELEMENT, TYPE=S4R
    ... 7, 1, 2, 3, 4
    ... *NSET, NSET=left
    ... 1, 4
    ... '''
    >>> path = pathlib.Path(tempfile.mkdtemp()) / "sheet.inp"
    >>> _ = path.write_text(deck)
    >>> read_film(path, unit="mm")
    Mesh(4 nodes, 1 quads, node_sets=['left'], quad_sets=[])
    """
    path = Path(path)
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise FileError(
            path,
            f"the name must end in one of {', '.join(READERS)}; 'meshio convert {path.name} "
            f"{path.stem}.vtu' converts many other formats",
        )
    file = reader(path)
    film = _Film(file, leave_out, straight=quadratic == "corners")
    film.say(*file.notes)
    if len(film.triangles):
        if triangles == "refuse":
            raise FileError(
                path,
                f"a film is made of quads, got {len(film.triangles)} triangles beside "
                f"{len(film.quads)} quads (ids {named(film.triangle_labels)}); mesh with quads "
                'only, or choose triangles="split"',
            )
        film.split()
    film.scale(unit)
    film.join(merge)
    film.drop_unused()
    try:
        check_quads(film.nodes, film.quads)
        film.turn()
        mesh = Mesh.from_arrays(
            film.nodes,
            film.quads,
            node_sets=film.node_sets,
            quad_sets=film.quad_sets,
            max_fold_deg=max_fold_deg,
        )
        check_film_size(mesh.n_quad * 4.0**refine, "lower refine, or mesh coarser")
        for _ in range(refine):
            mesh = divided_in_four(mesh, max_fold_deg)
        return mesh
    except MeshError as problem:
        raise MeshError(
            f"{path} holds no film (ids count from 0 in the order of the file): {problem}"
        ) from None


class _Film:
    # The mesh, changed step by step from the file's form to the package's; each step logs changes.

    def __init__(self, file: FileMesh, leave_out: Collection[str], *, straight: bool):
        self.path = file.path
        self.nodes: Floats = file.nodes
        self.node_labels = file.node_labels
        self.node_sets: dict[str, Ints] = dict(file.node_groups)
        self.quad_sets: dict[str, Ints] = {}
        self.lines: dict[str, Ints] = {}  # of the named groups, shape (n, 2)
        self.triangle_labels: list[str] = []
        # by kind: nodes of the cells, and their numbers in the order of the file
        nodes: dict[str, list[Ints]] = {
            kind: [np.empty((0, n), np.int64)] for kind, n in ({POINT: 1} | N_CORNER).items()
        }
        numbers: dict[str, list[Ints]] = {kind: [np.empty(0, np.int64)] for kind in nodes}
        problems, first = [], 0
        for block in file.blocks:
            number = first + np.arange(len(block.nodes))
            first += len(block.nodes)
            if (chosen := self._chosen(block, leave_out, straight=straight)) is None:
                continue
            if chosen.kind not in nodes:
                problems.append(
                    f"{len(number)} cells of kind {block.kind!r} (ids {named(block.labels)})"
                )
                continue
            for kind, rows, corners in _parted(chosen):
                nodes[kind].append(corners)
                numbers[kind].append(number[rows])
                if kind == TRIANGLE:
                    self.triangle_labels += [str(block.labels[i]) for i in rows.tolist()]
        if problems:
            raise FileError(
                self.path,
                f"a film is made of 4-node quads, got {'; '.join(problems)}; mesh with "
                'linear shells, choose quadratic="corners" for quadratic ones, or name those to '
                "drop in leave_out=[...]",
            )
        cells = {kind: np.concatenate(parts) for kind, parts in nodes.items()}
        self.quads: Ints = cells[QUAD]
        self.triangles: Ints = cells[TRIANGLE]
        if not len(self.quads) and not len(self.triangles):
            raise FileError(self.path, "there must be quads or triangles, got none")
        sheet = np.concatenate([*numbers[QUAD], *numbers[TRIANGLE]])
        order = (sheet, np.concatenate(numbers[LINE]), np.concatenate(numbers[POINT]))
        named_lines = np.zeros(len(cells[LINE]), dtype=np.bool_)
        for name, members in file.cell_groups.items():
            quads, lines, points = (np.flatnonzero(np.isin(of, members)) for of in order)
            if len(quads):
                self.quad_sets[name] = quads
            if len(lines) or len(points):
                named_lines[lines] = True
                self.lines[name] = cells[LINE][lines]
                old = self.node_sets.get(name, np.empty(0, np.int64))
                new = (old, cells[LINE][lines].ravel(), cells[POINT][points].ravel())
                self.node_sets[name] = np.unique(np.concatenate(new))
        if n := int((~named_lines).sum()):
            self.say(f"{n} lines in no named group are left out")

    def say(self, *notes: str) -> None:
        for note in notes:
            _log.warning("%s: %s", self.path, note)

    def _chosen(
        self, block: CellBlock, leave_out: Collection[str], *, straight: bool
    ) -> CellBlock | None:
        # the block as the user wants it
        if block.kind.casefold() in map(str.casefold, leave_out):
            self.say(f"{len(block.nodes)} cells of kind {block.kind!r} are left out, as chosen")
            return None
        if not (straight and block.corners and block.kind != block.corners):
            return block
        self.say(
            f"{len(block.nodes)} cells of kind {block.kind!r} are read by their corners"
            + _bow(self.nodes, block)
        )
        return CellBlock(block.corners, block.labels, block.nodes[:, : N_CORNER[block.corners]])

    def split(self) -> None:
        n_triangle, n_quad = len(self.triangles), len(self.quads)
        check_film_size(3 * n_triangle + 4 * n_quad, "mesh coarser, or with quads only")
        split = split_in_quads(self.nodes, self.quads, self.triangles)
        for name, members in self.node_sets.items():
            if name in self.lines:
                more = split.middles(self.lines[name])
                self.node_sets[name] = np.concatenate([members, more])
            else:
                self.node_sets[name] = split.with_middles(members)
        self.quad_sets = {
            name: np.flatnonzero(np.isin(split.parent, members))
            for name, members in self.quad_sets.items()
        }
        self.nodes, self.quads = split.nodes, split.quads
        n_new = len(split.nodes) - split.n_node
        self.node_labels = [*map(str, self.node_labels), *["(new)"] * n_new]
        self.say(
            f"{n_triangle} triangles are split in three and {n_quad} quads in four: now "
            f"{len(split.quads)} quads"
        )

    def scale(self, unit: str | float | None) -> None:
        used = np.unique(self.quads)
        points = self.nodes[used]
        check_finite(self.path, points, lambda k: f"node {self.node_labels[used[k]]}")
        with naming(self.path):
            factor, note = unit_in_mm(unit, float(np.ptp(points, axis=0).max()), "the film")
        self.nodes = factor * self.nodes
        if note:
            self.say(note)

    def join(self, merge: float | None) -> None:
        used = np.unique(self.quads)
        with naming(self.path):
            place = first_at_place(self.nodes, used, merge)
        beside = place[place != np.arange(len(place))].tolist()
        if not beside:
            return
        if merge is None:
            self.say(
                f"{len(beside)} pairs of nodes are at one place and stay apart, the sheet is open "
                f"there (nodes {named(self.node_labels[n] for n in beside)}); merge=1e-6 joins them"
            )
            return
        self.quads = place[self.quads]
        self.node_sets = {name: np.unique(place[m]) for name, m in self.node_sets.items()}
        self.say(f"{len(used) - len(np.unique(self.quads))} nodes are merged with others")

    def drop_unused(self) -> None:
        used = np.zeros(len(self.nodes), dtype=np.bool_)
        used[self.quads] = True
        if used.all():
            return
        lost = np.flatnonzero(~used)
        number = np.cumsum(used) - 1
        off_film = [
            f"{gone} of {len(members)} of node set {name!r}"
            for name, members in self.node_sets.items()
            if (gone := int((~used[members]).sum()))
        ]
        kept = {name: number[members[used[members]]] for name, members in self.node_sets.items()}
        self.node_sets = {name: members for name, members in kept.items() if len(members)}
        self.nodes, self.quads = self.nodes[used], number[self.quads]
        among = f", among them {'; '.join(off_film)}" if off_film else ""
        self.say(
            f"{len(lost)} nodes belong to no quad and are left out "
            f"(ids {named(self.node_labels[n] for n in lost.tolist())}){among}"
        )

    def turn(self) -> None:
        winding = common_winding(self.quads, len(self.nodes))
        if len(winding.one_sided):
            places = self.nodes[self.quads[winding.one_sided[:1]]].mean(axis=1)[0]
            raise FileError(
                self.path,
                f"a sheet must have two sides, got {len(winding.one_sided)} quads around "
                f"{point_text(places)} that have one, as a Möbius strip does",
            )
        turned = winding.turned
        if turned.any():
            self.quads[turned] = self.quads[turned][:, [0, 3, 2, 1]]
            self.say(
                f"{int(turned.sum())} of {len(self.quads)} quads are turned over to agree with "
                "their neighbours"
            )


def _bow(nodes: Floats, block: CellBlock) -> str:
    # how far the middle nodes of quadratic cells lie from straight sides
    n = N_CORNER[block.corners]
    n_side = n if n > 2 else 1
    if block.nodes.shape[1] < n + n_side:
        return ""
    a = nodes[block.nodes[:, :n_side]]
    b = nodes[np.roll(block.nodes[:, :n], -1, axis=1)[:, :n_side]]
    off = np.linalg.norm(nodes[block.nodes[:, n : n + n_side]] - 0.5 * (a + b), axis=2)
    share = (off / np.maximum(np.linalg.norm(b - a, axis=2), 1e-300)).max()
    return f": their sides bow by {100.0 * share:.2g} % of their length at most"


def _parted(block: CellBlock) -> list[tuple[str, Ints, Ints]]:
    # cells by kind: quads with two equal neighbouring corners are triangles
    if block.kind != QUAD:
        return [(block.kind, np.arange(len(block.nodes)), block.nodes)]
    quads = block.nodes
    repeated = quads == np.roll(quads, -1, axis=1)
    flat = repeated.sum(axis=1) == 1
    triangles = quads[flat][~repeated[flat]].reshape(-1, 3)
    return [
        (QUAD, np.flatnonzero(~flat), quads[~flat]),
        (TRIANGLE, np.flatnonzero(flat), triangles),
    ]


# --- triangles to quads ---------------------------------------------------------------------------


@dataclass(frozen=True)
class QuadSplit:
    """A mesh of quads and its relation to the cells before the split.

    All cells are split, a triangle in three and a quad in four, from the centre of each to the
    midpoints of its sides, so that the mesh stays conforming. Nodes keep their numbers; the
    midpoints of sides follow, then the centres of cells.
    """

    nodes: Floats
    """Shape (n_new_node, 3)."""
    quads: Ints
    """Shape (n_quad, 4), with the orientation of their cells."""
    parent: Ints
    """Cell of each quad, shape (n_quad,): quads first, then triangles, in the given order."""
    side_ends: Ints
    """Ends of the old mesh's sides, lower id first, sorted, shape (n_side, 2)."""
    side_n_cell: Ints
    """Number of cells on each, shape (n_side,)."""
    cells: tuple[Ints, Ints]
    """The quads and triangles that were split."""
    n_node: int
    """Number of old nodes."""

    def with_middles(self, members: Ints) -> Ints:
        """Return a set of nodes extended by the new nodes between them.

        A side's midpoint joins if both ends are members, a cell's centre if all corners are. For a
        set that lies on the border only, just border sides count: a cell in a corner has all its
        nodes on the border, but its inner sides and centre lie inside.
        """
        within = np.zeros(self.n_node, dtype=np.bool_)
        within[members] = True
        border = self.side_n_cell == 1
        sides = within[self.side_ends].all(axis=1)
        on_border = np.zeros(self.n_node, dtype=np.bool_)
        on_border[self.side_ends[border]] = True
        if on_border[members].all():
            return np.concatenate([members, self.n_node + np.flatnonzero(sides & border)])
        first = self.n_node + len(self.side_ends)
        centres = np.concatenate([within[cells].all(axis=1) for cells in self.cells])
        middles = self.n_node + np.flatnonzero(sides)
        return np.concatenate([members, middles, first + np.flatnonzero(centres)])

    def middles(self, lines: Ints) -> Ints:
        """Return the midpoints of those lines, shape (n_line, 2), that are sides of quads."""
        places = np.array([self.n_node, 1])
        sought, keys = product(np.sort(lines, axis=1), places), product(self.side_ends, places)
        return np.asarray(np.flatnonzero(np.isin(keys, sought)) + self.n_node)


def split_in_quads(nodes: Floats, quads: Ints, triangles: Ints) -> QuadSplit:
    """Return the mesh with each cell split into quads.

    Examples
    --------
    >>> nodes = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0]])
    >>> split = split_in_quads(nodes, np.array([[0, 1, 2, 3]]), np.array([[1, 4, 2]]))
    >>> len(split.nodes), split.parent.tolist()
    (13, [0, 0, 0, 0, 1, 1, 1])
    """
    n_node = len(nodes)
    start = np.concatenate([quads.ravel(), triangles.ravel()])
    end = np.concatenate([np.roll(cells, -1, axis=1).ravel() for cells in (quads, triangles)])
    keys, side, n_cell = np.unique(
        np.minimum(start, end) * n_node + np.maximum(start, end),
        return_inverse=True,
        return_counts=True,
    )
    ends = np.stack([keys // n_node, keys % n_node], axis=1)
    centres = [nodes[cells].mean(axis=1) for cells in (quads, triangles)]
    new_quads, parent = [], []
    first_side = first_cell = 0
    for cells in (quads, triangles):
        n, k = cells.shape
        middle = n_node + side[first_side : first_side + n * k].reshape(n, k)
        cell = first_cell + np.arange(n)
        centre = np.broadcast_to((n_node + len(keys) + cell)[:, None], (n, k))
        corners = (cells, middle, centre, np.roll(middle, 1, axis=1))
        new_quads.append(np.stack(corners, axis=-1).reshape(-1, 4))
        parent.append(np.repeat(cell, k))
        first_side += n * k
        first_cell += n
    return QuadSplit(
        nodes=np.concatenate([nodes, nodes[ends].mean(axis=1), *centres]),
        quads=np.concatenate(new_quads).astype(np.int64),
        parent=np.concatenate(parent),
        side_ends=ends,
        side_n_cell=n_cell.astype(np.int64),
        cells=(quads, triangles),
        n_node=n_node,
    )


# --- quads in four --------------------------------------------------------------------------------


def divided_in_four(mesh: Mesh, max_fold_deg: float = 60.0) -> Mesh:
    """Return a mesh with each quad divided in four, its sets with the nodes and quads between.

    In a curved film the midpoint of a side is that of the cubic that is perpendicular to the
    directors at its ends, on both sides of a seam the same. Where a film is folded, or ends, the
    directors turn by different angles from the two ends of a side; it is then kept straight.

    Examples
    --------
    >>> sheet = Mesh.from_arrays([[0, 0], [2, 0], [2, 2], [0, 2]], [[0, 1, 2, 3]])
    >>> divided_in_four(sheet).nodes[4:, :2].tolist()
    [[1.0, 0.0], [0.0, 1.0], [2.0, 1.0], [1.0, 2.0], [1.0, 1.0]]
    """
    split = split_in_quads(mesh.nodes, mesh.quads, np.zeros((0, 3), np.int64))
    bow = np.zeros_like(split.nodes)
    middles = slice(mesh.n_node, mesh.n_node + len(split.side_ends))
    bow[middles] = _bow_of_sides(mesh, split.side_ends)
    around = split.quads.reshape(-1, 4, 4)
    bow[around[:, 0, 2]] = 0.5 * bow[around[:, :, 1]].sum(axis=1)  # of a Coons patch
    quad_sets = {
        name: np.flatnonzero(np.isin(split.parent, members))
        for name, members in mesh.quad_sets.items()
    }
    return Mesh.from_arrays(
        split.nodes + bow,
        split.quads,
        node_sets={name: split.with_middles(each) for name, each in mesh.node_sets.items()},
        quad_sets=quad_sets,
        max_fold_deg=max_fold_deg,
    )


def _bow_of_sides(mesh: Mesh, ends: Ints) -> Floats:
    # how far the middles of sides lie off the chord, shape (n, 3)
    spot = first_at_place(mesh.nodes, np.unique(mesh.quads))
    normals = np.zeros_like(mesh.nodes)
    np.add.at(normals, spot, mesh.directors)
    first, last = (unit(normals[spot[ends[:, k]]]) for k in (0, 1))
    chord = mesh.nodes[ends[:, 1]] - mesh.nodes[ends[:, 0]]
    along = unit(chord)
    rise, fall = (first * along).sum(axis=1), -(last * along).sum(axis=1)
    start, stop = unit(along - rise[:, None] * first), unit(along + fall[:, None] * last)
    bow = 0.125 * norm(chord)[:, None] * (start - stop)
    less, more = np.minimum(abs(rise), abs(fall)), np.maximum(abs(rise), abs(fall))
    curved = (rise * fall > 0.0) & (more <= _ALIKE * less)
    return np.where(curved[:, None], bow, 0.0)
