"""Round numbers at an axis, and how they are written."""

from __future__ import annotations

import math


def ticks_of(low: float, high: float, n: int) -> list[float]:
    """Return about ``n`` round numbers from ``low`` or below it to ``high`` or above it."""
    if not high > low:
        high = low + 1.0
    raw = (high - low) / n
    unit = 10.0 ** math.floor(math.log10(raw))
    step = next(m * unit for m in (1.0, 2.0, 2.5, 5.0, 10.0) if m * unit >= raw)
    first, last = math.floor(low / step + 1e-9), math.ceil(high / step - 1e-9)
    return [k * step for k in range(first, last + 1)]


def tick_text(value: float) -> str:
    """Return a number as it stands at an axis."""
    return f"{value + 0.0:.6g}".replace("-", "−")
