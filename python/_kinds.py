"""What comes in (a geometry, an array, a GeoSeries, a GeoDataFrame), and the same kind to go out.

Geopandas is never imported: where there is one of its objects, its own classes make the results.
"""

from __future__ import annotations

import math
import sys
import warnings
from numbers import Real
from typing import Any, NamedTuple, Sequence

import numpy as np
import shapely

from .core.metric import Metric, ellipsoidal, planar

# What needs no pyproj: longitude and latitude on WGS 84
WGS84 = ("EPSG:4326", "OGC:CRS84", "4326")
# How many features a warning names
NAMED = 5


class Source(NamedTuple):
    """Geometries, and where they came from.

    Attributes
    ----------
    geometries : (n,) object
    origin : object
        What was given.
    kind : str
        'geometry', 'array', 'series' or 'frame'.
    crs : object
        A pyproj.CRS or None.
    """

    geometries: np.ndarray
    origin: Any
    kind: str
    crs: Any

    @property
    def ids(self) -> np.ndarray:
        """(n,): what names each feature: its index label, or its place."""
        if self.kind in ("series", "frame"):
            return self.origin.index.to_numpy()
        return np.arange(len(self.geometries))


def source(data: Any, crs: Any = None, *, what: str = "polygons") -> Source:
    """Return the geometries of whatever was given.

    Parameters
    ----------
    data : shapely geometry, sequence of these, GeoSeries or GeoDataFrame
    crs : object, optional
        Of geometries that have none by themselves, see `measure_of`.
    what : str
        The name of the argument, for messages.
    """
    if isinstance(data, shapely.Geometry):
        return Source(np.array([data], dtype=object), data, "geometry", _crs(crs))
    own = getattr(data, "crs", None)
    kind = (
        "frame"
        if hasattr(data, "columns")
        else "series"
        if hasattr(data, "index") and not isinstance(data, (list, tuple))
        else "array"
    )
    values = data
    if kind == "frame":
        if not hasattr(data, "geometry"):
            raise TypeError(f"{what} is a table without geometries: make it a geopandas.GeoDataFrame first.")
        values = data.geometry
    values = np.asarray(values, dtype=object)
    if values.ndim != 1:
        raise TypeError(f"{what} must be a geometry or a list of geometries, not {type(data).__name__}.")
    wrong = ~(shapely.is_geometry(values) | shapely.is_missing(values))
    if wrong.any():
        k = int(np.argmax(wrong))
        raise TypeError(f"{what} must be shapely geometries; number {k} is {type(values[k]).__name__}.")
    return Source(values, data, kind, _crs(crs) if own is None else own)


def _crs(crs: Any) -> Any:
    """A CRS object; None for none."""
    if crs is None or isinstance(crs, Metric) or hasattr(crs, "is_geographic"):
        return crs
    if str(crs).upper() in WGS84:
        return ellipsoidal()
    try:
        import pyproj
    except ImportError:
        raise ImportError(
            f"to know the CRS {crs} needs the package pyproj; without it only {WGS84[0]} is known"
        ) from None
    return pyproj.CRS.from_user_input(crs)


def measure_of(crs: Any) -> Metric:
    """Return how to measure: in the plane, or in metres on the ellipsoid where coordinates are angles."""
    if isinstance(crs, Metric):
        return crs
    if crs is None or not crs.is_geographic:
        return planar()
    ellipsoid, axes = crs.ellipsoid, crs.axis_info
    degrees = round(math.degrees(axes[0].unit_conversion_factor), 9) if axes else 1.0  # of grads 0.9
    if ellipsoid is None:
        return ellipsoidal(degrees=degrees)
    return ellipsoidal(a=ellipsoid.semi_major_metre, b=ellipsoid.semi_minor_metre, degrees=degrees)


def metres_of(crs: Any) -> float:
    """Return the metres in one unit of `measure_of` a CRS; 1 where the unit is not known."""
    if crs is None or isinstance(crs, Metric) or crs.is_geographic or not crs.axis_info:
        return 1.0
    return float(crs.axis_info[0].unit_conversion_factor)


