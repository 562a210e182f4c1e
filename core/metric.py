"""Lengths and areas: in the plane, or on the ellipsoid for longitudes and latitudes.

A metric is three functions of vertex coordinates, so that no other stage needs to know what the
coordinates mean. On an ellipsoid

* a length is that of the geodesic, from the chord through the ellipsoid (largest error measured:
  0.0011 % for edges up to 1,000 km, 0.03 % up to 5,000 km, 0.34 % up to 15,000 km);
* areas are those of the ellipsoid, in a cylindrical equal-area map;
* the Delaunay property is that of the Mercator projection: it is conformal, and it keeps
  parallels and meridians straight.
"""

from __future__ import annotations

from typing import Callable, NamedTuple

import numpy as np

__all__ = ["FARTHEST", "Metric", "ellipsoidal", "planar"]

FARTHEST = 1e75  # coordinate; the squares and products of larger ones are no numbers


class Metric(NamedTuple):
    """How to measure.

    Attributes
    ----------
    positions : callable
        ``(n, 2)`` coordinates to an ``(n, k)`` array of positions.
    length : callable
        ``(positions, u, v)`` to the lengths of the edges u-v, in units of the ground.
    equal_area : callable
        ``(n, 2)`` coordinates to ``(n, 2)`` coordinates of a plane with true areas.
    conformal : callable or None
        ``(n, 2)`` coordinates to the plane to triangulate in; None for the input's own plane.
    degrees : float
        Degrees in one unit of the coordinates, where they are angles.
    """

    positions: Callable
    length: Callable
    equal_area: Callable
    conformal: Callable | None
    degrees: float = 1.0


def planar() -> Metric:
    """Return the metric of projected coordinates.

    Examples
    --------
    >>> plane, xy = planar(), np.array([[0, 0], [3, 4.0]])
    >>> plane.length(plane.positions(xy), [0], [1]).tolist()
    [5.0]
    """
    return Metric(_same, _planar_length, _same, None)


def ellipsoidal(*, a: float = 6378137.0, b: float = 6356752.314245179, degrees: float = 1.0) -> Metric:
    """Return the metric of longitude and latitude on an ellipsoid.

    Parameters
    ----------
    a, b : float
        Equatorial and polar radius in metres (default WGS 84).
    degrees : float
        In one unit of the coordinates: 0.9 for grads.

    Examples
    --------
    A degree of longitude in kilometres, at the equator and at 60 degrees north.

    >>> earth, xy = ellipsoidal(), np.array([[0, 0], [1, 0], [0, 60], [1, 60.0]])
    >>> (earth.length(earth.positions(xy), [0, 2], [1, 3]) / 1000).round(1).tolist()
    [111.3, 55.8]
    """
    e2 = 1.0 - (b / a) ** 2
    e = np.sqrt(e2)
    radius = (2.0 * a + b) / 3.0

    def radians(angle):
        return np.radians(angle * degrees)

    def positions(xy):
        lon, lat = radians(xy[:, 0]), radians(xy[:, 1])
        normal = a / np.sqrt(1.0 - e2 * np.sin(lat) ** 2)
        flat = normal * np.cos(lat)
        return np.column_stack((flat * np.cos(lon), flat * np.sin(lon), normal * (1.0 - e2) * np.sin(lat)))

    def length(position, u, v):
        d = position[u]
        d -= position[v]
        chord = np.sqrt(np.einsum("ij,ij->i", d, d))
        # arc over the chord on the mean sphere; a nanometre keeps distinct vertices apart
        arc = 2.0 * radius * np.arcsin(np.minimum(chord / (2.0 * radius), 1.0))
        return np.maximum(arc, 1e-9)

    def authalic(sin_lat):
        if e2 <= 0.0:
            return sin_lat
        return (1.0 - e2) / 2.0 * (sin_lat / (1.0 - e2 * sin_lat**2) + np.arctanh(e * sin_lat) / e)

    def equal_area(xy):
        return a * np.column_stack((radians(xy[:, 0]), authalic(np.sin(radians(xy[:, 1])))))

    def conformal(xy):
        sin_lat = np.sin(radians(xy[:, 1]))
        isometric = np.arctanh(sin_lat)
        if e2 > 0.0:
            isometric -= e * np.arctanh(e * sin_lat)
        return np.column_stack((xy[:, 0], np.degrees(isometric) / degrees))

    return Metric(positions, length, equal_area, conformal, degrees)


def _same(xy):
    return xy


def _planar_length(position, u, v):
    d = position.take(u, axis=0)
    d -= position.take(v, axis=0)
    return np.hypot(d[:, 0], d[:, 1])
