"""The short run of the fuzzing tools; the long one is `./run fuzz`."""

import sys
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "core")]


@pytest.fixture(scope="session")
def tools(qgis_app, qgis_processing):
    """The provider, registered, its tools watched for exceptions."""
    pytest.importorskip("qgis.core", reason="these tests need QGIS")
    import cases
    from isthmus.algorithms.provider import IsthmusProvider
    from qgis.core import QgsApplication

    registry = QgsApplication.processingRegistry()
    if registry.providerById("isthmus") is None:
        registry.addProvider(IsthmusProvider())
    provider = registry.providerById("isthmus")
    cases.watch({type(tool) for tool in provider.algorithms()})
    return provider
