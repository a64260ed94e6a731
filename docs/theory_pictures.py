"""The drawings of the theory pages, each a function that returns its SVG.

``python docs/theory_pictures.py`` writes ``img/theory_*.svg``; a test compares the two.
"""

import re
from math import cos, degrees, hypot, log10, radians, sin, sqrt, tan
from pathlib import Path

DOCS = Path(__file__).parent
WIDTH = 520
"""Of every drawing, in its own units: text of 15 is still 10 px high on a page of 390 px."""

FILM, INK, RED, GREEN, GREY, TOOL = "#dbe7f5", "#334455", "#c0392b", "#2e7d32", "#666", "#dfe3e8"


def drawing(height, *parts):
    """Return the SVG of the parts, on white."""
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" width="640" '
        'font-family="Helvetica, Arial, sans-serif" font-size="15">'
    )
    ground = f'<rect width="{WIDTH}" height="{height}" fill="#fff"/>'
    return "\n".join([head, ground, *parts, "</svg>", ""])


def pairs(points):
    """Return points as SVG lists them."""
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in points)


def polygon(points, fill=FILM, line=INK, width=1.5, more=""):
    """Draw a closed polygon."""
    return (
        f'<polygon points="{pairs(points)}" fill="{fill}" stroke="{line}" '
        f'stroke-width="{width}" {more}/>'
    )


def line(points, colour=INK, width=1.5, dash=""):
    """Draw an open line; ``dash`` as in SVG."""
    dash = f' stroke-dasharray="{dash}"' if dash else ""
    return (
        f'<polyline points="{pairs(points)}" fill="none" stroke="{colour}" '
        f'stroke-width="{width}"{dash}/>'
    )


def arrow(start, end, colour="#222", width=2.0):
    """Draw an arrow from start to end."""
    (x, y), (u, v) = start, end
    length = hypot(u - x, v - y)
    e, f = (u - x) / length, (v - y) / length
    foot = u - 9 * e, v - 9 * f
    head = [(u, v), (foot[0] - 4.5 * f, foot[1] + 4.5 * e), (foot[0] + 4.5 * f, foot[1] - 4.5 * e)]
    return line([start, foot], colour, width) + polygon(head, colour, "none", 0)


def measure(start, end, colour=GREY):
    """Draw a dimension, a line with a bar at either end."""
    (x, y), (u, v) = start, end
    length = hypot(u - x, v - y)
    e, f = 5 * (v - y) / length, -5 * (u - x) / length
    bars = [line([(p - e, q - f), (p + e, q + f)], colour, 1) for p, q in (start, end)]
    return line([start, end], colour, 1) + "".join(bars)


def dot(place, colour="#222", radius=4.5):
    """Draw a dot."""
    return f'<circle cx="{place[0]:.1f}" cy="{place[1]:.1f}" r="{radius}" fill="{colour}"/>'


def arc(centre, radius, first, last, colour=GREY):
    """Draw an arc between two angles [deg], counter-clockwise as seen on the page."""
    angles = [radians(first + (last - first) * k / 24) for k in range(25)]
    x, y = centre
    return line([(x + radius * cos(a), y - radius * sin(a)) for a in angles], colour, 1.2)


def text(x, y, words, colour="#222", size=15, anchor="start"):
    """Write words; ``a_b`` and ``a_{bc}`` have indices, names such as half_thickness have none."""
    lower = '<tspan dy="4" font-size="11">{}</tspan><tspan dy="-4">&#8203;</tspan>'
    index = r"(?<![A-Za-z_])(\w)_(?:\{(.+?)\}|(\w)(?![A-Za-z_]))"
    words = re.sub(index, lambda m: m[1] + lower.format(m[2] or m[3]), words)
    return (
        f'<text x="{x:.1f}" y="{y:.1f}" fill="{colour}" font-size="{size}" '
        f'text-anchor="{anchor}">{words}</text>'
    )


