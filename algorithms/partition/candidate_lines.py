"""A user's own lines as candidate diagonals."""

from qgis.core import QgsCoordinateTransform, QgsFeatureRequest

from ..layers import wkb


class CandidateLines:
    """The lines of a layer, and what became of them over all polygons.

    Line k is ``ends[k]``, of the feature ``ids[k]`` with ``attributes[k]``.

    Parameters
    ----------
    source : QgsProcessingFeatureSource
    crs : QgsCoordinateReferenceSystem
        That of the polygons.
    context : QgsProcessingContext
    """

    def __init__(self, source, crs, context):
        import numpy as np

        from ...core.partition.candidates import OFF_VERTICES

        self.fields, self.attributes = source.fields(), []
        transform = QgsCoordinateTransform(source.sourceCrs(), crs, context.transformContext())
        self.ids, ends, self.bent = [], [], []
        for feature in source.getFeatures(QgsFeatureRequest()):
            geometry = feature.geometry()
            if not geometry.isNull() and transform.isValid() and not transform.isShortCircuited():
                geometry.transform(transform)
            lines = wkb.straight_lines(geometry)
            straight = [line for line in lines if line is not None]
            if len(straight) < len(lines) or not lines:
                self.bent.append(feature.id())
            self.ids += [feature.id()] * len(straight)
            self.attributes += [feature.attributes()] * len(straight)
            ends += straight
        self.ends = np.array(ends).reshape(-1, 2, 2)
        self.verdict = np.full(len(self.ids), OFF_VERTICES)
        self.used = np.zeros(len(self.ids), dtype=bool)
        self.other = {}

    def near(self, coords):
        """Return the lines whose bounding box meets that of a polygon's vertices."""
        import numpy as np

        margin = 1e-9 * np.abs(coords[:, :2]).max()
        low, high = coords[:, :2].min(axis=0) - margin, coords[:, :2].max(axis=0) + margin
        meets = (self.ends.max(axis=1) >= low) & (self.ends.min(axis=1) <= high)
        return np.flatnonzero(meets.all(axis=1))

    def note(self, which, lines):
        """Remember what a polygon said of its lines; the best verdict counts."""
        from ...core.partition.candidates import ACCEPTED

        self.used[which[lines.verdict == ACCEPTED]] = True
        for k, verdict, other in zip(which.tolist(), lines.verdict.tolist(), lines.other.tolist()):
            if verdict > self.verdict[k]:
                self.verdict[k] = verdict
                if other >= 0:
                    self.other[k] = self.ids[which[other]]

    def report(self, feedback):
        """Tell which lines are no diagonals, and why."""
        from ...core.partition.candidates import CROSSES, LEAVES, OFF_VERTICES, REPEATED, TOUCHES

        reasons = {
            OFF_VERTICES: "an end is not a vertex of a polygon",
            LEAVES: "it leaves its polygon",
            TOUCHES: "it touches the boundary between its ends",
            REPEATED: "it repeats line {}",
            CROSSES: "it crosses the shorter line {}",
        }
        problems = [(k, "it is not one straight line between two points") for k in self.bent]
        problems += [
            (self.ids[k], reasons[self.verdict[k]].format(self.other.get(k)))
            for k in range(len(self.ids))
            if not self.used[k]
        ]
        for line, reason in sorted(problems):
            feedback.pushWarning(f"Candidate line {line} was left out: {reason}.")
