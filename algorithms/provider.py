"""The Processing provider ``isthmus``."""

from __future__ import annotations

from pathlib import Path

from qgis.core import QgsProcessingProvider
from qgis.PyQt.QtGui import QIcon

from .aggregation.aggregate import AggregateAlgorithm
from .aggregation.prepare_aggregation import PrepareAggregationAlgorithm
from .base import ICON
from .focus.focus_map import FocusMapAlgorithm
from .partition.hierarchy import HierarchyAlgorithm
from .partition.partition import PartitionAlgorithm
from .partition.partition_budget import PartitionBudgetAlgorithm
from .partition.tradeoff import TradeoffAlgorithm
from .words import tr


class IsthmusProvider(QgsProcessingProvider):
    """Lists the tools."""

    def id(self) -> str:
        return "isthmus"

    def name(self) -> str:
        return "Isthmus"

    def longName(self) -> str:
        return tr("Isthmus: natural partitions of polygons")

    def icon(self) -> QIcon:
        return QIcon(ICON)

    def versionInfo(self) -> str:
        text = (Path(__file__).parent.parent / "metadata.txt").read_text(encoding="utf-8")
        return next(line[8:] for line in text.splitlines() if line.startswith("version="))

    def loadAlgorithms(self) -> None:
        for tool in (
            PartitionAlgorithm,
            PartitionBudgetAlgorithm,
            TradeoffAlgorithm,
            HierarchyAlgorithm,
            PrepareAggregationAlgorithm,
            AggregateAlgorithm,
            FocusMapAlgorithm,
        ):
            self.addAlgorithm(tool())
