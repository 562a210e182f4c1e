"""The regions of a map drawn by their class, with a legend."""

from __future__ import annotations

from typing import Any, Iterable

from qgis.core import (
    QgsCategorizedSymbolRenderer,
    QgsProperty,
    QgsRendererCategory,
    QgsSymbolLayer,
    QgsVectorLayer,
)
from qgis.PyQt.QtGui import QColor

from ..words import tr
from .areas import text

MOST = 100  # entries of a legend
TURN = 137.508  # degrees: neighbours in the order of classes, and those after, are far apart in hue
TONES = ((0.55, 0.72), (0.45, 0.60), (0.70, 0.84))  # saturation and lightness


def by_class(layer: QgsVectorLayer, name: str, values: Iterable[Any]) -> None:
    """Give a layer that has a single symbol a legend with a colour for each class.

    With more classes than a legend shows nothing is changed.

    Parameters
    ----------
    layer : QgsVectorLayer
    name : str
        The field with the class.
    values : sequence
        The classes of the whole map: the same map gets the same colours, whatever is left of it.
    """
    by_text = {}
    for value in {(type(value), str(value)): value for value in values}.values():
        by_text.setdefault(text(value), []).append(value)
    without = by_text.pop(None, None) is not None
    if not 0 < len(by_text) <= MOST:
        return
    plain = layer.renderer().symbol()

    def entry(value, label, colour):
        symbol = plain.clone()
        symbol.symbolLayer(0).setDataDefinedProperty(QgsSymbolLayer.Property.PropertyFillColor, QgsProperty())
        symbol.setColor(colour)
        return QgsRendererCategory(value, symbol, label)

    categories = [
        entry(
            by_text[one][0] if len(by_text[one]) == 1 else by_text[one],
            one,
            QColor.fromHslF((40.0 + TURN * k) % 360.0 / 360.0, *TONES[k % len(TONES)]),
        )
        for k, one in enumerate(sorted(by_text))
    ]
    if without:
        categories.append(entry(None, tr("no class"), QColor("white")))
    layer.setRenderer(QgsCategorizedSymbolRenderer(name, categories))
