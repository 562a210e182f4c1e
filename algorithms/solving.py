"""From the geometry of a feature to solved polygons: what all partition tools share."""

from typing import NamedTuple

from qgis.core import QgsEllipsoidUtils

from . import features


class Solved(NamedTuple):
    """One polygon of a feature.

    Attributes
    ----------
    coords : (k, d) float
        Its vertices.
    offsets : (r + 1,) int
        Where each of its rings starts.
    partition : core.partition.Partition or None
    problem : str
        Why there is no partition, or ''.
    area : (m,) float
        Areas of its parts, the largest first.
    """

    coords: object
    offsets: object
    partition: object
    problem: str
    area: object

    def rings(self, part):
        """Rings of rows of a part; a polygon in one piece stays as it was."""
        if len(self.area) > 1:
            return self.partition.parts.rings[part]
        import numpy as np

        return [np.arange(lo, hi) for lo, hi in zip(self.offsets[:-1], self.offsets[1:])]


def measure_of(crs):
    """Return the metric of a layer: its own plane, or its ellipsoid where it is in degrees."""
    from ..core import metric

    if not crs.isGeographic():
        return metric.planar()
    ellipsoid = QgsEllipsoidUtils.ellipsoidParameters(crs.ellipsoidAcronym())
    if not ellipsoid.valid:
        return metric.ellipsoidal()
    return metric.ellipsoidal(ellipsoid.semiMajor, ellipsoid.semiMinor)


def solve(feature, solver, measure, lines, feedback, progress):
    """Partition the polygons of a feature one by one.

    Parameters
    ----------
    feature : QgsFeature
    solver : callable
        ``(coords, offsets, **arguments)`` to a Partition, such as `core.partition.partition`; gets
        the arguments lines, measure, progress and cancelled.
    measure : core.metric.Metric
        That of the layer.
    lines : CandidateLines or None
    feedback : QgsProcessingFeedback
    progress : callable
        Called with the share done of this feature.

    Returns
    -------
    list of Solved
        Empty for a geometry without polygons.

    Raises
    ------
    Cancelled
    """
    import numpy as np

    from ..core import metric
    from ..core.errors import Unsolvable

    parts = features.polygons(feature.geometry())
    if measure.conformal and any(np.nanmax(np.abs(c[:, 1])) > 90.0 + 1e-9 for c, _ in parts):
        feedback.pushWarning(
            f"Feature {feature.id()} has a latitude beyond 90 degrees. Its coordinates are taken as "
            "those of a plane. Is the CRS of the layer right?"
        )
        measure = metric.planar()
    total = sum(len(coords) for coords, _ in parts)
    done, result = 0, []
    for coords, offsets in parts:
        near = lines.near(coords) if lines else None

        def advance(share, done=done, size=len(coords)):
            progress((done + share * size) / total)

        try:
            solution = solver(
                coords,
                offsets,
                lines=None if near is None else lines.ends[near],
                measure=measure,
                progress=advance,
                cancelled=feedback.isCanceled,
            )
            if near is not None:
                lines.note(near, solution.lines)
            result.append(Solved(coords, offsets, solution, "", solution.parts.area))
        except Unsolvable as problem:
            area = [_area(coords, offsets, measure)]
            result.append(Solved(coords, offsets, None, str(problem), area))
        done += len(coords)
    return result


def _area(coords, offsets, measure):
    """Area of a polygon that could not be solved, for its place among the parts."""
    import numpy as np

    from ..core.polygon import signed_areas

    if (np.diff(offsets) == 0).any():
        return 0.0
    with np.errstate(all="ignore"):
        area = np.abs(signed_areas(measure.equal_area(coords[:, :2]), offsets))
        return float(np.nan_to_num(area[0] - area[1:].sum()))
