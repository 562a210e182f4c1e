"""The tool ``isthmus:hierarchy``."""

from __future__ import annotations

from typing import Any

from qgis.core import (
    QgsProcessing,
    QgsProcessingContext,
    QgsProcessingFeedback,
    QgsProcessingParameterFeatureSink,
    QgsProcessingParameterNumber,
    QgsPropertyDefinition,
)

from ..layers.fields import INTEGER, LONG, REAL, TEXT
from .cutting import PartitionTool

LEVEL_FIELDS = (
    ("part", INTEGER), ("parent", INTEGER), ("level", INTEGER), ("from_tau", REAL), ("to_tau", REAL),
    ("source", LONG), ("status", TEXT),
)  # fmt: skip
RANKED_FIELDS = (
    ("source", LONG),
    ("length", REAL),
    ("detour", REAL),
    ("persistence", REAL),
    ("rank", INTEGER),
)

HELP = """
<p>Cuts polygons once, for every <i>largest detour</i> (tau) from the smallest one on, and for every
number of parts: bays within seas, and seas within the ocean.</p>
<p>It begins with the fewest cuts at the smallest tau, as <i>Partition polygons at bottlenecks</i> finds
them, and takes cuts away one by one, always the one that is needed least: whose loss leaves the smallest
largest detour. That detour is the <i>persistence</i> of the cut: up to this tau it is needed. So the
parts are nested; for a single tau the fewest cuts may be one less here and there.</p>
<h3>To show one level</h3>
<p>The parts of all levels lie on top of each other. The filter <i>from_tau &lt;= 3 AND 3 &lt; to_tau</i>
shows the partition at tau = 3, and <i>persistence &gt; 3</i> its cuts. Parts that stay for ever have a
to_tau of 1,000,000,000, and cuts that only connect a hole have this persistence.</p>
<p>The style of the parts shows the level of the project variable <i>isthmus_tau</i> (Project, Properties,
Variables), or that of tau = 3. For a slider on it, enter this line in the Python console:</p>
<p>from qgis.PyQt.QtWidgets import QSlider; slider = QSlider(); slider.setRange(10, 300);
slider.valueChanged.connect(lambda value:
(QgsExpressionContextUtils.setProjectVariable(QgsProject.instance(), "isthmus_tau", value / 10),
iface.mapCanvas().refreshAllLayers())); slider.show()</p>
{lists}
<h3>Size of the result</h3>
<p>Each part of each level is written once. A large body that loses a thousand small parts comes a
thousand times: where there are so many cuts, as with PLACES = Any, give a number of parts or a larger
tau.</p>
<h3>Units</h3>
<p>Lengths and areas are in the units of the layer; if its coordinates are degrees, they are
metres and square metres on the ellipsoid. The results stay in the CRS of the layer.</p>
<h3>Guarantee</h3>
<p>At each tau, the way along the outline and the cuts that are left is at most tau times as long as each
possible cut. For a polygon without holes the persistences are exact, and at the smallest tau no
solution has fewer cuts. With holes the persistences are upper bounds, and cuts that connect holes stay.
No vertex is moved, and none is added unless you ask for it. What cannot be split passes through
unchanged, with the reason in the field <i>status</i>.</p>
"""


class HierarchyAlgorithm(PartitionTool):
    """Nested partitions for every tau."""

    help_text = HELP
    TAU = "TAU"
    PARTS = "PARTS"
    OUTPUT = "OUTPUT"
    CUTS = "CUTS"
    PART_COUNT = "PART_COUNT"
    CUT_COUNT = "CUT_COUNT"
    SKIPPED_COUNT = "SKIPPED_COUNT"

    def name(self) -> str:
        return "hierarchy"

    def displayName(self) -> str:
        return "Hierarchy of natural parts"

    def tags(self) -> list[str]:
        return (
            "hierarchy,level,nested,multiscale,scale,number,part,natural,partition,split,cut,bottleneck,"
            "neck,bay,peninsula,generalize,tau,persistence"
        ).split(",")

    def shortDescription(self) -> str:
        return "Cuts polygons into natural parts for every tau and every number of parts at once."

    def initAlgorithm(self, configuration: dict[str, Any] | None = None) -> None:
        self.add_input()
        self.add_dynamic(
            self.TAU,
            "Smallest tau, where the finest level begins",
            1.5,
            1.0,
            "The largest detour in the finest level: how many times longer than the straight line across "
            "a neck the way along the outline may be; at least 1. Smaller values cut more. A field or "
            "expression can set it for each feature.",
        )
        parts = QgsProcessingParameterNumber(
            self.PARTS, "Only the level with so many parts",
            QgsProcessingParameterNumber.Type.Integer, None, True, 1,
        )  # fmt: skip
        parts.setIsDynamic(True)
        kind = QgsPropertyDefinition.DataType.DataTypeNumeric
        parts.setDynamicPropertyDefinition(
            QgsPropertyDefinition(self.PARTS, kind, parts.description(), "number [≥ 1]")
        )
        parts.setDynamicLayerParameterName(self.INPUT)
        self.add(
            parts,
            "Writes just the level in which a feature has this number of parts, or the next best: all "
            "that there are, or one for each polygon of a multipart feature. A field or expression can "
            "set it for each feature; where it is empty, all levels are written.",
        )
        self.add_places()
        self.add_new_vertices(
            "Only those where a cut ends are added, with Z and M interpolated, and the parts of the levels "
            "without this cut do not have them. Neighbours in the layer do not get them."
        )
        self.add(
            QgsProcessingParameterFeatureSink(
                self.OUTPUT, "Parts of all levels", QgsProcessing.SourceType.TypeVectorPolygon
            ),
            "Every part of every level once, with all fields of the polygons, and part (its number in "
            "the feature, by level and size), parent (the part that it becomes a piece of; empty for "
            "those that stay), level (0 is the finest; that in which it comes up), from_tau and to_tau (it "
            "is there where from_tau <= tau < to_tau), source (the id of the feature) and status "
            "(empty, or why a polygon was not cut).",
        )
        self.add(
            QgsProcessingParameterFeatureSink(
                self.CUTS, "Cuts by persistence", QgsProcessing.SourceType.TypeVectorLine, optional=True
            ),
            "The cuts, with the id of their polygon (source), length (without that over holes), detour (how "
            "many times longer the way along the outline was; empty if only a cut connects the ends), "
            "persistence (the tau up to which the cut is needed) and rank (1 for the most persistent of "
            "the feature).",
        )
        self.add_numbers(
            (
                (self.PART_COUNT, "Number of parts in all levels"),
                (self.CUT_COUNT, "Number of cuts"),
                (self.SKIPPED_COUNT, "Number of features not solved"),
            )
        )

    def parameter_problem(self, parameters: dict[str, Any], context: QgsProcessingContext) -> str:
        problem = self.dynamic_problem(parameters, self.TAU, context, 1.0)
        if not problem and parameters.get(self.PARTS) is not None:
            problem = self.dynamic_problem(parameters, self.PARTS, context, 1.0)
        return problem or self.objective_problem(parameters, context)

    def processAlgorithm(
        self, parameters: dict[str, Any], context: QgsProcessingContext, feedback: QgsProcessingFeedback
    ) -> dict[str, Any]:
        from .hierarchy_run import run  # what runs needs shapely, what declares must not

        return run(self, parameters, context, feedback)
