"""Write ``materials.md`` and ``img/materials.png``: the presets, from ``model_file/presets.toml``.

``python docs/materials_page.py`` writes both; a test compares the page with the presets.
"""

from pathlib import Path

from shellcut.material.nominal_stress import largest_nominal_stress, nominal_curve
from shellcut.model_file import preset_film
from shellcut.model_file.key_index import unit_of_key
from shellcut.model_file.material_keys import presets
from shellcut.unit import after

PAGE = Path(__file__).parent / "materials.md"
PICTURE = PAGE.parent / "img" / "materials.png"
TOP = """# Materials by name

This page lists films whose numbers are published. A name sets keys of `[material]`. Each section
gives these keys, how they follow from the published numbers, and the sources.
`python docs/materials_page.py` makes this page.

```sh
shellcut run opening --set material=pet --set material.thickness="36 um" -o out
```

```toml
[material]
preset = "pet"               # sets every key that you do not give
thickness = "12 um"

[[material.layers]]          # or layer by layer, from the bottom to the top
preset = "ldpe"
thickness = "60 um"

[[material.layers]]
preset = "aluminium_foil"
```

Use one of the two, not both. In Python: `shellcut.preset_film("pet", thickness="12 um")`.

- A key that you give replaces that of the preset. A table `[material.hardening]` of another kind
  replaces the whole table of the preset. `used.toml` lists the numbers of the run.
- The [check](howto/trust.md) before the run says whether the film yields below the strength of the
  cables, or cannot reach this strength ([theory](theory/yielding.md#which-strength)).
- A preset has no law of the cables. If you give none, a note says so. Determine the law from
  [tensile tests](howto/tensile.md) or from a [measured cut](howto/fit.md).

Films differ by tens of per cent with grade, direction, rate and age. So these numbers are starting
points: measure your film.

![Nominal stress over strain](img/materials.png)

*Nominal stress against engineering strain in a uniaxial test. Circles are published values.*

"""
MISSING = """
## What is missing

**BOPP.** Modulus, strength and elongation of biaxially oriented polypropylene are published along
and across (m-petfilm.de, Comparative data for plastic films, ISO 527: 2500 and 4500 N/mm², 150
and 250 N/mm² at 150 and 50 %). We found no yield stress, stress at 5 %, r-values or shear modulus
of the same film. A law through the break alone would be a guess. Measure one strip along and one
across the film: [`shellcut tensile`](howto/tensile.md) makes a section `[material]` of each.

**Rates.** No source gives a second rate, so no preset has a rate factor. At the speed of a cut
(strain rates of 100 to 10,000 1/s) polymers are stiffer and stronger than in these tests (0.01 to
0.1 1/s).
"""


def page():
    """Return the page in Markdown."""
    rows = [
        "| name | film | thickness | modulus | largest nominal stress |",
        "|---|---|---|---|---|",
    ]
    for name, one in presets().items():
        rows.append(f"| [`{name}`](#{name}) | {one['title']} | {' | '.join(_values(name))} |")
    parts = [TOP + "\n".join(rows)]
    for name, one in presets().items():
        sources = "\n".join(f"- {text}" for text in one["sources"])
        parts.append(
            f"## {name}\n\n{one['title']}.\n\n{_keys(one['material'])}\n\n"
            f"How the keys follow: {one['fit']}\n\n{sources}"
        )
    return "\n\n".join(parts) + "\n" + MISSING


def _values(name):
    film = preset_film(name)
    modulus = film.stretching_stiffness / film.thickness
    largest = "elastic"
    if not film.is_linear:
        along = largest_nominal_stress(film, "uniaxial")
        plane = largest_nominal_stress(film, "plane strain")
        largest = ", ".join(
            f"{one.stress:.3g} MPa at {100 * one.strain:.0f} % ({one.pull})"
            for one in (along, plane)
        )
    return f"{1e3 * film.thickness:.4g} µm", f"{modulus:.4g} MPa", largest


def _keys(keys):
    if "layers" in keys:
        layers = [f"{1e3 * one['thickness']:.4g} µm of `{one['preset']}`" for one in keys["layers"]]
        return "Layers, from the bottom: " + ", ".join(layers) + "."
    rows = ["| key | value |", "|---|---|"]
    plain = {name: value for name, value in keys.items() if name != "hardening"}
    hardening = {f"hardening.{name}": value for name, value in keys.get("hardening", {}).items()}
    for name, value in {**plain, **hardening}.items():
        if isinstance(value, list):
            shown = ", ".join(f"{x:g}" for x in value)
        else:
            shown = value if isinstance(value, str) else f"{value:g}"
        rows.append(f"| `{name}` | {shown}{after(unit_of_key(f'material.{name}'))} |")
    return "\n".join(rows)


def picture():
    """Draw the curves, those of foils apart from those of polymers."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, 3, figsize=(10.5, 3.4), layout="constrained")
    panels = (
        (("pet", 1.3), ("aluminium_foil", 0.5)),
        (("ldpe", 3.5), ("foil_ldpe", 3.5)),
        (
            ("ldpe", 0.3),
            ("foil_ldpe", 0.3),
            ("frangi2010", 0.02),
        ),
    )
    colours = {name: f"C{k}" for k, name in enumerate(presets())}
    for ax, films in zip(axes, panels, strict=True):
        for name, end in films:
            strain, stress = nominal_curve(preset_film(name))
            shown = strain <= end
            ax.plot(100 * strain[shown], stress[shown], color=colours[name], label=name)
            for x, y in presets()[name]["published"]["points"]:
                if x <= end:
                    ax.plot(100 * x, y, "o", color=colours[name], mfc="none")
        ax.set(xlabel="strain [%]", ylim=(0, None), xlim=(0, None))
        ax.legend(fontsize=8)
    axes[0].set_ylabel("nominal stress [MPa]")
    figure.savefig(PICTURE, dpi=110)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
    picture()