def shell():
    """Draw a quad: mid-surface, directors, base vectors, tying points."""

    def seen(p):
        x, y, z = p
        return 222 + 112 * x + 62 * y, 205 + 14 * x - 62 * y - 88 * z

    corners = [(-1.25, -1, 0.0), (1.2, -1.05, 0.22), (1.3, 1.15, 0.0), (-1.2, 1.0, 0.3)]
    tips = [(-0.12, -0.08, 1.0), (0.14, -0.1, 1.0), (0.14, 0.08, 1.0), (-0.1, 0.1, 1.0)]

    def at(xi, eta, height=0.0):
        shapes = [(1 + a * xi) * (1 + b * eta) / 4 for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        place = [sum(n * c[i] for n, c in zip(shapes, corners, strict=True)) for i in range(3)]
        director = [sum(n * t[i] for n, t in zip(shapes, tips, strict=True)) for i in range(3)]
        return seen([p + height * d for p, d in zip(place, director, strict=True)])

    square = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    parts = [
        polygon([at(*c, -0.2) for c in square], "#f4f7fb", "#9ab", 1, 'stroke-dasharray="5 4"')
    ]
    parts += [polygon([at(*c) for c in square], FILM, INK, 2)]
    parts += [polygon([at(*c, 0.2) for c in square], "none", "#9ab", 1, 'stroke-dasharray="5 4"')]
    parts += [line([at(-1, 0), at(1, 0)], "#9ab", 1), line([at(0, -1), at(0, 1)], "#9ab", 1)]
    middle = at(0, 0)
    parts += [arrow(middle, at(0.62, 0), INK), arrow(middle, at(0, 0.7), INK)]
    parts += [text(*_by(at(0.3, 0), -6, -9), "a_1, ξ", INK)]
    parts += [text(*_by(at(0, 0.6), 10, 4), "a_2, η", INK)]
    for k, c in enumerate(square):
        parts += [line([at(*c, -0.2), at(*c)], "#9ab", 1), arrow(at(*c), at(*c, 0.72))]
        parts += [dot(at(*c)), text(*_by(at(*c, 0.72), 8, 6), f"t_{k}")]
        parts += [text(*_by(at(*c), (-20, 10, 10, -20)[k], (6, 6, 4, 4)[k]), f"x_{k}")]
    for name, place in (("A", (0, -1)), ("B", (0, 1)), ("C", (-1, 0)), ("D", (1, 0))):
        parts += [dot(at(*place), RED, 6)]
        parts += [text(*_by(at(*place), 8, 21 if name == "A" else 19), name, RED)]
    low, high = at(1, -1, -0.2), at(1, -1, 0.2)
    parts += [measure(_by(low, 36, 0), _by(high, 36, 0)), text(low[0] + 44, low[1] - 10, "h", GREY)]
    parts += [
        text(14, 384, "dashed: the faces, at ξ³ = ∓h/2 along t"),
        text(14, 318, "A, B at (0, ∓1) tie 2E_{13} = a_1·t − A_1·T,", RED),
        text(14, 340, "C, D at (∓1, 0) tie 2E_{23} = a_2·t − A_2·T;", RED),
        text(14, 362, "in between: linear in η, linear in ξ", RED),
    ]
    return drawing(398, *parts)


def _by(place, right, down):
    """Return a place moved on the page."""
    return place[0] + right, place[1] + down


def cables():
    """Draw the library's own law with unloading and severing, and a cable at an edge."""
    from shellcut.cables.cohesive_law import CohesiveLaw

    law = CohesiveLaw(cutting_energy=1.0, severing_pressure=450.0)
    sharp = law.at_edge(0.02)

    def at(opening, stress):
        return 46 + 52 * opening, 196 - 8.4 * stress

    def envelope(of):
        return [at(*corner) for corner in zip(of.openings, of.tractions, strict=True)]

    parts = [polygon([at(0, 0), *envelope(law)], "#eef3f9", "none", 0)]
    parts += [polygon([at(0, 0), *envelope(sharp)], "#f8dcd8", "none", 0)]
    parts += [line(envelope(law), INK, 2.5), line(envelope(sharp), RED, 2.5)]
    parts += [arrow(at(0, 0), (46, 24)), arrow(at(0, 0), (284, 196))]
    turn = at(2.3, law.plateau)
    parts += [
        line([at(0, 0), turn], GREEN, 1.5, "5 4"),
        arrow(turn, _by(turn, -45, 38), GREEN, 1.5),
    ]
    parts += [text(52, 36, "σ, MPa"), text(268, 188, "ℓ, mm"), text(222, 174, "G", INK)]
    parts += [text(78, 152, "G_s", RED), text(154, 142, "unloading", GREEN)]
    for stress, name in ((law.strength, "σ_F"), (law.plateau, "σ_C")):
        parts += [text(8, at(0, stress)[1] + 5, name), line([at(-0.08, stress), at(0, stress)])]
    for opening, name in (
        (law.opening_a, "ℓ_A"),
        (law.opening_p, "ℓ_P"),
        (law.opening_u, "ℓ_U"),
        (sharp.opening_u, "ℓ_U′"),
    ):
        x = at(opening, 0)[0]
        colour = RED if "′" in name else "#222"
        parts += [line([(x, 196), (x, 201)]), text(x, 218, name, colour, 15, "middle")]

    # The blade goes to the right; flanks on either side of it, the cable around its edge.
    nose = (412, 110)
    parts += [polygon([nose, (330, 84), (312, 84), (312, 136), (330, 136)], TOOL, GREY, 2)]
    for sign, name in ((-1, "+"), (1, "−")):
        way = sign * 58
        flank = [(312, nose[1] + way), (430, nose[1] + way * 0.9), (496, nose[1]), (518, nose[1])]
        parts += [line(flank, INK, 4), line([nose, (374, nose[1] + way * 0.945)], GREEN, 2.5)]
        parts += [dot((374, nose[1] + way * 0.945), GREEN, 4)]
        parts += [text(400, nose[1] + sign * 30 + 5, f"ℓ{'⁺' if name == '+' else '⁻'}", GREEN)]
        parts += [text(330, nose[1] + way + (22 if sign > 0 else -12), f"flank {name}", INK)]
    parts += [dot(nose, RED, 5), text(422, 115, "joint", RED), text(318, 115, "blade", GREY)]
    parts += [arrow((312, 206), (372, 206)), text(380, 211, "motion of the blade")]
    return drawing(232, *parts)


def fracture():
    """Draw the side ahead with its two groups of quads, and the side that a blade takes."""
    x = [20, 110, 200, 290, 380]
    up = [[(a, 40) for a in x], [(20, 108), (110, 114), (200, 122), (290, 118), (380, 122)]]
    down = [[(20, 142), (110, 136), (200, 122), (290, 118), (380, 122)], [(a, 200) for a in x]]
    parts = []
    for k in range(4):
        for rows, colour in ((up, "#cfe0f3"), (down, "#d5ebd3")):
            near = k in (1, 2)
            quad = [rows[0][k], rows[0][k + 1], rows[1][k + 1], rows[1][k]]
            parts += [polygon(quad, colour if near else "#f3f5f8", "#7a8aa0", 1.2)]
    flank = [(0.15 * k, 20 + 180 * 0.15 * k) for k in range(7)]
    for _, a in flank:
        gap = 17 * (200 - a) / 180
        parts += [line([(a, 123 - gap), (a, 123 + gap)], GREEN, 1.5)]
    tip = (200, 122)
    parts += [line([tip, (290, 118)], RED, 4), dot(tip, "#222", 6)]
    parts += [arrow((205, 72), (201, 112), RED, 2.5), arrow((197, 174), (199, 132), RED, 2.5)]
    parts += [text(210, 86, "−F_c", RED), text(205, 170, "F_c", RED)]
    parts += [text(120, 62, "group 2: f_2, m_2"), text(120, 192, "group 1: f_1, m_1")]
    parts += [text(216, 112, "tip"), text(300, 110, "side ahead", RED)]
    parts += [arrow((352, 190), (350, 148), INK), text(358, 166, "m", INK)]
    parts += [text(24, 98, "cables", GREEN)]
    parts += [text(396, 66, "It advances when"), text(396, 90, "(F_c + B)·m", RED)]
    parts += [text(396, 112, "   ≥ σ_F A", RED), text(396, 144, "A/h: half of")]
    parts += [
        text(396, 164, "either side at the"),
        text(396, 184, "tip. B: pull of"),
        text(396, 204, "cables behind"),
    ]
    parts += [measure((155, 216), (245, 216)), text(252, 221, "A/h", GREY)]

    # Under a blade, from above.
    tip = (150, 336)
    sides = [(262, 330), (240, 270), (245, 400)]
    corners = [(150, 262), (150, 408), (44, 340)]
    outer = [(44, 266), (44, 410)]
    parts += [polygon([outer[0], corners[0], tip, corners[2]], "#f3f5f8", "#7a8aa0", 1.2)]
    parts += [polygon([outer[1], corners[1], tip, corners[2]], "#f3f5f8", "#7a8aa0", 1.2)]
    parts += [polygon([corners[0], sides[1], sides[0], tip], "#f3f5f8", "#7a8aa0", 1.2)]
    parts += [polygon([corners[1], sides[2], sides[0], tip], "#f3f5f8", "#7a8aa0", 1.2)]
    aim = (262, 318)
    parts += [line([corners[2], tip], RED, 2, "7 4"), line([tip, sides[0]], RED, 4)]
    plane = [(20 + 20 * k, 361 - 0.00031 * (20 * k) ** 2 - 3.4 * k) for k in range(16)]
    parts += [line(plane, INK, 1.5, "8 4"), arrow(tip, aim), dot(tip, "#222", 6), dot(aim, INK)]
    parts += [
        text(334, 275, "mid-plane of the blade", INK),
        text(334, 295, "where it will be", INK),
    ]
    parts += [text(274, 322, "one element size ahead", INK), text(274, 345, "side taken:", RED)]
    parts += [text(274, 365, "least angle to the arrow", RED), text(136, 358, "tip")]
    parts += [text(52, 330, "crack", RED), text(14, 250, "Under a blade:"), text(14, 24, "Force:")]
    return drawing(424, *parts)


def statics():
    """Draw a path with two limit points by arc length, and a bifurcation."""
    left, right, floor, high = 50, 280, 200, 78

    def at(w, load):
        return left + (right - left) * w / 2.35, floor - high * (load + 0.0)

    def load(w):
        return w * (1 - w) * (2 - w) / (2 / (3 * sqrt(3)))

    turn = 1 - 1 / sqrt(3), 1 + 1 / sqrt(3)
    floor = 175
    parts = [arrow((left, 290), (left, 40)), arrow((left, floor), (right + 14, floor))]
    parts += [text(left + 10, 48, "load factor"), text(right - 4, floor + 20, "q")]
    for first, last, dash in ((0, turn[0], ""), (turn[0], turn[1], "5 4"), (turn[1], 2.17, "")):
        ws = [first + (last - first) * k / 40 for k in range(41)]
        parts += [line([at(w, load(w)) for w in ws], INK, 2.5, dash)]
    stops = [0.0, 0.1, 0.22, 0.36, 0.52, 0.7, 0.9, 1.1, 1.3, 1.5, 1.7, 1.9, 2.07]
    parts += [dot(at(w, load(w)), INK, 3.5) for w in stops]
    a, b = 0.9, 1.1
    slope = (load(a + 1e-4) - load(a)) / 1e-4
    ahead = at(b, load(a) + slope * (b - a))
    parts += [line([at(b, 0.62), at(b, -1.05)], RED, 1.2, "4 3"), dot(at(b, load(b)), RED, 5)]
    parts += [text(*_by(at(b, 0.62), 8, 4), "v·Δq = Δl|v|", RED)]
    parts += [arrow(at(a, load(a)), ahead, RED, 1.6)]
    snap = next(w / 1000 for w in range(2000, 2300) if load(w / 1000) > 0.99)
    parts += [line([at(turn[0], 1), at(snap, 1)], GREY, 1.2, "2 4")]
    parts += [text(*_by(at(0.9, 1), 0, -10), "snap at constant load", GREY)]
    parts += [text(*_by(at(0.14, 0.3), 10, 10), "0"), text(*_by(at(0.93, 0.5), -36, 4), "1")]
    parts += [
        text(*_by(at(2.0, 0), 4, -10), "0"),
        text(14, 318, "0, 1: n_negative; dots: steps of"),
    ]
    parts += [text(14, 338, "arc length; red: plane of the next")]

    # Bifurcation: of a plate with a wave of 1 % of its thickness.
    x0, y0, w0 = 400, 290, 0.01
    c = (1.31 - 1 + w0 / 1.253) / 1.253**2

    def of(w, p):
        return x0 + 66 * w, y0 - 160 * p

    parts += [arrow((x0, y0), (x0, 40)), text(x0 + 8, 48, "p/p_c"), text(486, y0 - 8, "w/h")]
    parts += [arrow((300, y0), (510, y0))]
    parts += [line([of(0, 1), of(0, 1.42)], GREY, 2.5, "5 4")]
    for sign in (1, -1):
        ws = [sign * 1.42 * k / 60 for k in range(61)]
        parts += [line([of(w, 1 + c * w * w) for w in ws], INK if sign > 0 else "#9ab", 1.5)]
    ws = [0.004 + 1.38 * (k / 80) ** 2 for k in range(1, 81)]
    bent = [of(w, 1 - w0 / w + c * w * w) for w in ws if w > w0]
    parts += [line([of(0.012, 0), *[p for p in bent if p[1] < y0]], INK, 2.5)]
    parts += [line([of(-1.45, 1.31), of(1.42, 1.31)], GREY, 1, "2 4")]
    parts += [dot(of(1.253, 1.31), GREEN, 6), dot(of(-0.04, 1.31), RED, 6)]
    parts += [text(436, 152, "in halves", GREEN), text(302, 152, "one step:", RED)]
    parts += [text(302, 172, "unstable", RED)]
    parts += [text(x0 - 6, y0 - 157, "1", "#222", 15, "end")]
    parts += [
        text(304, 318, "plate with a wave of h/100;"),
        text(304, 338, "1.31 p_c in one load step"),
    ]
    return drawing(350, *parts)


def curved_films():
    """Draw the heading over a fold, the turning of stresses, and the plane of the blade."""
    # Two quads that lean by theta, the heading and its projection.
    parts = [polygon([(20, 150), (150, 170), (190, 96), (72, 84)])]
    parts += [polygon([(150, 170), (244, 118), (262, 52), (190, 96)], "#c9dcf0")]
    tip = (170, 133)
    parts += [line([(44, 117), tip], RED, 2.5), arrow(tip, (250, 147), INK), dot(tip)]
    parts += [arrow(tip, (238, 96), RED, 2.5), line([(250, 147), (238, 96)], GREY, 1.2, "4 3")]
    parts += [arc(tip, 42, -10, 28), text(218, 131, "θ", GREY), text(254, 160, "h", INK)]
    parts += [text(262, 92, "a_α A_α", RED), text(30, 106, "crack", RED)]
    parts += [
        text(14, 24, "Heading"),
        text(14, 212, "in the tangents A_α of the row"),
    ]
    parts += [text(14, 232, "ahead, nearest to h")]

    # Stress: a section of the film, normals of quads turned to the director at the tip.
    centre, radius = (412, 250), 150
    points = [_polar(centre, radius, a) for a in (130, 115, 100, 85, 70, 55)]
    parts += [line(points, INK, 5)]
    parts += [dot(p, INK, 3) for p in points]
    t_foot = _polar(centre, radius, 100)
    parts += [arrow(t_foot, _polar(centre, radius + 56, 100)), dot(t_foot, RED, 6)]
    parts += [text(*_by(_polar(centre, radius + 56, 100), -16, 6), "t")]
    n_foot = _polar(centre, radius * cos(radians(7.5)), 62.5)
    parts += [arrow(n_foot, _polar(n_foot, 54, 62.5), INK)]
    parts += [arrow(n_foot, _polar(n_foot, 54, 100), RED), arc(n_foot, 40, 62.5, 100, RED)]
    parts += [text(*_by(_polar(n_foot, 54, 62.5), 6, 8), "n", INK)]
    parts += [text(*_by(_polar(n_foot, 54, 100), -22, 2), "Rn", RED)]
    parts += [text(*_by(t_foot, -16, 28), "tip", RED), text(300, 24, "Stress ahead")]
    parts += [
        text(300, 212, "R turns n to t about n × t,"),
        text(300, 232, "and with it the stress of"),
    ]
    parts += [text(300, 252, "the quad")]

    # The plane of the blade, across the film.
    x, y, lean = 250, 400, 28.0
    parts += [text(14, 286, "Blade's plane (section)")]
    parts += [line([(30, y), (490, y)], INK, 5)]
    b = (cos(radians(lean)), sin(radians(lean)))
    along = (-b[1], b[0])
    parts += [
        line(
            [(x + 120 * along[0], y - 120 * along[1]), (x - 62 * along[0], y + 62 * along[1])],
            GREY,
            3,
            "9 4",
        )
    ]
    parts += [text(x - 34, 304, "mid-plane of the blade", GREY)]
    foot = (x, y)
    parts += [arrow(foot, (x + 64 * b[0], y - 64 * b[1]), INK), text(x + 62, y - 36, "b", INK)]
    parts += [arrow((x + 150, y), (x + 150, y - 62)), text(x + 158, y - 48, "T")]
    parts += [text(x + 182, y - 20, "λ = b · T", INK)]
    tip = (110, y)
    delta = (x - tip[0]) * b[0]
    parts += [dot(tip, RED, 6), text(66, y - 12, "tip", RED)]
    parts += [line([tip, (tip[0] + delta * b[0], y - delta * b[1])], RED, 1.5, "4 3")]
    parts += [text(tip[0] + 32, y - 46, "|δ|", RED)]
    parts += [arrow((tip[0], y + 16), (x, y + 16), RED), text(116, y + 38, "|δ|/√(1 − λ²)", RED)]
    parts += [text(300, y + 38, "path to the plane in the sheet", RED)]
    return drawing(452, *parts)


def _polar(centre, radius, angle):
    return centre[0] + radius * cos(radians(angle)), centre[1] - radius * sin(radians(angle))


def adhesion():
    """Draw a film that peels from its base, and the law of the glue by the library itself."""
    from shellcut.loads.adhesion import Adhesion
    from shellcut.material.shell_material import ShellMaterial

    # The film: flat ahead of the front, then a quarter circle of the radius R_0, then straight up.
    front, ground, radius = (190, 230), 230, 62
    curve = [
        (front[0] - radius * sin(radians(a)), ground - 6 - radius * (1 - cos(radians(a))))
        for a in range(0, 91, 3)
    ]
    film = [(290, ground - 6), *curve, (curve[-1][0], 76)]
    centre = front[0], ground - 6 - radius
    parts = [
        polygon([(20, ground), (290, ground), (290, 262), (20, 262)], TOOL, "none", 0),
        line([(20, ground), (290, ground)], INK, 1.5),
        text(30, 252, "base"),
        *(line([(x, ground), (x, ground - 5)], RED, 2) for x in range(186, 290, 8)),
        line(film, "#7ea6d8", 6),
        arrow((film[-1][0], 74), (film[-1][0], 30)),
        text(film[-1][0] + 10, 42, "F"),
        line([centre, curve[15]], GREY, 1, "4 3"),
        text(centre[0] - 2, centre[1] + 34, "R_0", GREY),
        text(226, 214, "glue, τ", RED),
        line([(50, 206), (curve[-1][0], 206)], GREY, 1),
        text(52, 198, "θ = 90°", GREY),
    ]

    law = Adhesion("seal", energy=0.05).law(ShellMaterial.homogeneous(), 0.5)

    def at(d, p):
        return 345 + 150 * d / law.last, 230 - 150 * p / law.strength

    half = 0.5 * (law.first + law.last)
    soft = law.strength * (law.last - half) / (law.last - law.first)
    parts += [
        arrow((345, 230), (516, 230), INK, 1.5),
        arrow((345, 230), (345, 52), INK, 1.5),
        polygon([at(0, 0), at(law.first, law.strength), at(law.last, 0)], "#f7dedb", "none", 0),
        line([at(0, 0), at(law.first, law.strength), at(law.last, 0)], RED, 3),
        line([at(half, soft), at(0, 0)], GREY, 1.5, "5 4"),
        text(335, at(0, law.strength)[1] + 5, "s", INK, 15, "end"),
        text(at(law.last, 0)[0], 250, "d_f", INK, 15, "middle"),
        text(508, 222, "d", INK, 15, "end"),
        text(352, 60, "traction"),
        text(*_by(at(half, 0), -34, -18), "τ", RED),
    ]
    return drawing(276, *parts)


def scales():
    """Draw the stiffness of a node's contact over the side length, by the library's own law."""
    from shellcut.contact.settings import SOFTEST, STIFFEST, Contact, PenaltyLaw
    from shellcut.material.shell_material import ShellMaterial
    from shellcut.tool.shapes import straight_blade

    film = ShellMaterial.homogeneous()
    law = PenaltyLaw.of(Contact(), film, straight_blade())
    stretching = film.stretching_stiffness

    def at(side, k):
        return 70 + 190 * (log10(side) + 1.3), 288 - 80 * (log10(k) + 1.0)

    sides = [10 ** (-1.25 + 2.0 * n / 160) for n in range(161)]
    felt = [(s, float(law.of_nodes(s * s / 4)) / stretching) for s in sides]
    free = [(s, law.penalty * s * s / 4 / stretching) for s in sides]
    parts = []
    for k in (0.1, 1, 10, 100):
        parts += [line([at(0.05, k), at(6.3, k)], "#ddd", 1)]
        parts += [text(62, at(1, k)[1] + 5, f"{k:g}", "#222", 15, "end")]
    for s in (0.1, 0.3, 1, 3):
        parts += [line([at(s, 0.1), at(s, 130)], "#ddd", 1)]
        parts += [text(at(s, 1)[0], 308, f"{s:g}", "#222", 15, "middle")]
    inside = [(s, k) for s, k in free if 0.1 <= k <= 130]
    parts += [
        line([at(*p) for p in inside], GREY, 1.5, "5 4"),
        line([at(*p) for p in felt], RED, 3),
    ]
    for bound in (SOFTEST, STIFFEST):
        side = 2 * sqrt(bound * stretching / law.penalty)
        parts += [line([at(side, 0.1), at(side, bound)], INK, 1, "3 3"), dot(at(side, bound), RED)]
        parts += [text(at(side, 1)[0] + 6, 278, f"{side:.2g} mm", INK)]
    parts += [text(*_by(at(0.06, SOFTEST), 0, -10), f"{SOFTEST:g} E h", RED)]
    parts += [text(*_by(at(1.5, STIFFEST), 14, 24), f"{STIFFEST:g} E h", RED)]
    parts += [text(*_by(at(0.36, 4), 0, 8), "λ l²/4", GREY, 15, "end")]
    parts += [
        text(14, 22, "k/(E h), of a node of even quads"),
        text(290, 332, "side l of the quads, mm"),
    ]
    return drawing(344, *parts)


def opening():
    """Draw a tooth in its cut, with the keys that shape it, and the film from above."""
    eta, relief, unit = radians(60), radians(30), 74
    tip = (200, 196)

    def at(s, z):
        return tip[0] + unit * s, tip[1] - unit * z

    top = 2.1
    face = [at(0, 0), at(top / tan(eta), top), at(-1.5, top), at(-1.5, 1.5 * tan(relief))]
    sheet = 0.62
    parts = [polygon(face, TOOL, "none", 0)]
    parts += [line([face[2], face[3], face[0]], GREY, 2), line([face[0], face[1]], RED, 4)]
    y = at(0, sheet)[1]
    cut = at(sheet / tan(eta), sheet)
    parts += [line([cut, (460, y)], INK, 6), line([(20, y), at(-1.5, sheet)], "#9ab", 6, "9 5")]
    parts += [text(392, y - 10, "film, h", INK), text(24, y - 10, "cut", "#678"), dot(cut, RED, 6)]
    parts += [arc(cut, 34, 0, 60), text(cut[0] + 36, y - 14, "η", GREY)]
    parts += [line([at(-0.9, 0), at(0.9, 0)], GREY, 1, "3 3"), arc(tip, 50, 150, 180)]
    parts += [text(tip[0] - 132, tip[1] + 16, "relief_deg", GREY)]
    parts += [measure((at(-1.5, 0)[0], tip[1] + 28), (tip[0], tip[1] + 28))]
    parts += [text(at(-1.1, 0)[0], tip[1] + 48, "length", GREY)]
    parts += [text(at(0.2, 0)[0] - 4, tip[1] - 2 + 20, "tip")]
    parts += [text(face[1][0] + 10, 62, "edge, at η =", RED)]
    parts += [text(face[1][0] + 10, 82, "edge_inclination_deg", RED)]
    far = (372, tip[1] + 8)
    parts += [
        arrow((300, tip[1] + 8), far),
        arrow(far, (372, tip[1] + 42)),
    ]
    parts += [arrow((300, tip[1] + 8), (372, tip[1] + 42), RED)]
    parts += [text(304, tip[1] + 2, "r dθ"), text(380, tip[1] + 32, "(p/2π) dθ")]
    parts += [text(250, tip[1] + 58, "motion: pitch = p", RED)]
    parts += [text(14, 22, "A tooth on the unrolled cylinder r = radius")]

    # From above.
    centre, scale = (118, 392), 9.4
    rim, ring = 10.2 * scale, 9.4 * scale
    parts += [f'<circle cx="{centre[0]}" cy="{centre[1]}" r="{rim + 5:.1f}" fill="#9ab"/>']
    parts += [f'<circle cx="{centre[0]}" cy="{centre[1]}" r="{rim:.1f}" fill="{FILM}"/>']
    parts += [
        f'<circle cx="{centre[0]}" cy="{centre[1]}" r="{ring:.1f}" fill="none" '
        f'stroke="{RED}" stroke-dasharray="5 4"/>'
    ]
    for k in range(4):
        parts += [_tooth_from_above(centre, scale, 90 * k + 20)]
    parts += [line([centre, (centre[0] + ring, centre[1])], GREY, 1), dot(centre, GREY, 2.5)]
    parts += [text(centre[0] + 14, centre[1] - 6, "radius", GREY)]
    parts += [arc(centre, 52, 100, 155, "#222"), _head_on_arc(centre, 52, 155)]
    parts += [text(centre[0] - 46, centre[1] + 44, "teeth = 4")]

    # The wedge, in a section parallel to the sheet.
    nose, slope, unit = (476, 394), tan(radians(12)), 92
    wide = 0.35
    back, corner = nose[0] - 2.35 * unit, nose[0] - wide / slope * unit
    wedge = [
        nose,
        (corner, nose[1] - wide * unit),
        (back, nose[1] - wide * unit),
        (back, nose[1] + wide * unit),
        (corner, nose[1] + wide * unit),
    ]
    parts += [polygon(wedge, TOOL, GREY, 2), dot(nose, RED, 6)]
    parts += [line([(back, nose[1]), nose], GREY, 1, "8 3 2 3"), arc(nose, 84, 168, 180)]
    parts += [text(nose[0] - 206, nose[1] - 52, "wedge_half_angle_deg", GREY)]
    parts += [line([(nose[0] - 90, nose[1] - 48), (nose[0] - 80, nose[1] - 10)], GREY, 1)]
    parts += [measure((back + 14, nose[1] - wide * unit), (back + 14, nose[1]))]
    parts += [text(back + 22, nose[1] - 8, "half_thickness", GREY)]
    parts += [
        text(nose[0] - 36, nose[1] + 26, "edge", RED),
        text(262, 314, "Section parallel to the sheet"),
    ]
    parts += [text(14, 276, "From above: clamped border")]
    return drawing(504, *parts)


def _head_on_arc(centre, radius, angle):
    end = _polar(centre, radius, angle)
    return arrow(_polar(centre, radius, angle - 10), _by(end, -1, 2), "#222", 1.2)


def _tooth_from_above(centre, scale, first):
    """Draw a tooth wound on its circle; its tip is at an angle [deg]."""
    radius, slope = 9.4, tan(radians(12))
    outline = []
    steps = [2.4 * k / 8 for k in range(9)]
    for side, way in ((1, steps), (-1, steps[::-1])):
        for d in way:
            out = radius + side * min(d * slope, 0.35)
            outline.append(_polar(centre, out * scale, first - degrees(d / radius)))
    return polygon(outline, "#b9c0c9", GREY, 1)


def yielding_disc():
    """Draw the disc, and how far each program is from CalculiX's solids, by the page's table."""
    page = (DOCS / "theory" / "yielding-disc.md").read_text(encoding="utf-8")
    table = page.split("| E = 1678 MPa")[1].split("\n\n")[0]
    rows = [[cell.strip() for cell in row.split("|")] for row in ("|" + table).splitlines()]
    values = {row[1]: row[2:8] for row in rows[2:]}
    pressure = [float(cell) for cell in rows[0][2:8]]
    solids = next(row for name, row in values.items() if "solids" in name)
    solids = [float(cell) for cell in solids]

    # The disc, deflected: drawn three times as deep, thickness ten times.
    parts = [polygon([(24, 44), (66, 44), (66, 84), (24, 84)], "#c8cfd8", GREY, 1)]
    parts += [polygon([(454, 44), (496, 44), (496, 84), (454, 84)], "#c8cfd8", GREY, 1)]
    shape = [(66 + 388 * k / 60, 64 + 62 * (1 - (2 * k / 60 - 1) ** 2)) for k in range(61)]
    parts += [line(shape, INK, 7)]
    for k in range(5, 60, 10):
        foot = shape[k]
        parts += [arrow((foot[0], 30), (foot[0], foot[1] - 7), RED, 1.5)]
    parts += [line([(260, 64), (260, 64)], GREY, 1), text(308, 34, "p", RED)]
    parts += [line([(66, 64), (454, 64)], GREY, 1, "8 3 2 3")]
    parts += [measure((260, 64), (260, 122)), text(268, 92, "w", GREY)]
    parts += [measure((260, 150), (454, 150)), text(330, 168, "R = 10 mm", GREY)]
    parts += [text(24, 106, "clamped", GREY), text(24, 152, "h = 0.1 mm; w, h not to scale", INK)]

    def at(p, ratio):
        return 70 + 2000 * p, 296 - 20 * ratio

    for ratio in (-4, -2, 0, 2):
        parts += [line([at(0, ratio), at(0.205, ratio)], "#222" if ratio == 0 else "#ddd", 1)]
        parts += [
            text(
                62,
                at(0, ratio)[1] + 5,
                f"{ratio:+d} %".replace("-", "−") if ratio else "0",
                "#222",
                15,
                "end",
            )
        ]
    for p in (0.0, 0.05, 0.1, 0.15, 0.2):
        parts += [text(at(p, 0)[0], 402, f"{p:g}", "#222", 15, "middle")]
    drawn = {
        "1,260 quads": (RED, ""),
        "560 quads": (RED, "6 4"),
        "CalculiX, shells, 384, border clamped": (INK, ""),
        "shells, 60, border free to rotate": (INK, "6 4"),
    }
    for name, (colour, dash) in drawn.items():
        over = [100 * (float(w) / s - 1) for w, s in zip(values[name], solids, strict=True)]
        points = [at(*pair) for pair in zip(pressure, over, strict=True)]
        parts += [line(points, colour, 2, dash), *[dot(p, colour, 3.5) for p in points]]
    parts += [text(14, 208, "w over that of CalculiX's solids, less 1; E = 1678 MPa")]
    parts += [text(300, 424, "pressure p, MPa")]
    return drawing(490, *parts, *_legend(drawn))


def _legend(drawn):
    names = [
        "ours, 1,260 quads",
        "ours, 560 quads",
        "CalculiX's shells, border clamped",
        "border free to rotate",
    ]
    places = [(20, 450), (20, 474), (230, 450), (230, 474)]
    for name, (x, y), (colour, dash) in zip(names, places, drawn.values(), strict=True):
        yield line([(x, y - 5), (x + 34, y - 5)], colour, 2, dash) + text(x + 42, y, name, colour)


PICTURES = {
    "shell": shell,
    "cables": cables,
    "fracture": fracture,
    "statics": statics,
    "curved-films": curved_films,
    "scales": scales,
    "adhesion": adhesion,
    "opening": opening,
    "yielding-disc": yielding_disc,
}


def path(name):
    """Return where the picture of a page is stored."""
    return DOCS / "img" / f"theory_{name}.svg"


if __name__ == "__main__":
    for name, draw in PICTURES.items():
        path(name).write_text(draw(), encoding="utf-8")
