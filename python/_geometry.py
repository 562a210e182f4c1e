"""Shapely's geometries as arrays, and arrays as geometries: Z and M come and go bit for bit."""

from __future__ import annotations

from typing import Iterator, NamedTuple

import numpy as np
import shapely

from .core import wkb
from .core.metric import Metric, planar
from .core.partition.features import CHUNK_FEATURES, CHUNK_VERTICES, Chunk, beyond_the_poles
from .core.rings import Rings, closed, offsets_of

POLYGON, MULTIPOLYGON = 3, 6
_has_m = getattr(shapely, "has_m", None)


class Polygons(NamedTuple):
    """The polygons of geometries.

    Attributes
    ----------
    shapes : (q,) object
        Each by itself, none empty.
    rings : Rings
        Without closing vertices; one with another Z or M is a vertex of its own.
    owner : (q,) int
        The geometry of each.
    extra : (n,) int
        Of each geometry: 1000 for Z and 2000 for M.
    """

    shapes: np.ndarray
    rings: Rings
    owner: np.ndarray
    extra: np.ndarray


def read_polygons(geometries: np.ndarray) -> Polygons:
    """Return the polygons of geometries; others than polygons and multipolygons have none."""
    kind = shapely.get_type_id(geometries)
    # shapely copies each part that it gets: a polygon that is one already is taken as it is
    alone, several = np.flatnonzero(kind == POLYGON), np.flatnonzero(kind == MULTIPOLYGON)
    parts, of = shapely.get_parts(geometries[several], return_index=True)
    shapes, owner = np.append(geometries[alone], parts), np.append(alone, several[of])
    order = np.argsort(owner, kind="stable")
    order = order[~shapely.is_empty(shapes[order])]
    shapes, owner = shapes[order], owner[order]
    extra = extra_of(geometries)
    ordinates = np.unique(extra[owner])
    lines, polygon = shapely.get_rings(shapes, return_index=True)
    coords, ring = _coordinates(lines, ordinates)
    size = np.bincount(ring, minlength=len(lines))
    if len(ordinates) > 1:  # what a geometry lacks is 0 at the end of its rows, as in QGIS
        own = extra[owner[polygon[ring]]]
        if coords.shape[1] == 4:
            coords[own == 2000, 2] = coords[own == 2000, 3]
        coords[own == 0, 2:] = 0.0
        coords[(own == 1000) | (own == 2000), 3:] = 0.0
    offsets = offsets_of(size)
    long = np.flatnonzero(size > 1)
    bits = coords.view(np.int64)
    shut = long[(bits[offsets[:-1][long]] == bits[offsets[1:][long] - 1]).all(axis=1)]
    kept = np.ones(len(coords), dtype=bool)
    kept[offsets[1:][shut] - 1] = False
    size[shut] -= 1
    rings = Rings(coords[kept], offsets_of(size), offsets_of(np.bincount(polygon, minlength=len(shapes))))
    return Polygons(shapes, rings, owner, extra)


def extra_of(geometries: np.ndarray) -> np.ndarray:
    """Return 1000 for Z and 2000 for M of each geometry."""
    extra = 1000 * shapely.has_z(geometries).astype(np.int64)
    return extra if _has_m is None else extra + 2000 * _has_m(geometries)


def _coordinates(geometries: np.ndarray, ordinates: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Coordinates with all ordinates that there are, and the geometry of each."""
    options = {"include_m": True} if (ordinates >= 2000).any() else {}
    coords, of = shapely.get_coordinates(
        geometries, include_z=bool((ordinates % 2000).any()), return_index=True, **options
    )
    return np.ascontiguousarray(coords), of


def polygons(
    coords: np.ndarray, rows: np.ndarray, offsets: np.ndarray, ring_offsets: np.ndarray, extra: np.ndarray
) -> np.ndarray:
    """Return polygons of rings of rows; see ``core.wkb.polygons``."""
    if _plain(coords, extra):
        place, closed_offsets = closed(offsets)
        return shapely.from_ragged_array(
            shapely.GeometryType.POLYGON, coords[rows[place]], (closed_offsets, ring_offsets)
        )
    return shapely.from_wkb(list(wkb.polygons(coords, rows, offsets, ring_offsets, extra.tolist(), False)))


def _plain(coords: np.ndarray, extra: np.ndarray) -> bool:
    """Whether shapely makes geometries of arrays: no M, no Z for some only, no Z that is none (it would close
    such rings twice)."""
    if not len(extra):
        return coords.shape[1] < 4
    alike = bool((extra == extra[0]).all()) and extra[0] < 2000 and coords.shape[1] == 2 + extra[0] // 1000
    return alike and not np.isnan(coords[:, 2:]).any()


def lines(
    coords: np.ndarray, rows: np.ndarray, extra: np.ndarray, offsets: np.ndarray | None = None
) -> np.ndarray:
    """Return lines along rows; see ``core.wkb.lines``."""
    if offsets is None and _plain(coords, extra):
        return shapely.linestrings(coords[rows])
    return shapely.from_wkb(list(wkb.lines(coords, rows, extra.tolist(), offsets)))


def chunks(geometries: np.ndarray, measure: Metric) -> Iterator[tuple[Chunk, np.ndarray]]:
    """Yield the chunks of geometries, their places as features, and the polygons of each by themselves.

    Those with a latitude beyond 90 degrees are measured in the plane: their CRS cannot be right.
    """
    passed = offsets_of(1 + shapely.get_num_coordinates(geometries))
    lo, count = 0, len(geometries)
    while lo < count or not lo:  # nothing is a chunk, too: its results have their fields
        hi = int(np.searchsorted(passed, passed[lo] + CHUNK_VERTICES, side="right")) - 1
        hi = min(max(hi, lo + 1), lo + CHUNK_FEATURES, count)
        found = read_polygons(geometries[lo:hi])
        runs = [np.arange(lo, hi)]
        if measure.conformal:
            strange = beyond_the_poles(found.rings, found.owner, hi - lo, measure)
            runs = np.split(runs[0], np.flatnonzero(np.diff(strange)) + 1)
        for run in runs:
            if len(runs) > 1:
                found = read_polygons(geometries[run])
            own = planar() if len(run) and measure.conformal and strange[run[0] - lo] else measure
            yield Chunk(run, found.rings, found.owner, found.extra, own), found.shapes
        lo = hi
        if not count:
            return