def result(
    origin: Source,
    geometries: np.ndarray,
    feature: np.ndarray,
    fields: dict[str, np.ndarray],
    *,
    with_own: bool = True,
) -> Any:
    """Return geometries as the kind that was given.

    Parameters
    ----------
    origin : Source
    geometries : (m,) object
    feature : (m,) int
        The feature of each, as a place in the source.
    fields : dict of (m,) arrays
    with_own : bool
        Whether a table has the columns of the features, too. A field whose name is taken gets a number, as
        in QGIS.

    Returns
    -------
    GeometryCollection, array, GeoSeries or GeoDataFrame
        With the index labels of the features; the last one with the fields.
    """
    if origin.kind == "geometry":
        return shapely.geometrycollections(list(geometries))
    if origin.kind == "array":
        return geometries
    given = origin.origin
    if origin.kind == "series":
        return type(given)(geometries, index=given.index.take(feature), crs=given.crs, name=given.name)
    name = given.geometry.name
    if with_own:
        table = given.iloc[feature].copy()
        table[name] = type(given.geometry)(geometries, index=table.index, crs=given.crs)
        taken = {str(column).lower() for column in table.columns}
        for field, values in fields.items():
            own, number = field, 2
            while own.lower() in taken:
                own, number = f"{field}_{number}", number + 1
            taken.add(own.lower())
            table[own] = _texts(values, table.index)
        return table
    index = given.index.take(feature)
    columns = {field: _texts(values, index) for field, values in fields.items()}
    return type(given)({**columns, "geometry": geometries}, index=index, crs=given.crs)


def _texts(values: np.ndarray, index: Any) -> Any:
    """A column; of text where all values are text, so that an empty table has the types of others."""
    if values.dtype != object or not all(isinstance(value, str) for value in values):
        return values
    import pandas

    return pandas.Series(values, index=index, dtype="str")


def table(origin: Source, feature: np.ndarray, fields: dict[str, np.ndarray]) -> Any:
    """Return a table without geometries: a pandas.DataFrame where pandas came in, else a dict of arrays."""
    if origin.kind not in ("series", "frame"):
        return fields
    import pandas

    return pandas.DataFrame(fields, index=origin.origin.index.take(feature))


def numbers(origin: Source, value: Any, name: str) -> np.ndarray:
    """Return a number for each feature: of one number, a sequence, or a column of the table.

    Parameters
    ----------
    value : float, str or sequence of float
    name : str
        Of the option, for messages.

    Returns
    -------
    (n,) float
    """
    count = len(origin.geometries)
    if isinstance(value, str):
        if origin.kind != "frame":
            raise TypeError(f"{name} names the column {value!r}, but there is no table.")
        value = column(origin, value, name)
    values = np.asarray(value, dtype=float)
    if values.ndim == 0:
        return np.full(count, float(values))
    if values.shape != (count,):
        raise ValueError(f"{name} must have a number for each of the {count} features.")
    return values


def column(origin: Source, value: Any, name: str) -> np.ndarray:
    """Return a value for each feature: of a column of the table, or a sequence."""
    if isinstance(value, str):
        if origin.kind != "frame" or value not in origin.origin.columns:
            known = ", ".join(map(str, origin.origin.columns)) if origin.kind == "frame" else "none"
            raise ValueError(f"{name} is {value!r}, which is no column. The columns are: {known}.")
        value = origin.origin[value]
    values = np.asarray(value, dtype=object)
    if values.shape != (len(origin.geometries),):
        raise ValueError(f"{name} must have a value for each of the {len(origin.geometries)} features.")
    return values


def least(value: Any, name: str, smallest: float, largest: float = np.inf) -> None:
    """Complain of a single number that is no number from ``smallest`` to ``largest``."""
    if isinstance(value, Real) and not (smallest <= float(value) <= largest and float(value) < np.inf):
        most = f" and at most {largest:g}" if largest < np.inf else ""
        raise ValueError(f"{name} must be a number of at least {smallest:g}{most}, and is {float(value):g}.")


def number(value: Any, name: str, smallest: float) -> None:
    """Complain of what is no single number from ``smallest`` on."""
    if np.ndim(value) or np.asarray(value).dtype.kind not in "biuf":
        raise TypeError(f"{name} must be a number, and is {value!r}.")
    least(float(value), name, smallest)


def whole(value: Any, name: str, smallest: int) -> int:
    """Return a whole number from ``smallest`` on; complain of anything else."""
    number(value, name, smallest)
    if value != int(value):
        raise ValueError(f"{name} must be a whole number, and is {float(value)}.")
    return int(value)


def one_of(value: str, name: str, known: Sequence[str]) -> None:
    """Complain of a word that is none of those known."""
    if value not in known:
        raise ValueError(f"{name} must be {', '.join(known[:-1])} or {known[-1]}, and is {value!r}.")


def tell(origin: Source, reasons: dict[int, str], what: str) -> None:
    """Warn, once, of features for which something is to be told."""
    if not reasons:
        return
    ids = origin.ids
    some = "; ".join(f"{ids[f]}: {reasons[f]}" for f in list(reasons)[:NAMED])
    more = " ..." if len(reasons) > NAMED else ""
    warn(f"{len(reasons)} of {len(ids)} features {what}: {some}{more}.")


def warn(message: str) -> None:
    """Warn at the line of the user's own code."""
    level, frame = 1, sys._getframe()
    while frame.f_back is not None and frame.f_globals.get("__package__") == __package__:
        level, frame = level + 1, frame.f_back
    warnings.warn(message, stacklevel=level)
