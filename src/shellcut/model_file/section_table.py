"""Sections of each model and their kinds; the first kind is the default."""

from __future__ import annotations

from collections.abc import Mapping

from .film_sections import (
    Disc,
    DrawnFilm,
    FilmFile,
    FreeDrawnFilm,
    FreeFile,
    FreeOpeningDisc,
    FreeOutline,
    OpeningDisc,
    Outline,
    Rectangle,
    Strip,
    StripFile,
)
from .key import Section
from .material_sections import Homogeneous, Laminate
from .oscillating_sections import (
    BandedStrip,
    Bar,
    BarWay,
    BrittleFilm,
    BrittleLaw,
    FreeFracture,
    LittleDamping,
    SoftContact,
)
from .run_sections import (
    Cohesive,
    ContactSection,
    Damping,
    ForceLoad,
    FractureSection,
    GravityLoad,
    MomentLoad,
    OpeningContact,
    Output,
    PressureLoad,
    SupportSection,
    Time,
    TractionLoad,
)
from .tool_sections import (
    Blade,
    OpeningScrew,
    Screw,
    Straight,
    StripBlade,
    StripWay,
    Table,
    Teeth,
    ToolFile,
)
from .trouser_sections import (
    LegWay,
    TornDamping,
    TornFilm,
    TornFracture,
    TornLaw,
    TrouserStrip,
)

Kinds = tuple[type[Section], ...]


def _sections(
    membrane: Kinds, tool: Kinds, motion: Kinds, contact: Kinds = (ContactSection,)
) -> dict[str, Kinds]:
    return {
        "membrane": membrane,
        "material": (Homogeneous, Laminate),
        "cohesive": (Cohesive,),
        "tool": tool,
        "motion": motion,
        "contact": contact,
        "fracture": (FractureSection,),
        "time": (Time,),
        "damping": (Damping,),
        "output": (Output,),
    }


SECTIONS: Mapping[str, Mapping[str, Kinds]] = {
    "opening": _sections(
        (OpeningDisc, FilmFile, Outline, DrawnFilm),
        (Teeth, ToolFile),
        (OpeningScrew,),
        (OpeningContact,),
    ),
    "guillotine": _sections(
        (Strip, StripFile),
        (StripBlade, ToolFile),
        (StripWay,),
    ),
    "free": _sections(
        (FreeOpeningDisc, Rectangle, Disc, FreeFile, FreeOutline, FreeDrawnFilm),
        (Teeth, Blade, ToolFile),
        (Screw, Straight, Table),
    ),
    "trouser": {
        "membrane": (TrouserStrip,),
        "material": (TornFilm, Laminate),
        "cohesive": (TornLaw,),
        "motion": (LegWay,),
        "fracture": (TornFracture,),
        "time": (Time,),
        "damping": (TornDamping,),
        "output": (Output,),
    },
    "oscillating": {
        "membrane": (BandedStrip,),
        "material": (BrittleFilm, Laminate),
        "cohesive": (BrittleLaw,),
        "tool": (Bar,),
        "motion": (BarWay,),
        "contact": (SoftContact,),
        "fracture": (FreeFracture,),
        "time": (Time,),
        "damping": (LittleDamping,),
        "output": (Output,),
    },
}
"""By model: the sections that occur once."""

LISTS: Mapping[str, Mapping[str, Kinds]] = {
    model: {
        **({"supports": (SupportSection,)} if model == "free" else {}),
        "loads": (GravityLoad, PressureLoad, ForceLoad, MomentLoad, TractionLoad),
    }
    for model in SECTIONS
}
"""By model: the sections that may occur several times, like [[loads]]."""

GONE: Mapping[tuple[str, str], str] = {
    ("", "precision"): "leave it out: all is computed in double precision",
    ("output", "pvd"): "leave it out: ParaView reads the .vtkhdf file from 5.12 on",
    ("fracture", "stress_place"): "leave it out: the stress is read at the mid-surface",
    ("fracture", "candidates"): "leave it out: crack tips and what an edge has pierced may split",
    ("membrane", "imprint"): '[fracture] path = "free" cuts through the quads of any mesh, '
    '"edges" along the edges there are',
}
"""Keys of earlier versions, by section, and what to write instead."""
