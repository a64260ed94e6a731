"""Sections of each model and their kinds; the first kind is the default.

What a key means is declared at the argument of the constructor. Here are the constructors a section
describes, and which defaults a ready model gives them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from shellcut.arguments import declared
from shellcut.cables.cohesive_law import CohesiveLaw, CohesiveTable
from shellcut.contact.settings import Contact
from shellcut.fracture.options import NO_IMPRINT, Fracture
from shellcut.loads.adhesion import Adhesion
from shellcut.loads.loads import EdgeTraction, Gravity, NodalForce, NodalMoment, Pressure, steady
from shellcut.loads.supports import Ramped, Support
from shellcut.mesh.drawing import FilmOutline, read_drawing
from shellcut.mesh.film_file import read_film
from shellcut.mesh.mesh import Mesh
from shellcut.mesh.outline import mesh_from_outline
from shellcut.mesh.placed import placed
from shellcut.mesh.structured import OPENING_RADIUS, disc, opening_disc, rectangle
from shellcut.models import free_cut, guillotine, opening_test, oscillating, trouser
from shellcut.models.case import PAPER_DAMPING
from shellcut.models.guillotine import BLADE_HEIGHT, strip_of
from shellcut.models.oscillating import (
    BAR_CONTACT,
    BAR_FILM,
    BAR_FRACTURE,
    BAR_LAW,
    STIFFNESS_DAMPING,
    bar_before,
    motion_of,
)
from shellcut.models.path_film import disc_outline, film_along_path
from shellcut.models.trouser import (
    MASS_DAMPING,
    TEAR_FRACTURE,
    TEAR_LAW,
    THICKNESS,
    trouser_strip,
)
from shellcut.recording.run_options import RunOptions
from shellcut.simulation.simulation import Simulation
from shellcut.simulation.stable_step import Stepping
from shellcut.tool.motion import ScrewMotion, StraightMotion
from shellcut.tool.shapes import straight_blade, tooth_ring
from shellcut.tool.table_motion import TableMotion
from shellcut.tool.tool import Tool
from shellcut.tool.tool_file import read_tool

from .key import FORMS, Constructor, Kind, Section, choice, keys_of, optional, own_key
from .material_keys import HOMOGENEOUS, LAMINATE, MOVED

Kinds = tuple[Kind, ...]

HEAD = Kind(
    "Keys before the first section.",
    {
        "model": own_key(
            choice("opening", "guillotine", "free", "trouser", "oscillating"), "kind of model"
        ),
        "name": own_key(FORMS["stem"], "stem of the result file", None, unset="the model's name"),
        **keys_of(Simulation, "directional", "quasi_static", "imperfection", "threads"),
    },
    spread=True,
)

# --- [membrane] ----------------------------------------------------------------------------------

_FREE = keys_of(free_cut, "clamp", "notch")
_RIM = keys_of(opening_test, "clamp")

_SIZES = {
    **keys_of(film_along_path, "size_at_path", "size"),
    "tools": own_key(
        FORMS["paths"],
        "files of further tools, under whose paths the quads are small too: their runs then do "
        "not differ by the mesh",
        (),
    ),
}


def by_gmsh(film: Section) -> bool:
    """Whether Gmsh meshes a film, from its outline."""
    given = film.values
    return (
        film.of.outline is not None
        and given.get("mesh", "path") == "path"
        and given.get("n_side") is None
    )


def along_path(film: Section) -> bool:
    """Whether Gmsh meshes a film with quads that are small along the path of the cutting edges."""
    return by_gmsh(film) and (film.size_at_path is not None or film.values.get("size") is None)


def _disc(section: Section) -> Any:
    """Return a structured disc; None of one that Gmsh meshes, for which sizes and holes are."""
    for name in ("n_layer", "ring_radii"):
        if section.values.get(name) and section.n_side is None:
            raise ValueError(f"{name} needs n_side; without both Gmsh meshes the disc")
    if by_gmsh(section):
        return None
    if given := [name for name in (*_SIZES, "holes") if section.values.get(name)]:
        own = "n_side" if "n_side" in section.values else f"mesh = {section.mesh}"
        raise ValueError(
            f"{given[0]} is for a disc meshed by Gmsh, but {own} makes a structured one: leave "
            "out one of them"
        )
    return section.called()


OPENING_DISC = Kind(
    "The disc of the opening test, radius 10.2 mm, with node sets `rim`, `ring` and `centre`; "
    "path: by Gmsh, with `rim`.",
    {
        "mesh": replace(keys_of(opening_test)["mesh"], owner=opening_disc, parameter="name"),
        "size_at_path": _SIZES["size_at_path"],
        "tools": _SIZES["tools"],
    },
    opening_disc,
    name="opening",
    sign="mesh",
    make=_disc,
    outline=lambda section: FilmOutline(disc_outline(OPENING_RADIUS), ()),
)
STRIP = Kind(
    "A strip from x = 0 with its long sides clamped.",
    keys_of(guillotine, "length", "width", "size", "notch"),
    strip_of,
    name="strip",
    sign="length",
    spread=True,
)
RECTANGLE = Kind(
    "A sheet, x from 0, y about 0, with node sets `left`, `right`, `bottom` and `top`.",
    keys_of(rectangle) | _FREE,
    rectangle,
    name="rectangle",
    sign="length",
)
DISC = Kind(
    "A disc about the origin, with the node set `rim`. By Gmsh, or with n_side structured, with "
    "`centre` and one set per ring.",
    {
        **keys_of(disc),
        "n_side": optional(keys_of(disc)["n_side"], "meshed by Gmsh"),
        **_SIZES,
        **keys_of(mesh_from_outline, "holes"),
    },
    disc,
    name="disc",
    sign="radius",
    make=_disc,
    outline=lambda section: FilmOutline(disc_outline(section.radius), section.holes),
)
FILM_FILE = Kind(
    "A mesh of Gmsh, Abaqus, LS-DYNA or VTK; flat in z = 0 once placed, except in free models.",
    keys_of(read_film, renamed={"path": "file"}, also={"unit": "scale"})
    | keys_of(placed, "axis", "turn_deg"),
    read_film,
    name="file",
    sign="file",
    deferred=True,
)
OUTLINE = Kind(
    "A mesh of a polygon with holes, made by Gmsh; node sets `outline`, `rim` (the same), "
    "`hole_1`, ...",
    keys_of(mesh_from_outline, "outline", "holes") | _SIZES,
    mesh_from_outline,
    name="outline",
    sign="outline",
    deferred=True,
    outline=lambda section: FilmOutline(section.outline, section.holes),
)
DRAWING = Kind(
    "A mesh of the outline in a DXF drawing, by Gmsh; node sets `outline`, `rim`, `hole_1`, ...",
    keys_of(read_drawing, renamed={"path": "drawing"}) | _SIZES,
    read_drawing,
    name="drawing",
    sign="drawing",
    deferred=True,
    outline=Section.called,
)


def _placeable(kind: Kind) -> Kind:
    """Return a kind of film that a key moves, once it is made and before anything is chosen on it.

    The ready models make some films themselves, at the place that their motion begins from.
    """
    if kind.spread:
        return kind

    def film(section: Section) -> Mesh | None:
        made = section.called() if kind.make is None else kind.make(section)
        where = {name: section.values[name] for name in declared(placed) if name in section.values}
        return None if made is None else placed(made, **where)

    return replace(kind, keys={**kind.keys, **keys_of(placed, "shift")}, make=film)


# --- [tool] --------------------------------------------------------------------------------------

_MADE_TOOL = {
    "shift": own_key(
        FORMS["3 numbers"], "translation of the tool before the run", (0.0, 0.0, 0.0), unit="mm"
    ),
    "edges": own_key(
        choice("all", "none"), "which edges cut; a tool without cutting edges only presses", "all"
    ),
}


def _tool(section: Section) -> Tool:
    tool: Tool = section.called()
    if section.edges == "none":
        tool = Tool.from_triangles(tool.vertices, tool.triangles, edges="none", name=tool.name)
    return tool.translated(section.shift) if any(section.shift) else tool


TEETH = Kind(
    "A ring of teeth about the z axis that moves down through the film z = 0.",
    keys_of(tooth_ring, renamed={"n_teeth": "teeth"}) | _MADE_TOOL,
    tooth_ring,
    name="teeth",
    sign="teeth",
    make=_tool,
)
BLADE = Kind(
    "A wedge that moves along +x, its cutting edge through the origin.",
    keys_of(straight_blade) | _MADE_TOOL,
    straight_blade,
    name="blade",
    sign="edge_angle_deg",
    make=_tool,
)
STRIP_BLADE = Kind(
    "A wedge that moves along +x, its cutting edge opening_u / 80 before the strip.",
    {**BLADE.keys, "length": optional(BLADE.keys["length"], "as long as the strip")},
    straight_blade,
    name="blade",
    sign="edge_angle_deg",
    make=_tool,
).with_keys(height=BLADE_HEIGHT)
TOOL_FILE = Kind(
    "A surface or solids from a CAD program: STL, OBJ, PLY, and with Gmsh STEP, IGES.",
    keys_of(read_tool, renamed={"path": "file"}, also={"file": "stl", "unit": "scale"}),
    read_tool,
    name="file",
    sign="file",
    deferred=True,
)
BAR = Kind(
    "A round bar without cutting edges, as long as 8 of its diameters.",
    keys_of(oscillating, "diameter", "tilt_deg"),
    bar_before,
    name="bar",
    sign="diameter",
    spread=True,
)

# --- [motion] ------------------------------------------------------------------------------------

OPENING_SCREW = Kind(
    "The screw of the opening test: about z, downwards, with a ramp over the first 3 %.",
    keys_of(opening_test, "angle_deg", "duration", "pitch"),
    ScrewMotion.over,
    name="screw",
    spread=True,
)
SCREW = Kind(
    "A turn about an axis with an advance in proportion, from rest.",
    keys_of(ScrewMotion.over),
    ScrewMotion.over,
    name="screw",
    sign="angle_deg",
)
STRAIGHT = Kind(
    "Along a line, from rest.",
    keys_of(StraightMotion) | keys_of(free_cut, "duration"),
    StraightMotion,
    name="straight",
    sign="direction",
)
TABLE = Kind(
    "Through the poses of a CSV file with a unit in each heading.",
    keys_of(TableMotion.read_csv, renamed={"path": "file"})
    | {"duration": optional(keys_of(free_cut)["duration"], "to the last time")},
    TableMotion.read_csv,
    name="table",
    sign="file",
    deferred=True,
)


def _straight(doc: str, builder: Constructor, names: tuple[str, ...], by: Any = None) -> Kinds:
    return (Kind(doc, keys_of(builder, *names), by, name="straight", spread=True),)


# --- cracks, contact, step, output ---------------------------------------------------------------

_TRAPEZOID = "strength", "plateau", "opening_a", "opening_p", "opening_u"
_PAPER_LAW = CohesiveLaw()
_CABLES = "onset", "joint", "joint_friction", "cutting_energy", "severing_pressure"


def _laws(like: CohesiveLaw) -> Kinds:
    """Return the kinds of ``[cohesive]``, with the defaults of a law."""
    cables = keys_of(CohesiveTable, *_CABLES, like=like)

    def made_by(maker: Constructor, name: str, sign: str, doc: str) -> Kind:
        return Kind(doc, keys_of(maker) | cables, maker, name, sign)

    return (
        Kind(
            "Cable stress over cable length: a drop, a plateau and a fall, as in the paper.",
            keys_of(CohesiveLaw, *_TRAPEZOID, *_CABLES, like=like),
            CohesiveLaw,
            name="trapezoid",
        ),
        made_by(CohesiveTable.linear, "linear", "", "It falls linearly to zero."),
        made_by(CohesiveTable.bilinear, "bilinear", "knee_opening", "It falls along two lines."),
        made_by(
            CohesiveTable.exponential,
            "exponential",
            "fracture_energy",
            "strength exp(-length strength / fracture_energy), given by 100 points.",
        ),
        made_by(CohesiveTable, "table", "openings", "Linear between given points."),
    )


CONTACT = Kind(
    "Penalty contact with the tool, and of the film with itself.",
    keys_of(Contact),
    Contact,
)
FRACTURE = Kind("How cracks start and run.", keys_of(Fracture), Fracture)
TIME = Kind("Choice of the time step.", keys_of(Stepping), Stepping)
_DAMPED = ("alpha", "beta", "share")
DAMPING = Kind(
    "Rayleigh damping.",
    keys_of(Simulation, *_DAMPED, renamed={f"damping_{name}": name for name in _DAMPED}),
    spread=True,
)


def _damped_by(beta: str, **defaults: Any) -> Kind:
    """Return the section of a model with a stiffness damping of its own by default."""
    unset = optional(DAMPING.keys["beta"], f"{beta}, else from the share")
    return DAMPING.with_keys({"beta": unset}, **defaults)


_COUNTS = {"n_row": "rows", "n_frame": "frames", "n_snapshot": "snapshots"}
OUTPUT = Kind(
    "Output of a run; see also the flags of ``shellcut run``.",
    keys_of(RunOptions, renamed=_COUNTS | {"checkpoint_every": "checkpoint_every_s"}),
    RunOptions,
)


def _unsteered(like: Fracture, *names: str) -> Kind:
    keys = keys_of(Fracture, "check_every", *names, like=like)
    doc = "The crack runs through the quads; nothing steers it."
    return Kind(doc, keys, Fracture, fixed={"path": "free"})


# --- supports and loads ---------------------------------------------------------------------------


def _support(section: Section) -> Support:
    given = section.arguments()
    for name in {"velocity", "spin"} & set(given):
        given[name] = {axis: Ramped(rate) for axis, rate in given[name].items()}
    return Support(**given)


def _load(doc: str, constructor: Constructor, name: str, sign: str) -> Kind:
    ramp = own_key(FORMS["number"], "time over which it rises from zero", 0.0, unit="s", least=0)
    keys = keys_of(constructor) | {"ramp": ramp}

    def make(section: Section) -> Any:
        return section.called(factor=Ramped(1.0, section.ramp) if section.ramp else steady)

    return Kind(doc, keys, constructor, name=name, sign=sign, make=make)


SUPPORT = Kind(
    "Nodes that are fixed or moved, any number of [[supports]].",
    keys_of(Support, defaults={"velocity": None, "spin": None}),
    Support,
    make=_support,
)
LOADS = (
    _load("A body force.", Gravity, "gravity", "acceleration"),
    _load("A pressure along the directors.", Pressure, "pressure", "value"),
    _load("A force on every node of a set.", NodalForce, "force", "force"),
    _load("A moment on the director of every node of a set.", NodalMoment, "moment", "moment"),
    _load(
        "A force per length on the sides of the border between nodes of a set.",
        EdgeTraction,
        "traction",
        "traction",
    ),
)

ADHESION = Kind(
    "Film glued to a rigid base where it lies at first, any number of [[adhesion]].",
    keys_of(Adhesion),
    Adhesion,
)

# --- the models ----------------------------------------------------------------------------------


def _layout(
    membrane: Kinds,
    motion: Kinds,
    tool: Kinds = (),
    *,
    film: Kind = HOMOGENEOUS,
    law: CohesiveLaw = _PAPER_LAW,
    contact: Kind | None = CONTACT,
    fracture: Kind = FRACTURE,
    damping: Kind = DAMPING,
) -> dict[str, Kinds]:
    return {
        "membrane": tuple(map(_placeable, membrane)),
        "material": (film, LAMINATE),
        "cohesive": _laws(law),
        **({"tool": tool} if tool else {}),
        "motion": motion,
        **({"contact": (contact,)} if contact else {}),
        "fracture": (fracture,),
        "time": (TIME,),
        "damping": (damping,),
        "output": (OUTPUT,),
    }


SECTIONS: Mapping[str, Mapping[str, Kinds]] = {
    "opening": _layout(
        (
            OPENING_DISC,
            DISC.with_keys(_RIM),
            FILM_FILE.with_keys(_RIM),
            OUTLINE.with_keys(_RIM, clamp=("outline",)),
            DRAWING.with_keys(_RIM, clamp=("outline",)),
        ),
        (OPENING_SCREW,),
        (TEETH, TOOL_FILE),
        damping=_damped_by(f"{PAPER_DAMPING:g} s on the package's discs"),
    ),
    "guillotine": _layout(
        (STRIP, FILM_FILE.with_keys(keys_of(guillotine, "clamp", "notch"))),
        _straight(
            "Along the strip, with a ramp over the first 0.1 ms.",
            guillotine,
            ("speed", "slice_ratio", "travel"),
        ),
        (STRIP_BLADE, TOOL_FILE),
        damping=_damped_by(f"{PAPER_DAMPING:g} s on the package's strips"),
    ),
    "free": _layout(
        (
            OPENING_DISC.with_keys(_FREE),
            RECTANGLE,
            DISC.with_keys(_FREE),
            FILM_FILE.with_keys(_FREE),
            OUTLINE.with_keys(_FREE),
            DRAWING.with_keys(_FREE),
        ),
        (SCREW, STRAIGHT, TABLE),
        (TEETH, BLADE, TOOL_FILE),
    ),
    "trouser": _layout(
        (
            Kind(
                "A strip from x = 0, where it is notched and pulled; its other end is clamped.",
                keys_of(trouser, "length", "width", "notch", "size"),
                trouser_strip,
                name="strip",
                sign="length",
                spread=True,
            ),
        ),
        _straight("Ends of the legs, one up and one down.", trouser, ("speed", "ramp", "travel")),
        film=HOMOGENEOUS.with_keys(thickness=THICKNESS),
        law=TEAR_LAW,
        contact=None,
        fracture=_unsteered(TEAR_FRACTURE),
        damping=_damped_by(f"{PAPER_DAMPING:g} s", alpha=MASS_DAMPING),
    ),
    "oscillating": _layout(
        (
            Kind(
                "A strip from x = 0 with its long sides clamped, fine about its middle line.",
                keys_of(oscillating, "size", "length", "width", "band", "notch", "offset"),
                name="strip",
                sign="size",
                spread=True,
            ),
        ),
        _straight(
            "Along the strip, with a ramp over the first ms.",
            oscillating,
            ("speed", "travel"),
            motion_of,
        ),
        (BAR,),
        film=HOMOGENEOUS.with_keys(**BAR_FILM),
        law=BAR_LAW,
        contact=CONTACT.with_keys(penalty=BAR_CONTACT.penalty),
        fracture=_unsteered(BAR_FRACTURE, "fibres"),
        damping=_damped_by(f"{STIFFNESS_DAMPING:g} s"),
    ),
}
"""By model: the sections that occur once."""


LISTS: Mapping[str, Mapping[str, Kinds]] = {
    model: {
        **({"supports": (SUPPORT,)} if model == "free" else {}),
        "loads": LOADS,
        "adhesion": (ADHESION,),
    }
    for model in SECTIONS
}
"""By model: the sections that may occur several times, like [[loads]]."""

ENTRY = "N"
"""Place of a table in an array, in a title that holds for all of them: ``material.layers.N``."""


def titled(model: str) -> dict[str, Kinds]:
    """Return the kinds of the sections of a model and of the tables in them, by title.

    Examples
    --------
    >>> [kind.name for kind in titled("opening")["material.rate"]]
    ['cowper_symonds', 'johnson_cook']
    >>> [title for title in titled("opening") if title.startswith("material.layers")]
    ['material.layers.N', 'material.layers.N.hardening', 'material.layers.N.rate']
    """
    found: dict[str, Kinds] = {}

    def add(title: str, kinds: Kinds) -> None:
        found[title] = kinds
        for name, key in (each for kind in kinds for each in kind.keys.items()):
            if key.kinds:
                add(f"{title}.{name}{f'.{ENTRY}' if key.is_several else ''}", key.kinds)

    for title, kinds in SECTIONS.get(model, {}).items():
        add(title, kinds)
    for title, kinds in LISTS.get(model, {}).items():
        add(f"{title}.{ENTRY}", kinds)
    return found


GONE: Mapping[tuple[str, str], str] = {
    ("", "precision"): "leave it out: all is computed in double precision",
    ("output", "pvd"): "leave it out: ParaView reads the .vtkhdf file from 5.12 on",
    ("fracture", "stress_place"): "leave it out: the stress is read at the mid-surface",
    ("fracture", "candidates"): "leave it out: cracks start at tips and where the film is pierced",
    ("fracture", "path = imprint"): NO_IMPRINT,
    ("membrane", "imprint"): '[fracture] path = "free" cuts through the quads of any mesh, '
    '"edges" follows the sides of the quads',
    **{
        (owner, old): f"write {key} in [{owner}.{table}], where kind is {kind}"
        for owner in ("material", "material.layers")
        for old, (table, kind, key) in MOVED.items()
    },
}
"""Keys and values of earlier versions, by section, and what to write instead."""

OF_OUTLINES: Mapping[tuple[str, str], str] = {
    ("file", name): f"[membrane].{name} is for films that Gmsh meshes from an outline; a film from "
    "a file keeps its mesh: leave it out, or set refine, which divides each quad in four"
    for name in (*_SIZES, "holes")
}
"""Keys of other kinds of films, by kind and key, and why they do not belong to it."""
