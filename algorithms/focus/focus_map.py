"""The tool ``isthmus:focusmap``."""

from __future__ import annotations

from typing import Any

import numpy as np
from qgis.core import (
    QgsProcessing,
    QgsProcessingContext,
    QgsProcessingFeedback,
    QgsProcessingOutputMultipleLayers,
    QgsProcessingOutputString,
    QgsProcessingParameterBoolean,
    QgsProcessingParameterEnum,
    QgsProcessingParameterFeatureSink,
    QgsProcessingParameterFeatureSource,
    QgsProcessingParameterFileDestination,
    QgsProcessingParameterMultipleLayers,
    QgsProcessingParameterNumber,
)

from ..base import IsthmusAlgorithm
from ..dependencies import dependency_problem, install_hint
from ..layers.fields import REAL, TEXT
from ..partition.cutting import ANY, places_parameter
from ..words import tr

RULES = ("MinSize", "MinLength", "Greedy", "Proximity", "None")
EDGE_FIELDS = (("kind", TEXT), ("length", REAL), ("stretch", REAL))

HELP = """
<p>Enlarges a region of a map and keeps the shape of the rest, as far as that is possible: a map in
which one country, city or coast is larger, and all around it is still to be recognised.</p>
<p>The region may be a feature of the map: choose the same layer, and tick <i>Selected features
only</i>. A map in degrees is solved in an equidistant cylindrical projection, true at its middle
latitude, and comes back in degrees; a projected CRS shows better what you get.</p>
{lists}
<h3>How it works</h3>
<p>All lines outside the region keep their direction and shape, and their scale changes smoothly. What
holds a country together are not its outlines alone: east and west coast must know of each other. So
the tool adds <i>relevant edges</i>, diagonals between points that are close to each other though the
way along the outline is long, and keeps these as well. By default it finds the smallest set of
them by itself, the cuts of the tool <i>Partition polygons at bottlenecks</i>. All features are solved
together: islands move with their mainland, and points that lines or polygons share stay together.
The whole frame of the map, land and sea, is triangulated, and the map is linear on each triangle; land is
stiffer than sea. Large
maps are solved on a coarse triangulation of about 3,000 points and the outline of the region, and the
detail is put back point by point.</p>
<h3>Room</h3>
<p>What the region gains, the rest has to give, or the map becomes larger: by <i>Growth of the map</i> at
most, and by no more than it needs so that what is around the region bends as little for a small
region as for a large one, at any scale. With no growth at all the extent is kept, and what lies between the
region and the edge gets thin.</p>
<h3>Which relevant edges</h3>
<p><i>MinSize</i>, the optimal set, is the best choice: few edges, and the shape is kept. <i>Greedy</i>
(van Dijk and others 2013) needs more edges. <i>Proximity</i> (Harrie and Sarjakoski 2002) and
<i>None</i> are there to compare with. With <i>Natural</i> places (<i>Where a cut may lie</i>) there are few
edges, where people see parts meet; on the maps measured every diagonal kept the shape better.</p>
<h3>Guarantee</h3>
<p>The region has exactly the scale asked for, or nothing is written and the tool says why. No triangle is
turned over: no lines cross that did not cross before, and polygons stay valid. Where the end or a point
of one line lies on another without being a point of it, or lines cross, the line gets a point there, so
that they stay together. This is tested exactly, where the points will be, before anything is written.
Squares, as rasters have them, stay convex besides, unless the log tells how many do not. The numbers
tell how much the triangles of the polygons are distorted: the change of angles that half, and 95 %, of
the area do not exceed.</p>
<h3>Method</h3>
<p>J.-H. Haunert and L. Sering, Drawing Road Networks with Focus Regions, 2011; relevant edges: J.-H.
Haunert and W. Meulemans, Partitioning Polygons via Graph Augmentation, GIScience 2016, section 5.1;
steps that turn no triangle: J. Smith and S. Schaefer, Bijective Parameterization with Free Boundaries,
2015; detail without a fold: H. Shen and others, Progressive Embedding, 2019.</p>
"""


