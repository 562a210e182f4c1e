"""A layer of areas as arrays: what the two aggregation tools share."""

from typing import NamedTuple

from qgis.core import (
    NULL,
    QgsGeometry,
    QgsUnitTypes,
    QgsWkbTypes,
)

from ..layers import wkb
from ..partition.solving import measure_of

EARTH_RADIUS = 6371008.8  # metres; for distances between centroids in layers in degrees
FARTHEST = 1e75  # coordinate; the squares and products of larger ones are no numbers


class Areas(NamedTuple):
    """Areas of a layer, in its order.

    Attributes
    ----------
    features : list of QgsFeature
    coverage : core.aggregation.coverage.Coverage
    owner : (q,) int
        The area of each polygon; an area has several if it is multipart, none if it is empty.
    measured : (q,) bool
        Whether a polygon is in the coverage: all of its coordinates are numbers, and none is huge.
    size : (n,) float
        In square metres.
    place : (n,) complex
        Centroids, in metres.
    spread : (n,) float
        Mean squared distance of the points of an area from its centroid, in square metres.
    metre : float
        Metres in one unit of the measure.
    measure : core.metric.Metric
    """

    features: list
    coverage: object
    owner: object
    measured: object
    size: object
    place: object
    spread: object
    metre: float
    measure: object


def with_dimensions(geometry, wkb_type):
    """Return a geometry with the Z and M of a layer; what it lacks becomes 0."""
    own = geometry.wkbType()
    if geometry.isNull():
        return geometry
    if QgsWkbTypes.hasZ(own) == QgsWkbTypes.hasZ(wkb_type) and (
        QgsWkbTypes.hasM(own) == QgsWkbTypes.hasM(wkb_type)
    ):
        return geometry
    geometry = QgsGeometry(geometry)
    if QgsWkbTypes.hasZ(wkb_type):
        geometry.get().addZValue(0.0)
    if QgsWkbTypes.hasM(wkb_type):
        geometry.get().addMValue(0.0)
    return geometry


def metres_of(crs):
    """Return the metres in one unit of `measure_of` a CRS; 1 where the unit is not known."""
    unknown = QgsUnitTypes.DistanceUnit.DistanceUnknownUnit
    if crs.isGeographic() or not crs.isValid() or crs.mapUnits() == unknown:
        return 1.0
    return QgsUnitTypes.fromUnitToUnitFactor(
        crs.mapUnits(), QgsUnitTypes.DistanceUnit.DistanceMeters
    )


def read(reader, crs):
    """Read the features of a layer.

    Parameters
    ----------
    reader : layers.source.Reader
    crs : QgsCoordinateReferenceSystem

    Returns
    -------
    Areas
    """
    kept = list(reader)
    rings, owner, _ = wkb.read_polygons(
        with_dimensions(feature.geometry(), reader.wkb_type) for feature in kept
    )
    return arrange(kept, rings, owner, crs)


