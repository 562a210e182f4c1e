"""The only place where QgsGeometry becomes arrays, and arrays become QgsGeometry.

Through WKB: coordinates, Z and M included, come and go bit for bit.
"""

import struct
from functools import cache, lru_cache

from qgis.core import Qgis, QgsField, QgsGeometry, QgsWkbTypes
from qgis.PyQt.QtCore import QMetaType, QVariant

INTEGER, LONG, REAL, TEXT = "Int", "LongLong", "Double", "QString"


def field(name, kind):
    """Return a new field; kind is INTEGER, LONG, REAL or TEXT."""
    if Qgis.QGIS_VERSION_INT >= 33800:
        return QgsField(name, getattr(QMetaType.Type, kind))
    return QgsField(name, getattr(QVariant, "String" if kind == TEXT else kind))


def read_polygons(geometries):
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
    import numpy as np

    from ...core.rings import Rings, offsets_of, take

    owner, extra, runs, ring_counts = [], [], [], []
    for number, geometry in enumerate(geometries):
        abstract = None if geometry.isNull() or geometry.isEmpty() else geometry.constGet()
        if abstract is not None and QgsWkbTypes.isCurvedType(abstract.wkbType()):
            abstract = abstract.segmentize()
        kind = QgsWkbTypes.Type.Unknown if abstract is None else abstract.wkbType()
        extra.append(dimensions(kind))
        if QgsWkbTypes.flatType(QgsWkbTypes.singleType(kind)) != QgsWkbTypes.Type.Polygon:
            continue
        data = bytes(abstract.asWkb())
        size = _width(extra[-1])
        (count,), place = _COUNT.unpack_from(data, 5), 9
        for _ in range(count if QgsWkbTypes.isMultiType(kind) else 1):
            if QgsWkbTypes.isMultiType(kind):
                (rings,), place = _COUNT.unpack_from(data, place + 5), place + 9
            else:
                rings = count
            owner.append(number)
            ring_counts.append(rings)
            for _ in range(rings):
                (points,) = _COUNT.unpack_from(data, place)
                runs.append((data, points, size, place + 4))
                place += 4 + 8 * points * size
    width = max((size for _, _, size, _ in runs), default=2)
    frombuffer = np.frombuffer
    pieces = [frombuffer(data, "<f8", points * size, place) for data, points, size, place in runs]
    points = np.array([points for _, points, _, _ in runs], dtype=np.int64)
    if all(size == width for _, _, size, _ in runs):
        coords = np.concatenate(pieces) if pieces else np.empty(0)
        coords = coords.reshape(-1, width)
    else:
        coords = np.zeros((points.sum(), width))
        for piece, (_, count, size, _), at in zip(pieces, runs, offsets_of(points).tolist()):
            coords[at:at + count, :size] = piece.reshape(-1, size)

    # drop the closing vertices; one with another Z or M is a vertex of its own
    offsets = offsets_of(points)
    long = np.flatnonzero(points > 1)
    bits = coords.view(np.int64)
    closed = (bits[offsets[:-1][long]] == bits[offsets[1:][long] - 1]).all(axis=1)
    kept = np.ones(len(coords), dtype=bool)
    kept[offsets[1:][long][closed] - 1] = False
    points[long[closed]] -= 1
    rings = Rings(coords[kept], offsets_of(points), offsets_of(ring_counts))
    owner = np.array(owner, dtype=np.int64)
    empty = np.diff(rings.offsets[rings.polygon_offsets]) == 0
    if empty.any():
        ring, polygon_offsets = take(rings.polygon_offsets, np.flatnonzero(~empty))
        rings = Rings(rings.coords, offsets_of(points[ring]), polygon_offsets)
        owner = owner[~empty]
    return rings, owner, extra


_COUNT = struct.Struct("<I")


def polygons(geometry):
    """Return the polygons of one geometry as (coords, offsets) arrays; see `read_polygons`."""
    rings, _, _ = read_polygons([geometry])
    bounds = rings.polygon_offsets.tolist()
    result = []
    for lo, hi in zip(bounds[:-1], bounds[1:]):
        offsets = rings.offsets[lo:hi + 1]
        result.append((rings.coords[offsets[0]:offsets[-1]], offsets - offsets[0]))
    return result


