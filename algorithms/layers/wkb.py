"""The only place where QgsGeometry becomes arrays, and arrays become QgsGeometry.

Through WKB: coordinates, Z and M included, come and go bit for bit.
"""

from __future__ import annotations

import struct
from functools import lru_cache
from typing import Collection, Iterable, Iterator, Sequence

import numpy as np
from qgis.core import QgsGeometry, QgsWkbTypes

from ...core import wkb
from ...core.rings import Rings, offsets_of, take


def read_polygons(geometries: Iterable[QgsGeometry]) -> tuple[Rings, np.ndarray, list[int]]:
    """Return the polygons of geometries as arrays.

    Parameters
    ----------
    geometries : iterable of QgsGeometry
        Polygons or multipolygons; curves become segments. Others have no polygons.

    Returns
    -------
    rings : core.rings.Rings
        All polygons, without closing vertices; empty ones are left out. Rows have as many columns as
        the geometry with the most ordinates; what another lacks is 0 at the end of its rows.
    owner : (p,) int
        The place of the geometry of each polygon.
    extra : list of int
        The `dimensions` of each geometry.
    """
    owner, extra, runs, ring_counts = [], [], [], []
    for number, geometry in enumerate(geometries):
        geometry, (own_extra, is_polygon, multi, _) = _straight(geometry)
        extra.append(own_extra)
        if is_polygon:
            counts = _find_rings(geometry.asWkb().data(), multi, wkb.width(own_extra), runs)
            owner += [number] * len(counts)
            ring_counts += counts
    coords, offsets = _without_closing(*_coordinates(runs))
    rings = Rings(coords, offsets, offsets_of(ring_counts))
    owner = np.array(owner, dtype=np.int64)
    empty = np.diff(offsets[rings.polygon_offsets]) == 0
    if empty.any():
        ring, polygon_offsets = take(rings.polygon_offsets, np.flatnonzero(~empty))
        rings = Rings(coords, offsets_of(np.diff(offsets)[ring]), polygon_offsets)
        owner = owner[~empty]
    return rings, owner, extra


_COUNT = struct.Struct("<I")


def _straight(geometry):
    """A geometry with segments for curves, and the `_facts` of its type."""
    facts = _facts(geometry.wkbType())
    if not facts[3]:
        return geometry, facts
    geometry = QgsGeometry(geometry.constGet().segmentize())
    return geometry, _facts(geometry.wkbType())


def _find_rings(data, multi, size, runs):
    """Add where each ring of a polygon is in its WKB to the runs; how many rings each polygon has.

    A run is (WKB, number of points, ordinates of each, first byte).
    """
    (count,), place = _COUNT.unpack_from(data, 5), 9
    counts = []
    for _ in range(count if multi else 1):
        if multi:
            (rings,), place = _COUNT.unpack_from(data, place + 5), place + 9
        else:
            rings = count
        counts.append(rings)
        for _ in range(rings):
            (points,) = _COUNT.unpack_from(data, place)
            runs.append((data, points, size, place + 4))
            place += 4 + 8 * points * size
    return counts


def _coordinates(runs):
    """The points of all runs, with as many ordinates as the widest has, and where each run begins."""
    most = max((size for _, _, size, _ in runs), default=2)
    frombuffer = np.frombuffer
    pieces = [frombuffer(data, "<f8", points * size, place) for data, points, size, place in runs]
    offsets = offsets_of(np.array([points for _, points, _, _ in runs], dtype=np.int64))
    if all(size == most for _, _, size, _ in runs):
        coords = np.concatenate(pieces) if pieces else np.empty(0)
        return coords.reshape(-1, most), offsets
    coords = np.zeros((offsets[-1], most))
    for piece, (_, count, size, _), at in zip(pieces, runs, offsets.tolist()):
        coords[at : at + count, :size] = piece.reshape(-1, size)
    return coords, offsets


def _without_closing(coords, offsets):
    """Rings without closing vertices; one with another Z or M is a vertex of its own."""
    points = np.diff(offsets)
    first, last = offsets[:-1], offsets[1:] - 1
    long = np.flatnonzero(points > 1)
    bits = coords.view(np.int64)
    closed = long[(bits[first[long]] == bits[last[long]]).all(axis=1)]
    kept = np.ones(len(coords), dtype=bool)
    kept[last[closed]] = False
    points[closed] -= 1
    return coords.take(np.flatnonzero(kept), axis=0), offsets_of(
        points
    )  # three times as fast as coords[kept]


