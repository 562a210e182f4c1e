"""The only place where QgsGeometry becomes arrays, and arrays become QgsGeometry.

Through WKB: coordinates, Z and M included, come and go bit for bit.
"""

import struct

from qgis.core import Qgis, QgsField, QgsGeometry, QgsWkbTypes
from qgis.PyQt.QtCore import QMetaType, QVariant

INTEGER, LONG, REAL, TEXT = "Int", "LongLong", "Double", "QString"


def field(name, kind):
    """Return a new field; kind is INTEGER, LONG, REAL or TEXT."""
    if Qgis.QGIS_VERSION_INT >= 33800:
        return QgsField(name, getattr(QMetaType.Type, kind))
    return QgsField(name, getattr(QVariant, "String" if kind == TEXT else kind))


def polygons(geometry):
    """Return the polygons of a geometry as arrays.

    Parameters
    ----------
    geometry : QgsGeometry
        Polygon or multipolygon; curves become segments. Others have no polygons.

    Returns
    -------
    list of (coords, offsets)
        For each polygon: (k, d) float, the vertices of its rings without the closing ones; and
        (r + 1,) int, where each ring starts. Empty polygons are left out.
    """
    if geometry.isNull() or geometry.isEmpty():
        return []
    abstract = geometry.constGet()
    if QgsWkbTypes.isCurvedType(abstract.wkbType()):
        abstract = abstract.segmentize()
    if QgsWkbTypes.flatType(QgsWkbTypes.singleType(abstract.wkbType())) != QgsWkbTypes.Type.Polygon:
        return []
    data = bytes(abstract.asWkb())
    size = 2 + abstract.is3D() + abstract.isMeasure()
    count, place = _counts(data, 0)
    if not QgsWkbTypes.isMultiType(abstract.wkbType()):
        result = [_rings(data, place, count, size)[0]]
    else:
        result = []
        for _ in range(count):
            ring_count, place = _counts(data, place)
            rings, place = _rings(data, place, ring_count, size)
            result.append(rings)
    return [(coords, offsets) for coords, offsets in result if len(coords)]


def _counts(data, place):
    """Number of parts or rings after a WKB header, and where these start."""
    return struct.unpack_from("<BII", data, place)[2], place + 9


def _rings(data, place, ring_count, size):
    """Vertices of the rings of a WKB polygon and where each starts; and where the polygon ends."""
    import numpy as np

    rings = []
    for _ in range(ring_count):
        (count,) = struct.unpack_from("<I", data, place)
        ring = np.frombuffer(data, "<f8", count * size, place + 4).reshape(-1, size)
        place += 4 + 8 * count * size
        # drop the closing vertex; one with another Z or M is a vertex of its own
        closed = count > 1 and ring[0].tobytes() == ring[-1].tobytes()
        rings.append(ring[:-1] if closed else ring)
    offsets = np.cumsum([0] + [len(ring) for ring in rings])
    return (np.concatenate(rings) if rings else np.empty((0, size)), offsets), place


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


def _header(kind, count):
    return struct.pack("<BII", 1, kind, count)


def _geometry(chunks):
    geometry = QgsGeometry()
    geometry.fromWkb(b"".join(chunks))
    return geometry
