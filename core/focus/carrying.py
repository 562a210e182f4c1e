"""Other layers, carried along by the deformation of a map."""

from __future__ import annotations

import numpy as np
import shapely

from .mesh import flatness, heights

__all__ = ["Carrier"]

AT_ONCE = 200_000  # triangles that are shapely's at a time


class Carrier:
    """The piecewise linear map of the frame that moves the map itself.

    A point on a line of the map stays on it, and a point in the focus scales with it. Beyond the
    frame a point moves as the nearest point of the frame does.

    Parameters
    ----------
    points, moved : (n, 2) float
        Vertices of the triangulation before and after.
    triangles : (t, 3) int
        They cover the rectangle around all points.

    Examples
    --------
    >>> square = np.array([(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0), (1.0, 1.0)])
    >>> moved = square + (0.0, 0.0)
    >>> moved[4] = 1.5, 1.0
    >>> fan = np.array([(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)])
    >>> Carrier(square, moved, fan)(np.array([(0.5, 1.0)]))
    array([[0.75, 1.  ]])
    """

    def __init__(self, points: np.ndarray, moved: np.ndarray, triangles: np.ndarray) -> None:
        self._points, self._shift = points, moved - points
        self._flat = flatness(points)
        # of triangles that meet in a point the largest tells most exactly where it goes, a flat one nothing
        a, b, c = points[triangles].transpose(1, 0, 2)
        order = np.argsort(_cross(b - a, c - a), kind="stable")
        self._triangles = triangles[order[heights(points, triangles[order]) > self._flat]]
        self._low, self._high = points.min(axis=0), points.max(axis=0)

    def __call__(self, xy: np.ndarray) -> np.ndarray:
        """Return where points go.

        Parameters
        ----------
        xy : (k, 2) float
            Those that are not finite stay.

        Notes
        -----
        O((t + k) log k) for t triangles.
        """
        result = np.array(xy, dtype=float)
        finite = np.flatnonzero(np.isfinite(result).all(axis=1))
        if not len(finite):
            return result
        near = np.clip(result[finite], self._low, self._high)
        result[finite] += self._shift_at(near)
        return result

    def _shift_at(self, xy):
        found = self._found(xy)
        lost = np.flatnonzero(found < 0)  # in a gap of rounding, or a flat triangle
        found[lost] = self._found(xy[lost], 10.0 * self._flat)
        corner = self._triangles[found]
        a, b, c = self._points[corner].transpose(1, 0, 2)
        whole = _cross(b - a, c - a)
        weight = np.column_stack((_cross(xy - a, c - a), _cross(b - a, xy - a))) / whole[:, None]
        weight = np.column_stack((1.0 - weight.sum(axis=1), weight))
        # displacements rather than positions: where nothing moves, not a bit changes
        shift = np.einsum("ij,ijk->ik", weight, self._shift[corner])
        shift[found < 0] = 0.0
        return shift

    def _found(self, xy, near=None):
        """The largest triangle at each point, or near it, -1 for none."""
        found = np.full(len(xy), -1)
        if not len(xy):
            return found
        tree = shapely.STRtree(shapely.points(xy))
        how = {"predicate": "intersects"} if near is None else {"predicate": "dwithin", "distance": near}
        for start in range(0, len(self._triangles), AT_ONCE):
            corners = self._points[self._triangles[start : start + AT_ONCE]]
            one, other = tree.query(shapely.polygons(corners), **how)
            np.maximum.at(found, other, start + one)
        return found


def _cross(p, q):
    return p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]