def dimensions(wkb_type):
    """Return what ISO WKB adds to a type number for Z and M: 0, 1000, 2000 or 3000."""
    return 1000 * QgsWkbTypes.hasZ(wkb_type) + 2000 * QgsWkbTypes.hasM(wkb_type)


def common_type(wkb_types):
    """Return the linear polygon type that geometries of several types fit in."""
    kind = QgsWkbTypes.Type.Polygon
    if any(map(QgsWkbTypes.isMultiType, wkb_types)):
        kind = QgsWkbTypes.Type.MultiPolygon
    if any(map(QgsWkbTypes.hasZ, wkb_types)):
        kind = QgsWkbTypes.addZ(kind)
    return QgsWkbTypes.addM(kind) if any(map(QgsWkbTypes.hasM, wkb_types)) else kind


def line_type(wkb_type):
    """Return the type of the lines between vertices of a layer: with its Z and M."""
    kind = QgsWkbTypes.Type.LineString
    if QgsWkbTypes.hasZ(wkb_type):
        kind = QgsWkbTypes.addZ(kind)
    return QgsWkbTypes.addM(kind) if QgsWkbTypes.hasM(wkb_type) else kind


def polygon_geometry(coords, rings, extra, multi):
    """Return a polygon of rings of rows.

    Parameters
    ----------
    coords : (k, d) float
    rings : list of (m,) int
        Rows of each ring, the shell first, none repeated at the end.
    extra : int
        The `dimensions` of the coordinates.
    multi : bool
        Whether to wrap the polygon as a multipolygon.
    """
    import numpy as np

    chunks = [_header(3 + extra, len(rings))]
    for ring in rings:
        closed = np.append(ring, ring[:1])  # an empty ring stays empty
        chunks += [struct.pack("<I", len(closed)), coords[closed].tobytes()]
    if multi:
        chunks.insert(0, _header(6 + extra, 1))
    return _geometry(chunks)


def polygon_geometries(coords, rows, offsets, ring_offsets, extra, multi):
    """Yield polygons of rings of rows.

    Parameters
    ----------
    coords : (k, d) float
    rows : (m,) int
        Rows of all rings, none repeated at its end.
    offsets, ring_offsets : (r + 1,) int, (p + 1,) int
        Where each ring starts in ``rows``, and where the rings of each polygon start.
    extra : (p,) int
        The `dimensions` of each polygon.
    multi : bool
        Whether to wrap the polygons as multipolygons.
    """
    import numpy as np

    from ...core.rings import offsets_of, ranges

    size = np.diff(offsets)
    closed = size + (size > 0)  # an empty ring stays empty
    along = ranges(np.zeros(len(size), dtype=np.int64), closed)
    along -= np.repeat(np.where(size > 0, size, 1), closed) * (along == np.repeat(size, closed))
    data = coords[rows[np.repeat(offsets[:-1], closed) + along]]
    width = coords.shape[1]
    place = (8 * width * offsets_of(closed)).tolist()
    counts = closed.astype("<u4").tobytes()
    raw = data.tobytes()
    bounds = ring_offsets.tolist()
    for lo, hi, more in zip(bounds[:-1], bounds[1:], extra):
        chunks = [_header(6 + more, 1)] if multi else []
        chunks.append(_header(3 + more, hi - lo))
        narrower = _width(more) != width
        for ring in range(lo, hi):
            part = raw[place[ring]:place[ring + 1]]
            if narrower:
                part = np.frombuffer(part).reshape(-1, width)[:, :_width(more)].tobytes()
            chunks += (counts[4 * ring:4 * ring + 4], part)
        yield _geometry(chunks)


def line_geometries(coords, rows, extra):
    """Yield straight lines between rows.

    Parameters
    ----------
    coords : (k, d) float
    rows : (l, 2) int
    extra : (l,) int
        The `dimensions` of each line.
    """
    import numpy as np

    width = coords.shape[1]
    raw, step = coords[rows].tobytes(), 16 * coords.shape[1]
    for k, more in enumerate(extra):
        part, own = raw[k * step:(k + 1) * step], _width(more)
        if own != width:
            part = np.frombuffer(part).reshape(2, width)[:, :own].tobytes()
        yield _geometry([_header(2 + more, 2), part])


