"""Features of a layer, one by one or in chunks, with progress."""

from __future__ import annotations

from typing import Iterator

from qgis.core import (
    QgsFeature,
    QgsFeatureRequest,
    QgsProcessingFeatureSource,
    QgsProcessingFeedback,
    QgsWkbTypes,
)

from ...core.errors import Sentence
from ...core.partition.features import CHUNK_FEATURES, CHUNK_VERTICES
from .wkb import common_type, is_patched, patches

# the tools check geometries themselves, and pass invalid ones through
WITHOUT_VALIDITY_CHECK = QgsProcessingFeatureSource.Flag.FlagSkipGeometryValidityChecks


class Reader:
    """Iterates over the features of a polygon source, with progress weighed by vertices.

    Parameters
    ----------
    source : QgsProcessingFeatureSource
    feedback : QgsProcessingFeedback
    keep : bool
        Whether to keep the features for the iteration: for tools that need all of them at once, and
        would read them twice.

    Attributes
    ----------
    wkb_type : QgsWkbTypes.Type
        What all geometries fit in: linear, and with Z, M or several parts where any has them,
        though the source (GeoJSON, for one) may declare less.
    """

    def __init__(
        self, source: QgsProcessingFeatureSource, feedback: QgsProcessingFeedback, keep: bool = False
    ) -> None:
        self.source, self.feedback, self.kept = source, feedback, [] if keep else None
        self.sizes, types = [], {source.wkbType()}
        request = QgsFeatureRequest()
        if not keep:
            request.setSubsetOfAttributes([])
        for feature in source.getFeatures(request, WITHOUT_VALIDITY_CHECK):
            # about its vertices; each question to QGIS takes a tenth of what reading the feature takes
            geometry = feature.geometry()
            types.add(geometry.wkbType())
            self.sizes.append(1 + geometry.wkbSize() // 16)
            if self.kept is not None:
                self.kept.append(feature)
        self.wkb_type, self.patched = common_type(types), any(map(is_patched, types))
        self.total = sum(self.sizes) or 1
        self.done, self.size = 0, 0

    def _features(self):
        features = self.kept
        if features is None:
            features = self.source.getFeatures(QgsFeatureRequest(), WITHOUT_VALIDITY_CHECK)
        return map(_in_polygons, features) if self.patched else features

    def __iter__(self):
        for feature, size in zip(self._features(), self.sizes):
            self.size = size
            if self.feedback.isCanceled():
                return
            yield feature
            self.done += self.size
            self.feedback.setProgress(100.0 * self.done / self.total)

    def chunks(self) -> Iterator[list[QgsFeature]]:
        """Yield lists of features, few or small enough to be worked on at once.

        What is yielded counts as done when the next is asked for.
        """
        chunk, self.size = [], 0
        for feature, size in zip(self._features(), self.sizes):
            if chunk and (len(chunk) >= CHUNK_FEATURES or self.size + size > CHUNK_VERTICES):
                if self.feedback.isCanceled():
                    return
                yield chunk
                self.done += self.size
                chunk, self.size = [], 0
            chunk.append(feature)
            self.size += size
        if self.feedback.isCanceled():
            return
        if chunk:
            yield chunk
        self.done += self.size
        self.feedback.setProgress(100.0 * self.done / self.total)

    def progress(self, share: float) -> None:
        """Report the share done of the current feature or chunk."""
        self.feedback.setProgress(100.0 * (self.done + share * self.size) / self.total)


def shapeless(feature: QgsFeature) -> Sentence:
    """Return why a feature has no polygon."""
    if not feature.hasGeometry():
        return Sentence("it has no geometry")
    if feature.geometry().type() != QgsWkbTypes.GeometryType.PolygonGeometry:
        return Sentence("it is no polygon")
    return Sentence("it is empty")


def _in_polygons(feature):
    """The feature, with triangles, polyhedral surfaces and TINs as polygons."""
    if feature.hasGeometry() and is_patched(feature.geometry().wkbType()):
        feature.setGeometry(patches(feature.geometry()))
    return feature