def arrange(kept, rings, owner, crs):
    """Return `Areas` from features, and their rings with the area of each polygon."""
    import numpy as np

    from ...core.aggregation.coverage import centroids, cover, spreads
    from ...core.rings import groups, take

    # rings of fewer than three vertices bound nothing
    measure, metre = measure_of(crs), metres_of(crs)
    polygon_count = len(rings.polygon_offsets) - 1
    row_polygon = np.repeat(groups(rings.polygon_offsets), np.diff(rings.offsets))
    measured = np.ones(polygon_count, dtype=bool)
    measured[row_polygon[~(np.abs(rings.coords[:, :2]) <= FARTHEST).all(axis=1)]] = False
    ring_polygon = groups(rings.polygon_offsets)
    some = np.flatnonzero(measured[ring_polygon] & (np.diff(rings.offsets) > 0))
    row, offsets = take(rings.offsets, some)
    coords = rings.coords[row]
    coverage = cover(coords, offsets, ring_polygon[some])
    xy = coords[:, :2]
    area, moment = centroids(coverage, measure.equal_area(xy) if len(xy) else xy, polygon_count)
    if crs.isGeographic():  # the centroid in degrees, its metres near the middle of the layer
        flat, moment = centroids(coverage, xy, polygon_count)
        moment = moment * np.divide(area, flat, out=np.zeros(polygon_count), where=flat > 0)[:, None]
    n = len(kept)
    size = np.bincount(owner, weights=area, minlength=n)
    weight = np.where(size > 0, size, 1.0)
    x = np.bincount(owner, weights=moment[:, 0], minlength=n) / weight
    y = np.bincount(owner, weights=moment[:, 1], minlength=n) / weight
    # of an area that crosses itself, parts count as negative: its centroid might be anywhere
    ring_area = owner[coverage.ring_polygon] if len(owner) else coverage.ring_polygon
    row_area = np.repeat(ring_area, np.diff(offsets))
    low, high = np.full((n, 2), np.inf), np.full((n, 2), -np.inf)
    if len(some):  # ring by ring first: `at` is slow in older numpy
        np.minimum.at(low, ring_area, np.minimum.reduceat(xy, offsets[:-1]))
        np.maximum.at(high, ring_area, np.maximum.reduceat(xy, offsets[:-1]))
    some = np.isfinite(low[:, 0])
    x[some] = np.clip(x[some], low[some, 0], high[some, 0])
    y[some] = np.clip(y[some], low[some, 1], high[some, 1])
    around = xy - np.column_stack((x, y))[row_area]
    if crs.isGeographic() and n:
        around = EARTH_RADIUS * np.radians(around)
        around[:, 0] *= np.cos(np.radians(xy[:, 1]))
        middle = np.median(x)
        x = EARTH_RADIUS * np.cos(np.radians(y)) * np.radians(x - middle)
        y = EARTH_RADIUS * np.radians(y)
    spread = np.zeros(n)
    spread[:owner.max(initial=-1) + 1] = spreads(coverage, around, owner)
    return Areas(kept, coverage, owner, measured, np.maximum(size, 0.0) * metre**2,
                 (x + 1j * y) * metre, spread * metre**2, metre, measure)


def neighbours(areas):
    """Return pairs of areas that share a boundary, and its length in metres, each pair once."""
    import numpy as np

    from ...core.aggregation.coverage import shared

    pairs, length = shared(areas.coverage, areas.measure)
    pairs = np.sort(areas.owner[pairs], axis=1).reshape(-1, 2)
    apart = pairs[:, 0] != pairs[:, 1]
    pairs, length = pairs[apart], length[apart] * areas.metre
    n = max(len(areas.features), 1)
    key, group = np.unique(pairs[:, 0] * n + pairs[:, 1], return_inverse=True)
    total = np.bincount(group.ravel(), weights=length, minlength=len(key))
    return np.column_stack((key // n, key % n)), total


def joined_geometry(areas, polygons, extra, multi):
    """Return the geometry of joined polygons (see ``coverage.joined``)."""
    made = [
        wkb.polygon_geometry(areas.coverage.coords, rings, extra, False) for rings in polygons
    ]
    if len(made) == 1:
        return _multi(made[0]) if multi else made[0]
    return QgsGeometry.collectGeometry(made)


def _multi(geometry):
    geometry.convertToMultiType()
    return geometry


def invalid(areas):
    """Return the numbers of the areas that are not valid."""
    import numpy as np
    import shapely

    from ...core.aggregation.coverage import shapes

    valid = shapely.is_valid(shapes(areas.coverage, len(areas.owner)))
    return np.unique(areas.owner[~valid])


def union(geometries):
    """Return the union of geometries that do not fit together, repaired where they are not valid."""
    valid = [one if one.isGeosValid() else one.makeValid() for one in geometries]
    # a repaired outline may have come apart in lines, too
    valid = [
        part for one in valid if not one.isNull() for part in one.asGeometryCollection()
        if part.constGet().dimension() == 2
    ]
    whole = QgsGeometry.unaryUnion(valid)
    return whole if not whole.isEmpty() else QgsGeometry.collectGeometry(geometries)


def text(value):
    """Return a class as text: 311, 311.0 and "311" are one class; None where there is none."""
    if value is None or value == NULL:
        return None
    if isinstance(value, float) and value.is_integer():
        value = int(value)
    return str(value).strip() or None