@cache
def _width(extra):
    """Ordinates of a vertex, by the `dimensions` of its geometry."""
    return 2 + (extra in (1000, 3000)) + (extra in (2000, 3000))


def line_geometry(coords, rows, extra):
    """Return the straight line between rows; ``extra`` as in `polygon_geometry`."""
    return _geometry([_header(2 + extra, len(rows)), coords[rows].tobytes()])


class Runs:
    """The coordinates of a geometry of any type, to be moved in place: Z, M and the rest stay.

    Parameters
    ----------
    geometry : QgsGeometry
        Curves become segments.

    Attributes
    ----------
    counts : list of int
        The number of points of each run: a line, a ring with its closing point, or a point.
    polygons : list of list of int
        The runs that are rings of each polygon, its shell first.
    """

    def __init__(self, geometry):
        self.counts, self.polygons = [], []
        self._places, self._data = [], bytearray()
        if geometry.isNull() or geometry.isEmpty():
            return
        abstract = geometry.constGet()
        if QgsWkbTypes.isCurvedType(abstract.wkbType()):
            abstract = abstract.segmentize()
        self._data = bytearray(bytes(abstract.asWkb()))
        self._read(0)

    @property
    def xy(self):
        """(k, 2) float: the points of all runs."""
        import numpy as np

        views = [self._view(k)[:, :2] for k in range(len(self.counts))]
        return np.concatenate(views) if views else np.empty((0, 2))

    def moved(self, xy):
        """The geometry with its points elsewhere."""
        start = 0
        for k, count in enumerate(self.counts):
            self._view(k)[:, :2] = xy[start:start + count]
            start += count
        return _geometry([bytes(self._data)])

    def _view(self, k):
        import numpy as np

        place, size = self._places[k]
        count = self.counts[k]
        return np.frombuffer(self._data, "<f8", count * size, place).reshape(count, size)

    def _read(self, place):
        """Find the runs of the WKB geometry that starts here; return where it ends."""
        (code,) = struct.unpack_from("<I", self._data, place + 1)
        kind = code % 1000
        if code >= 2**29:  # the old way to tell of Z
            kind = code & 0xFF
        size = 2 + (code // 1000 % 4 in (1, 3)) + (code // 1000 % 4 in (2, 3))
        if code >= 2**29:
            size = 2 + bool(code & 2**31) + bool(code & 2**30)
        place += 5
        if kind == 1:
            return self._run(place, 1, size)
        (count,) = struct.unpack_from("<I", self._data, place)
        place += 4
        if kind == 2:
            return self._run(place, count, size)
        if kind in (3, 17):  # a triangle is a polygon
            rings = []
            for _ in range(count):
                (points,) = struct.unpack_from("<I", self._data, place)
                rings.append(len(self.counts))
                place = self._run(place + 4, points, size)
            if rings:
                self.polygons.append(rings)
            return place
        for _ in range(count):
            place = self._read(place)
        return place

    def _run(self, place, count, size):
        self.counts.append(count)
        self._places.append((place, size))
        return place + 8 * count * size


def straight_lines(geometry):
    """Return the ends of the lines of a geometry.

    Returns
    -------
    list of (2, 2) float or None
        For each line its two ends; None for a line with bends.
    """
    import numpy as np

    lines = []
    for part in geometry.constParts() if not geometry.isNull() else ():
        straight = part.numPoints() == 2
        ends = (part.startPoint(), part.endPoint())
        lines.append(np.array([(p.x(), p.y()) for p in ends]) if straight else None)
    return lines


@lru_cache(1000)  # most polygons have few rings
def _header(kind, count):
    return struct.pack("<BII", 1, kind, count)


def _geometry(chunks):
    geometry = QgsGeometry()
    geometry.fromWkb(b"".join(chunks))
    return geometry
