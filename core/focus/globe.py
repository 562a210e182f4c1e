"""Maps in degrees: what they have to keep to."""

from __future__ import annotations

import math

import numpy as np

__all__ = ["is_on_the_globe", "on_the_globe"]


def on_the_globe(rows: np.ndarray, growth: float) -> tuple[float, float]:
    """Return the growth for which a map in degrees stays on the globe, and its aspect.

    Parameters
    ----------
    rows : (k, 2) float
        Longitudes and latitudes.
    growth : float
        The share by which the map may grow.

    Returns
    -------
    growth : float
        At most that.
    aspect : float
        How long a unit of longitude is, in units of latitude, at the middle latitude of the map.

    Examples
    --------
    >>> growth, aspect = on_the_globe(np.array([[-170.0, 50.0], [170.0, 70.0]]), 0.5)
    >>> round(growth, 3), round(aspect, 3)
    (0.059, 0.5)
    """
    low, high = rows.min(axis=0), rows.max(axis=0)
    size = (high - low).tolist()
    for axis, end in enumerate((180.0, 90.0)):
        room = min(end + low[axis], end - high[axis])
        growth = max(min(growth, 2.0 * room / size[axis] if size[axis] > 0.0 else growth), 0.0)
    middle = min(abs(low[1] + high[1]) / 2.0, 85.0)
    return float(growth), math.cos(math.radians(middle))


def is_on_the_globe(rows: np.ndarray, before: np.ndarray) -> bool:
    """Whether a moved map in degrees is still on the globe: no farther out than it was, or in its bounds.

    Parameters
    ----------
    rows : (k, 2) float
        Longitudes and latitudes.
    before : (k, 2) float
        Those before, whose longitudes may go from 0 to 360, too.

    Examples
    --------
    >>> is_on_the_globe(np.array([[181.0, 60.0]]), np.array([[170.0, 60.0]]))
    False
    >>> is_on_the_globe(np.array([[350.0, 60.0]]), np.array([[355.0, 60.0]]))
    True
    """
    reach = np.maximum(np.abs(before).max(axis=0), (180.0, 90.0))
    return bool((np.abs(rows) <= reach).all())
