"""New fields of results: what tools declare, and what they write."""

from __future__ import annotations

from typing import Iterable

from qgis.core import Qgis, QgsField, QgsFields
from qgis.PyQt.QtCore import QMetaType, QVariant

INTEGER, LONG, REAL, TEXT = "Int", "LongLong", "Double", "QString"


def field(name: str, kind: str) -> QgsField:
    """Return a new field; kind is INTEGER, LONG, REAL or TEXT."""
    if Qgis.QGIS_VERSION_INT >= 33800:
        return QgsField(name, getattr(QMetaType.Type, kind))
    return QgsField(name, getattr(QVariant, "String" if kind == TEXT else kind))


def make_fields(definition: Iterable[tuple[str, str]]) -> QgsFields:
    """Return fields of (name, kind) pairs; kinds as in `field`."""
    fields = QgsFields()
    for name, kind in definition:
        fields.append(field(name, kind))
    return fields