@lru_cache(maxsize=None)  # asked for every feature, and QGIS takes its time for each of its answers
def _facts(wkb_type):
    """The `dimensions` of a type, whether it is of polygons, whether of several, and whether of curves."""
    single = QgsWkbTypes.flatType(QgsWkbTypes.singleType(wkb_type))
    return (
        dimensions(wkb_type),
        single == QgsWkbTypes.Type.Polygon,
        QgsWkbTypes.isMultiType(wkb_type),
        QgsWkbTypes.isCurvedType(wkb_type),
    )


def dimensions(wkb_type: QgsWkbTypes.Type) -> int:
    """Return what ISO WKB adds to a type number for Z and M: 0, 1000, 2000 or 3000."""
    return 1000 * QgsWkbTypes.hasZ(wkb_type) + 2000 * QgsWkbTypes.hasM(wkb_type)


def common_type(wkb_types: Collection[QgsWkbTypes.Type]) -> QgsWkbTypes.Type:
    """Return the linear polygon type that geometries of several types fit in."""
    kind = QgsWkbTypes.Type.Polygon
    if any(QgsWkbTypes.isMultiType(one) or _flat(one) in _SURFACES for one in wkb_types):
        kind = QgsWkbTypes.Type.MultiPolygon
    if any(map(QgsWkbTypes.hasZ, wkb_types)):
        kind = QgsWkbTypes.addZ(kind)
    return QgsWkbTypes.addM(kind) if any(map(QgsWkbTypes.hasM, wkb_types)) else kind


def is_patched(wkb_type: QgsWkbTypes.Type) -> bool:
    """Whether a geometry is a triangle, a polyhedral surface or a TIN: polygons by another name."""
    return _flat(wkb_type) in (_TRIANGLE, *_SURFACES)


def patches(geometry: QgsGeometry) -> QgsGeometry:
    """Return a geometry that `is_patched` as a polygon or a multipolygon: the same but for its name."""
    kind = geometry.wkbType()
    data = bytearray(geometry.constGet().asWkb())
    count, place = 1, 0
    if _flat(kind) in _SURFACES:
        (count,), place = _COUNT.unpack_from(data, 5), 9
        _COUNT.pack_into(data, 1, 6 + dimensions(kind))
    for _ in range(count):
        _COUNT.pack_into(data, place + 1, 3 + dimensions(kind))
        (rings,), place = _COUNT.unpack_from(data, place + 5), place + 9
        for _ in range(rings):
            (points,) = _COUNT.unpack_from(data, place)
            place += 4 + 8 * points * wkb.width(dimensions(kind))
    return _geometry(bytes(data))


_TRIANGLE, _SURFACES = 17, (15, 16)  # of which QGIS 3.22 has no names


def _flat(wkb_type):
    return int(QgsWkbTypes.flatType(wkb_type))


def line_type(wkb_type: QgsWkbTypes.Type) -> QgsWkbTypes.Type:
    """Return the type of the lines between vertices of a layer: with its Z and M."""
    kind = QgsWkbTypes.Type.LineString
    if QgsWkbTypes.hasZ(wkb_type):
        kind = QgsWkbTypes.addZ(kind)
    return QgsWkbTypes.addM(kind) if QgsWkbTypes.hasM(wkb_type) else kind


def geometries(data: Iterable[bytes]) -> Iterator[QgsGeometry]:
    """Return the geometries of WKB, such as ``core.wkb.polygons`` and ``core.wkb.lines`` make."""
    return map(_geometry, data)


class Runs:
    """The coordinates of a geometry of any type, to be moved; see ``core.wkb.Runs``.

    Parameters
    ----------
    geometry : QgsGeometry
        Curves become segments.
    """

    def __init__(self, geometry: QgsGeometry) -> None:
        self._runs = wkb.Runs(b"" if geometry.isEmpty() else _straight(geometry)[0].asWkb().data())
        self.counts, self.polygons = self._runs.counts, self._runs.polygons

    @property
    def xy(self) -> np.ndarray:
        """(k, 2) float: the points of all runs."""
        return self._runs.xy

    def moved(self, xy: np.ndarray, splits: Sequence = ()) -> QgsGeometry:
        """The geometry with its points elsewhere, and points put in after some."""
        return _geometry(self._runs.moved(xy, splits))


def straight_lines(geometry: QgsGeometry) -> list[np.ndarray | None]:
    """Return the ends of the lines of a geometry.

    Returns
    -------
    list of (2, 2) float or None
        For each line its two ends; None for a line with bends.
    """
    lines = []
    for part in geometry.constParts() if not geometry.isNull() else ():
        straight = part.numPoints() == 2
        ends = (part.startPoint(), part.endPoint())
        lines.append(np.array([(p.x(), p.y()) for p in ends]) if straight else None)
    return lines


def _geometry(data):
    geometry = QgsGeometry()
    geometry.fromWkb(data)
    return geometry
