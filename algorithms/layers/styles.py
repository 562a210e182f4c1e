"""How results look, and lie one above the other, where they are loaded into a project."""

from __future__ import annotations

from pathlib import Path
from typing import Callable

from qgis.core import (
    QgsProcessingContext,
    QgsProcessingLayerPostProcessorInterface,
    QgsProcessingUtils,
    QgsVectorLayer,
)
from qgis.PyQt import sip

STYLES = Path(__file__).parents[2] / "resources" / "styles"


class _Styler(QgsProcessingLayerPostProcessorInterface):
    """Gives a loaded result its style, and its place among the results of the run."""

    def __init__(self, style, rank, dress):
        super().__init__()
        self.style, self.rank, self.dress = style, rank, dress

    def postProcessLayer(self, layer, context, feedback):
        if self.style:
            layer.loadNamedStyle(str(STYLES / self.style))
            if self.dress:
                self.dress(layer)
            layer.triggerRepaint()
        _arrange(context)


def _arrange(context):
    """Put the results of a run into the order of their ranks in the layer tree.

    QGIS 3.22 loads them in the order of their ids or paths, each on top of the one before.
    """
    ranked = {}  # by group
    for destination, details in context.layersToLoadOnCompletion().items():
        styler = details.postProcessor()
        layer = QgsProcessingUtils.mapLayerFromString(destination, context, False)
        if details.project is None or layer is None or not isinstance(styler, _Styler):
            continue
        node = details.project.layerTreeRoot().findLayer(layer.id())
        if node is not None:
            ranked.setdefault(node.parent(), []).append((styler.rank, node))
    for group, found in ranked.items():
        places = [group.children().index(node) for _, node in sorted(found, key=lambda f: f[0])]
        if places == sorted(places):
            continue
        top = min(places)
        for _, node in sorted(found, key=lambda f: -f[0]):
            group.insertChildNode(top, node.clone())
            group.removeChildNode(node)


_stylers = []  # those that wait for their layer: Python must not delete them


def style_on_load(
    context: QgsProcessingContext,
    destination: str | None,
    style: str | None,
    rank: int = 1,
    *,
    dress: Callable[[QgsVectorLayer], None] | None = None,
) -> None:
    """Give a result its style, if any, and its place if Processing loads it into a project.

    Results of a lower rank lie above those of a higher one. ``dress`` is called with the layer that has got
    its style.
    """
    if destination and context.willLoadLayerOnCompletion(destination):
        # one for each result: the context deletes it in the end, whatever the documentation says
        styler = _Styler(style, rank, dress)
        _stylers[:] = [old for old in _stylers if not sip.isdeleted(old)] + [styler]
        context.layerToLoadOnCompletionDetails(destination).setPostProcessor(styler)
