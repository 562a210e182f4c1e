"""Other layers, carried along by the deformation of a map."""

from __future__ import annotations

import numpy as np
import shapely

__all__ = ["Carrier"]

MARGIN = 0.1  # how far around the map it takes to come to rest, as a share of its size
ROUNDS = 4  # of splitting edges that a Delaunay triangulation does not have


class Carrier:
    """The deformation of the plane that goes with that of a map.

    Linear on each triangle of a Delaunay triangulation of all vertices, so a point at a vertex goes
    where the vertex goes. Inside the focus it is the scaling itself. Outside the map it comes to
    rest.

    Parameters
    ----------
    points, moved : (n, 2) float
        Vertices before and after.
    edges : (m, 2) int
        Edges that the triangulation should respect.
    focus : shapely geometry
        The region in focus.
    scale : float
        Its scale.
    grows : bool
        Whether the map may grow: then the plane around it grows as well.
    """

    def __init__(self, points, moved, edges, focus, scale, grows=False):
        from scipy.spatial import Delaunay

        low, high = points.min(axis=0), points.max(axis=0)
        size = (high - low).max() or 1.0
        self._shift, self._size = (low + high) / 2.0, size
        corners = shapely.get_coordinates(
            shapely.segmentize(shapely.box(*(low - MARGIN * size), *(high + MARGIN * size)), size / 20.0)
        )[:-1]
        rest = corners
        if grows:
            middle, middle_after = (low + high) / 2.0, (moved.min(axis=0) + moved.max(axis=0)) / 2.0
            growth = np.ptp(moved, axis=0) / np.maximum(high - low, 1e-300)
            rest = middle_after + (corners - middle) * growth
        self._low, self._high = corners.min(axis=0), corners.max(axis=0)
        before, after = self._with_focus(points, moved, focus, scale)
        before, after = np.concatenate((before, corners)), np.concatenate((after, rest))
        before, first = np.unique(before, axis=0, return_index=True)
        after = after[first]
        edges = _located(before, points, edges)
        for attempt in range(ROUNDS):
            mesh = Delaunay((before - self._shift) / size)
            if attempt == ROUNDS - 1:
                break
            there = mesh.simplices[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
            n = len(before)
            keys = np.unique(np.sort(there, axis=1) @ np.array([n, 1]))
            missing = ~np.isin(np.sort(edges, axis=1) @ np.array([n, 1]), keys)
            if not missing.any():
                break
            u, v = edges[missing].T
            half = n + np.arange(len(u))
            before = np.concatenate((before, (before[u] + before[v]) / 2.0))
            after = np.concatenate((after, (after[u] + after[v]) / 2.0))
            edges = np.concatenate(
                (edges[~missing], np.column_stack((u, half)), np.column_stack((half, v)))
            )
        self._mesh, self._before, self._after = mesh, before, after

    def __call__(self, xy):
        """Return where points go.

        Parameters
        ----------
        xy : (k, 2) float
        """
        local = (xy - self._shift) / self._size
        with np.errstate(invalid="ignore"):
            triangle = self._mesh.find_simplex(local)
        found = triangle >= 0
        result = xy.copy()
        corner = self._mesh.simplices[triangle[found]]
        transform = self._mesh.transform[triangle[found]]
        part = np.einsum("ijk,ik->ij", transform[:, :2], local[found] - transform[:, 2])
        weight = np.column_stack((part, 1.0 - part.sum(axis=1)))
        # displacements rather than positions: where nothing moves, not a bit changes
        shift = np.einsum("ij,ijk->ik", weight, (self._after - self._before)[corner])
        shift[~np.isfinite(shift)] = 0.0
        result[found] += shift
        if (~found).any():  # beyond: as the nearest point of the frame
            outside = np.flatnonzero(~found & np.isfinite(xy).all(axis=1))
            if len(outside) and not np.array_equal(self._after, self._before):
                near = np.clip(xy[outside], self._low, self._high)
                inside = np.clip(near, self._low + 1e-9 * self._size, self._high - 1e-9 * self._size)
                result[outside] += self(inside) - inside
        return result

    def _with_focus(self, points, moved, focus, scale):
        """The vertices, and the outline of the focus, which scales exactly."""
        before, after = [points], [moved]
        for region in shapely.get_parts(focus):
            inside = np.flatnonzero(shapely.covers(region, shapely.points(points)))
            if not len(inside):
                continue
            a = inside[0]
            step = self._size / 200.0
            outline = shapely.get_coordinates(shapely.segmentize(region, step))
            before.append(outline)
            after.append(moved[a] + scale * (outline - points[a]))
        return np.concatenate(before), np.concatenate(after)


def _located(xy, points, edges):
    """The edges between ``points`` as edges between the same places in ``xy``."""
    from scipy.spatial import cKDTree

    return cKDTree(xy).query(points)[1][edges]
