"""A layer of areas: what the two aggregation tools share."""

import numpy as np
from qgis.core import (
    NULL,
    QgsGeometry,
    QgsUnitTypes,
    QgsWkbTypes,
)

from ...core.aggregation import tables
from ...core.aggregation.areas import arrange
from ...core.rings import offsets_of
from ..layers import wkb
from ..partition.solving import degrees_of, measure_of


def with_dimensions(geometry, wkb_type):
    """Return a geometry with the Z and M of a layer; what it lacks becomes 0."""
    own = geometry.wkbType()
    if own == wkb_type or geometry.isNull():
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
    if degrees_of(crs) or not crs.isValid() or crs.mapUnits() == unknown:
        return 1.0
    return QgsUnitTypes.fromUnitToUnitFactor(crs.mapUnits(), QgsUnitTypes.DistanceUnit.DistanceMeters)


def read(reader, crs):
    """Read the features of a layer.

    Parameters
    ----------
    reader : layers.source.Reader
    crs : QgsCoordinateReferenceSystem

    Returns
    -------
    core.aggregation.areas.Areas
    """
    kept = list(reader)
    rings, owner, _ = wkb.read_polygons(
        with_dimensions(feature.geometry(), reader.wkb_type) for feature in kept
    )
    return arrange(kept, rings, owner, measure_of(crs), metres_of(crs))


def joined_geometry(areas, polygons, extra, multi):
    """Return the geometry of joined polygons (see ``coverage.joined``)."""
    made = list(
        wkb.polygon_geometries(
            areas.coverage.coords,
            np.concatenate([ring for rings in polygons for ring in rings]),
            offsets_of([len(ring) for rings in polygons for ring in rings]),
            offsets_of([len(rings) for rings in polygons]),
            [extra] * len(polygons),
            False,
        )
    )
    if len(made) == 1:
        return _multi(made[0]) if multi else made[0]
    return QgsGeometry.collectGeometry(made)


def _multi(geometry):
    geometry.convertToMultiType()
    return geometry


def union(geometries):
    """Return the union of geometries that do not fit together, repaired where they are not valid."""
    valid = [one if one.isGeosValid() else one.makeValid() for one in geometries]
    # a repaired outline may have come apart in lines, too
    valid = [
        part
        for one in valid
        if not one.isNull()
        for part in one.asGeometryCollection()
        if part.constGet().dimension() == 2
    ]
    whole = QgsGeometry.unaryUnion(valid)
    return whole if not whole.isEmpty() else QgsGeometry.collectGeometry(geometries)


def text(value):
    """Return a class as text; None where there is none."""
    return tables.text(None if value == NULL else value)


def texts(features, index):
    """Return the `text` of one field of each feature."""
    known, found = {}, []
    for feature in features:
        value = feature.attribute(index)
        key = type(value), str(value)  # 1, 1.0 and True are equal, too
        if key not in known:
            known[key] = text(value)
        found.append(known[key])
    return found
