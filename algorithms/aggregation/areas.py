"""A layer of areas: what the two aggregation tools share."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Iterable, Sequence

import numpy as np
from qgis.core import (
    NULL,
    QgsCoordinateReferenceSystem,
    QgsDistanceArea,
    QgsFeature,
    QgsGeometry,
    QgsProcessingContext,
    QgsProcessingFeedback,
    QgsRectangle,
    QgsUnitTypes,
    QgsWkbTypes,
)

from ...core import wkb as core_wkb
from ...core.aggregation import tables
from ...core.aggregation.areas import Areas, arrange
from ...core.rings import offsets_of
from ..base import counted
from ..layers import wkb
from ..partition.solving import degrees_of, measure_of
from ..words import tr

if TYPE_CHECKING:
    from ..layers.source import Reader


ODD = 0.05  # how much larger or smaller than on the ground sizes may be before it is said


def with_dimensions(geometry: QgsGeometry, wkb_type: QgsWkbTypes.Type) -> QgsGeometry:
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


def metres_of(crs: QgsCoordinateReferenceSystem) -> float:
    """Return the metres in one unit of `measure_of` a CRS; 1 where the unit is not known."""
    unknown = QgsUnitTypes.DistanceUnit.DistanceUnknownUnit
    if degrees_of(crs) or not crs.isValid() or crs.mapUnits() == unknown:
        return 1.0
    return QgsUnitTypes.fromUnitToUnitFactor(crs.mapUnits(), QgsUnitTypes.DistanceUnit.DistanceMeters)


def tell_scale(
    feedback: QgsProcessingFeedback,
    crs: QgsCoordinateReferenceSystem,
    places: np.ndarray,
    context: QgsProcessingContext,
) -> None:
    """Warn where the plane of a layer is no place to measure areas in, as that of Web Mercator.

    Parameters
    ----------
    feedback : QgsProcessingFeedback
    crs : QgsCoordinateReferenceSystem
    places : (p, 2) float
        Points of the map.
    context : QgsProcessingContext
    """
    if not crs.isValid() or not len(places):
        return
    degrees = degrees_of(crs)
    if degrees:
        low, high = float(places[:, 1].min()), float(places[:, 1].max())
        if min(low, -high) * degrees < -90.0:
            feedback.pushWarning(
                tr(
                    "The CRS of the layer, {}, is in degrees, but the layer reaches from latitude {:.10g} to "
                    "{:.10g}: sizes and lengths will be wrong. Give it the CRS that it has (Assign "
                    "projection)."
                ).format(crs.authid(), low, high)
            )
        return
    (x, y), half = np.median(places, axis=0).tolist(), 500.0 / metres_of(crs)
    square = QgsRectangle(x - half, y - half, x + half, y + half)
    ground = QgsDistanceArea()
    ground.setSourceCrs(crs, context.transformContext())
    ground.setEllipsoid(crs.ellipsoidAcronym())
    true = ground.measureArea(QgsGeometry.fromRect(square))
    true = ground.convertAreaMeasurement(true, QgsUnitTypes.AreaUnit.AreaSquareMeters)
    ratio = square.area() * metres_of(crs) ** 2 / true if true > 0.0 else 1.0
    if not 1.0 - ODD <= ratio <= 1.0 + ODD and np.isfinite(ratio):
        feedback.pushWarning(
            tr(
                "In the CRS of the layer, {}, areas in the middle of the map are {:.2f} times as large as on "
                "the ground, and all sizes are measured in it. Use Reproject layer first, to an equal-area "
                "CRS."
            ).format(crs.authid(), ratio)
        )


def tell_overlaps(
    feedback: QgsProcessingFeedback, features: Sequence[QgsFeature], overlaps: np.ndarray, most: int = 10
) -> None:
    """Warn of pairs of areas that overlap, by their numbers."""
    if len(overlaps):
        some = ", ".join(
            tr("{} and {}").format(features[a].id(), features[b].id()) for a, b in overlaps[:most].tolist()
        )
        feedback.pushWarning(
            tr(
                "{} of areas overlap: {}{}. Nothing was changed about that; sizes count the common part "
                "twice."
            ).format(counted(len(overlaps), "pair"), some, " ..." * (len(overlaps) > most))
        )


def read(reader: Reader, crs: QgsCoordinateReferenceSystem) -> Areas:
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


def joined_geometry(areas: Areas, polygons: list[list[np.ndarray]], extra: int, multi: bool) -> QgsGeometry:
    """Return the geometry of joined polygons (see ``coverage.joined``)."""
    made = list(
        wkb.geometries(
            core_wkb.polygons(
                areas.coverage.coords,
                np.concatenate([ring for rings in polygons for ring in rings]),
                offsets_of([len(ring) for rings in polygons for ring in rings]),
                offsets_of([len(rings) for rings in polygons]),
                [extra] * len(polygons),
                False,
            )
        )
    )
    if len(made) == 1:
        return _multi(made[0]) if multi else made[0]
    return QgsGeometry.collectGeometry(made)


def _multi(geometry):
    geometry.convertToMultiType()
    return geometry


def union(geometries: list[QgsGeometry]) -> QgsGeometry:
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


def text(value: Any) -> str | None:
    """Return a class as text; None where there is none."""
    return tables.text(None if value == NULL else value)


def texts(features: Iterable[QgsFeature], index: int) -> list[str | None]:
    """Return the `text` of one field of each feature."""
    known, found = {}, []
    for feature in features:
        value = feature.attribute(index)
        kind = type(value)  # 1, 1.0 and True are equal, too
        key = kind, value if kind in (int, str) else str(value)
        if key not in known:
            known[key] = text(value)
        found.append(known[key])
    return found
