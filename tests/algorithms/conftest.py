"""A QGIS with this provider, and small layers to run tools on."""

import pytest

pytest.importorskip("qgis.core", reason="these tests need QGIS")

from qgis.core import (  # noqa: E402
    QgsFeature,
    QgsFeatureSink,
    QgsGeometry,
    QgsProcessingContext,
    QgsProcessingFeedback,
    QgsProject,
    QgsVectorLayer,
)


class Feedback(QgsProcessingFeedback):
    """Keeps what a tool says, and cancels after so many reports of progress."""

    def __init__(self, cancel_after=None):
        super().__init__(False)
        self.warnings, self.infos, self.shares = [], [], []
        if cancel_after is not None:
            self.progressChanged.connect(self._count)
        self.progressChanged.connect(self.shares.append)
        self.cancel_after = cancel_after

    def _count(self, _share):
        self.cancel_after -= 1
        if self.cancel_after <= 0:
            self.cancel()

    def pushWarning(self, text):
        self.warnings.append(text)

    def pushInfo(self, text):
        self.infos.append(text)


@pytest.fixture
def run(provider):
    """Run a tool: ``run(id, parameters)`` to its results, layers included."""
    import processing

    def run(tool, parameters, feedback=None):
        context = QgsProcessingContext()
        context.setProject(QgsProject.instance())
        results = processing.run(tool, parameters, feedback=feedback or Feedback(), context=context)
        results["context"] = context  # owns the layers
        return results

    return run


@pytest.fixture
def feedback():
    return Feedback()


@pytest.fixture
def cancelling():
    """A feedback that cancels after some reports of progress."""
    return Feedback


@pytest.fixture
def layer(qgis_app):
    """Make a memory layer: ``layer(uri, [(wkt or None, [values]), ...])``."""

    def layer(uri, rows):
        result = QgsVectorLayer(uri, "layer", "memory")
        assert result.isValid(), uri
        features = []
        for wkt, values in rows:
            feature = QgsFeature(result.fields())
            feature.setAttributes(list(values))
            if wkt is not None:
                geometry = wkt if isinstance(wkt, QgsGeometry) else QgsGeometry.fromWkt(wkt)
                feature.setGeometry(geometry)
            features.append(feature)
        ok, _ = result.dataProvider().addFeatures(features, QgsFeatureSink.Flag.FastInsert)
        assert ok
        return result

    return layer
