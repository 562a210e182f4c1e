"""How much a deformed map is distorted: on one yardstick, the triangles of the input."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

__all__ = ["Distortion", "angular_distortion", "distortion"]


class Distortion(NamedTuple):
    """Distortion of a map.

    Attributes
    ----------
    flipped : float
        Share of the input's area whose triangles lie upside down, 0 to 1.
    median, high : float
        Angular distortion in degrees that half, and 95 %, of the area do not exceed.
    """

    flipped: float
    median: float
    high: float


def angular_distortion(
    before: np.ndarray, after: np.ndarray, triangles: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return area, orientation and angular distortion of triangles.

    Parameters
    ----------
    before, after : (n, 2) float
    triangles : (m, 3) int

    Returns
    -------
    area : (m,) float
        Before.
    kept : (m,) bool
        Whether the orientation is the same.
    angle : (m,) float
        The most by which the affine map changes an angle between two directions, in degrees
        (Tissot's omega, 0 for a similarity); 180 for a triangle upside down.

    Notes
    -----
    With singular values a >= b of the map, omega = 2 arcsin((a - b) / (a + b)).

    Examples
    --------
    A triangle as it is, stretched to twice its width, and upside down:

    >>> before, triangle = np.array([(0, 0), (1, 0), (0, 1.0)]), np.array([(0, 1, 2)])
    >>> for factor in ((1, 1), (2, 1), (1, -1)):
    ...     area, kept, angle = angular_distortion(before, before * factor, triangle)
    ...     print(area.tolist(), kept.tolist(), angle.round(1).tolist())
    [0.5] [True] [0.0]
    [0.5] [True] [38.9]
    [0.5] [False] [180.0]
    """
    p, q = (xy[triangles[:, 1:]] - xy[triangles[:, :1]] for xy in (before, after))
    area = p[:, 0, 0] * p[:, 1, 1] - p[:, 0, 1] * p[:, 1, 0]
    ok = area != 0.0
    inverse = np.empty_like(p)
    inverse[:, 0, 0], inverse[:, 1, 1] = p[:, 1, 1], p[:, 0, 0]
    inverse[:, 0, 1], inverse[:, 1, 0] = -p[:, 0, 1], -p[:, 1, 0]
    # q = p A, rows being vectors; A up to the factor area, which no angle depends on
    a = np.einsum("ijk,ikl->ijl", inverse, q) * np.sign(area)[:, None, None]
    both = np.hypot(a[:, 0, 0] + a[:, 1, 1], a[:, 0, 1] - a[:, 1, 0])  # sum of singular values
    apart = np.hypot(a[:, 0, 0] - a[:, 1, 1], a[:, 0, 1] + a[:, 1, 0])  # difference
    kept = ~ok | (both > apart)
    with np.errstate(all="ignore"):
        angle = np.degrees(2.0 * np.arcsin(np.minimum(apart / both, 1.0)))
    return np.abs(area) / 2.0, kept, np.where(kept, np.where(ok, angle, 0.0), 180.0)


def distortion(before: np.ndarray, after: np.ndarray, triangles: np.ndarray) -> Distortion:
    """Return the `Distortion` of triangles, weighed by their area before.

    Examples
    --------
    Of a square, one half is stretched to twice its width.

    >>> before = np.array([(0, 0), (1, 0), (1, 1), (0, 1.0)])
    >>> after, halves = before + [(0, 0), (1, 0), (0, 0), (0, 0)], np.array([(0, 1, 3), (1, 2, 3)])
    >>> found = distortion(before, after, halves)
    >>> found.flipped, round(found.median, 1), round(found.high, 1)
    (0.0, 38.9, 53.1)
    """
    if not len(triangles):
        return Distortion(0.0, 0.0, 0.0)
    area, kept, angle = angular_distortion(before, after, triangles)
    order = np.argsort(angle)
    share = np.cumsum(area[order])
    total = share[-1] or 1.0
    median, high = (
        float(angle[order[min(np.searchsorted(share, q * total), len(order) - 1)]]) for q in (0.5, 0.95)
    )
    return Distortion(float(area[~kept].sum() / total), median, high)