class FocusMapAlgorithm(IsthmusAlgorithm):
    """Enlarge a region of a map in its context."""

    help_text = HELP
    FOCUS = "FOCUS"
    SCALE = "SCALE"
    EDGES = "EDGES"
    SELECTION = "SELECTION"
    TAU = "TAU"
    PLACES = "PLACES"
    SMALLEST_PART = "SMALLEST_PART"
    FRAME = "FRAME"
    GROWTH = "GROWTH"
    ALONG = "ALONG"
    OUTPUT = "OUTPUT"
    CARRIED = "CARRIED"
    EDGES_USED = "EDGES_USED"
    CARRIED_LAYERS = "CARRIED_LAYERS"
    SCALE_REACHED = "SCALE_REACHED"
    FLIPPED_AREA = "FLIPPED_AREA"
    MEDIAN_DISTORTION = "MEDIAN_DISTORTION"
    HIGH_DISTORTION = "HIGH_DISTORTION"
    CROSSINGS = "CROSSINGS"
    EDGE_COUNT = "EDGE_COUNT"
    SECONDS = "SECONDS"
    PROBLEM = "PROBLEM"

    def name(self) -> str:
        return "focusmap"

    def displayName(self) -> str:
        return "Enlarge a region in context"

    def group(self) -> str:
        return "Deformation"

    def groupId(self) -> str:
        return "deformation"

    def tags(self) -> list[str]:
        return (
            "focus,enlarge,magnify,zoom,inset,variable scale,fisheye,lens,cartogram,distort,"
            "deform,context,map,generalize"
        ).split(",")

    def shortDescription(self) -> str:
        return "Enlarges a region of a map and keeps the shape of the rest."

    def canExecute(self) -> tuple[bool, str]:
        problem = dependency_problem() or scipy_problem()
        return not problem, problem

    def initAlgorithm(self, configuration: dict[str, Any] | None = None) -> None:
        add = self.add
        add(
            QgsProcessingParameterFeatureSource(
                self.INPUT,
                "Map (polygons or lines)",
                [QgsProcessing.SourceType.TypeVectorPolygon, QgsProcessing.SourceType.TypeVectorLine],
            ),
            "The polygons or lines of the map. All features are solved together.",
        )
        add(
            QgsProcessingParameterFeatureSource(
                self.FOCUS, "Region to enlarge", [QgsProcessing.SourceType.TypeVectorPolygon]
            ),
            "One or more polygons around what is to become larger. A rough outline will do: what "
            "counts are the points of the map inside.",
        )
        add(
            QgsProcessingParameterNumber(
                self.SCALE,
                "Scale (times as large)",
                QgsProcessingParameterNumber.Type.Double,
                defaultValue=2.0,
                minValue=0.01,
                maxValue=100.0,
            ),
            "How many times as large the region becomes, exactly. Below 1 it shrinks; 1 changes nothing.",
            decimals=2,
        )
        add(
            QgsProcessingParameterFeatureSource(
                self.EDGES,
                "Relevant edges",
                [QgsProcessing.SourceType.TypeVectorLine],
                optional=True,
            ),
            "Your own relevant edges, such as the cuts of the partition tool: lines between points of "
            "the map. If there are none, the tool finds them by the rule below.",
            advanced=True,
        )
        add(
            QgsProcessingParameterEnum(
                self.SELECTION,
                "Rule for relevant edges, where none are given",
                options=RULES,
                defaultValue=RULES[0],
                usesStaticStrings=True,
            ),
            "MinSize: the fewest edges so that no way along outline and edges is more than tau times "
            "as long as the straight line, for all diagonals of a triangulation. MinLength: those of "
            "least total length. Greedy: van Dijk and "
            "others 2013. Proximity: Harrie and Sarjakoski 2002. None: only the lines of the map.",
            advanced=True,
        )
        add(
            QgsProcessingParameterNumber(
                self.TAU,
                "Largest detour (tau)",
                QgsProcessingParameterNumber.Type.Double,
                defaultValue=2.0,
                minValue=1.0,
            ),
            "Smaller values give more edges and a stiffer map. Not used by Proximity; where there "
            "are islands, edges join them by the same measure.",
            advanced=True,
            decimals=2,
        )
        add(
            places_parameter(self.PLACES, ANY),
            "For MinSize and MinLength. Natural: only where people see parts meet, at places where the "
            "outline is concave and the polygon opens up beside the cut; a few edges then do, but the shape "
            "is kept less well. Any: between any two vertices that a triangulation joins, as in the paper.",
            advanced=True,
        )
        add(
            QgsProcessingParameterNumber(
                self.SMALLEST_PART,
                "Smallest part (per cent of the polygon)",
                QgsProcessingParameterNumber.Type.Double,
                defaultValue=0.0,
                minValue=0.0,
                maxValue=100.0,
                optional=True,  # models of before do not give it
            ),
            "For MinSize and MinLength. Smaller parts are not cut off, smaller holes attract no cuts, and "
            "the length of the outline is measured without the detail that is much smaller. 0: everything "
            "counts.",
            advanced=True,
            decimals=3,
        )
        add(
            QgsProcessingParameterBoolean(self.FRAME, "Keep the extent of the map (frame)", True),
            "On: the map stays inside the extent that it has, but for the growth below, and reaches to "
            "its sides. Off: it grows as it likes, the region stays where it is, and the outermost "
            "points keep their scale.",
        )
        add(
            QgsProcessingParameterNumber(
                self.GROWTH,
                "Growth of the map (%)",
                QgsProcessingParameterNumber.Type.Double,
                defaultValue=200.0,
                minValue=0.0,
                maxValue=1000.0,
                optional=True,
            ),
            "How much wider and higher the frame may become, to both sides. It grows by less where less "
            "is enough: a region that takes the share f of the width lets the map grow to scale times "
            "f to the power 2/7. 0 keeps the extent. Not used where the frame is switched off.",
            decimals=0,
        )
        add(
            QgsProcessingParameterMultipleLayers(
                self.ALONG,
                "Further layers to carry along",
                QgsProcessing.SourceType.TypeVectorAnyGeometry,
                optional=True,
            ),
            "Rivers, towns, labels: deformed as the map around them. Lines get points where the map bends "
            "them.",
        )
        add(
            QgsProcessingParameterFeatureSink(self.OUTPUT, "Focus map"),
            "All features and fields of the map.",
        )
        add(
            QgsProcessingParameterFileDestination(
                self.CARRIED,
                "Carried layers",
                "GeoPackage (*.gpkg)",
                optional=True,
                createByDefault=True,
            ),
            "A GeoPackage with one layer for each further layer, by its name. It is written anew.",
        )
        add(
            QgsProcessingParameterFeatureSink(
                self.EDGES_USED,
                "Relevant edges used",
                QgsProcessing.SourceType.TypeVectorLine,
                optional=True,
                createByDefault=False,
            ),
            "The relevant edges where they are in the focus map: kind (selected, given, or join "
            "between islands), length before, and stretch (length after over length before).",
        )
        self.addOutput(QgsProcessingOutputMultipleLayers(self.CARRIED_LAYERS, "Carried layers"))
        self.add_numbers(
            (
                (self.SCALE_REACHED, "Scale reached in the focus"),
                (self.FLIPPED_AREA, "Area upside down (%)"),
                (self.MEDIAN_DISTORTION, "Median angular distortion (degrees)"),
                (self.HIGH_DISTORTION, "Angular distortion, 95 % (degrees)"),
                (self.CROSSINGS, "Number of new crossings"),
                (self.EDGE_COUNT, "Number of relevant edges"),
                (self.SECONDS, "Time (seconds)"),
            )
        )
        self.addOutput(QgsProcessingOutputString(self.PROBLEM, "What is wrong (empty if nothing is)"))

    def parameter_problem(self, parameters: dict[str, Any], context: QgsProcessingContext) -> str:
        problem = scipy_problem()
        return (
            problem
            or self.number_problem(parameters, context, self.SCALE, 0.01)
            or self.limit_problem(parameters, context, self.SCALE)
            or self.number_problem(parameters, context, self.TAU, 1.0)
            or self.limit_problem(parameters, context, self.SMALLEST_PART)
            or self.number_problem(parameters, context, self.GROWTH, 0.0)
        )

    def processAlgorithm(
        self, parameters: dict[str, Any], context: QgsProcessingContext, feedback: QgsProcessingFeedback
    ) -> dict[str, Any]:
        from .focus_map_run import run  # what runs needs shapely, what declares must not

        return run(self, parameters, context, feedback)


def scipy_problem() -> str:
    """Return what to do if scipy is missing, or ''."""
    try:
        import scipy.sparse.linalg  # noqa: F401
        import scipy.spatial  # noqa: F401
    except ImportError:
        return tr(
            "This tool needs the Python package scipy. {}; on Debian and Ubuntu: apt install python3-scipy"
        ).format(install_hint(np.__version__, ["scipy"]))
    return ""
