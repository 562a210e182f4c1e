"""A user's own lines as candidate diagonals."""

from __future__ import annotations

import numpy as np
from qgis.core import (
    QgsCoordinateReferenceSystem,
    QgsCoordinateTransform,
    QgsFeatureRequest,
    QgsProcessingContext,
    QgsProcessingFeatureSource,
    QgsProcessingFeedback,
)

from ...core.errors import Sentence
from ...core.partition.features import GivenLines
from ..layers import wkb
from ..layers.source import WITHOUT_VALIDITY_CHECK
from ..words import spoken, tr


class CandidateLines:
    """The lines of a layer.

    Line k of ``given`` is of the feature ``ids[k]`` with ``attributes[k]``.

    Parameters
    ----------
    source : QgsProcessingFeatureSource
    crs : QgsCoordinateReferenceSystem
        That of the polygons.
    context : QgsProcessingContext
    """

    def __init__(
        self,
        source: QgsProcessingFeatureSource,
        crs: QgsCoordinateReferenceSystem,
        context: QgsProcessingContext,
    ) -> None:
        self.fields, self.attributes = source.fields(), []
        transform = QgsCoordinateTransform(source.sourceCrs(), crs, context.transformContext())
        self.ids, ends, self.bent = [], [], []
        # QGIS's own check throws through Python's interpreter, which crashes some time later
        for feature in source.getFeatures(QgsFeatureRequest(), WITHOUT_VALIDITY_CHECK):
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
        self.given = GivenLines(np.array(ends), self.ids)

    def report(self, feedback: QgsProcessingFeedback) -> None:
        """Tell which lines are no diagonals, and why."""
        problems = [(k, Sentence("it is not one straight line between two points")) for k in self.bent]
        problems += self.given.left_out()
        for line, reason in sorted(problems):
            feedback.pushWarning(tr("Candidate line {} was left out: {}.").format(line, spoken(reason)))
