"""The tool ``isthmus:focusmap``."""

import contextlib
import math
import time
from pathlib import Path

import numpy as np
from qgis.core import (
    QgsCoordinateTransform,
    QgsCsException,
    QgsFeatureRequest,
    QgsFeatureSink,
    QgsFields,
    QgsGeometry,
    QgsProcessing,
    QgsProcessingContext,
    QgsProcessingException,
    QgsProcessingOutputMultipleLayers,
    QgsProcessingOutputString,
    QgsProcessingParameterBoolean,
    QgsProcessingParameterEnum,
    QgsProcessingParameterFeatureSink,
    QgsProcessingParameterFeatureSource,
    QgsProcessingParameterFileDestination,
    QgsProcessingParameterMultipleLayers,
    QgsProcessingParameterNumber,
    QgsProcessingUtils,
    QgsVectorFileWriter,
    QgsVectorLayer,
    QgsWkbTypes,
)

from ..base import IsthmusAlgorithm
from ..dependencies import dependency_problem, install_hint
from ..layers import wkb
from ..layers.sinks import Sinks, make_fields
from ..layers.source import WITHOUT_VALIDITY_CHECK
from ..layers.styles import style_on_load
from ..layers.wkb import REAL, TEXT
from ..partition.cutting import ANY, NATURAL, places_parameter

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
that they stay together. The numbers tell how much the triangles of the polygons are distorted: the
change of angles that half, and 95 %, of the area do not exceed.</p>
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

    def name(self):
        return "focusmap"

    def displayName(self):
        return "Enlarge a region in context"

    def group(self):
        return "Deformation"

    def groupId(self):
        return "deformation"

    def tags(self):
        return (
            "focus,enlarge,magnify,zoom,inset,variable scale,fisheye,lens,cartogram,distort,"
            "deform,context,map,generalize"
        ).split(",")

    def shortDescription(self):
        return "Enlarges a region of a map and keeps the shape of the rest."

    def canExecute(self):
        problem = dependency_problem() or scipy_problem()
        return not problem, problem

    def initAlgorithm(self, configuration=None):
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
            "Rivers, towns, labels: deformed as the map around them.",
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

    def _rule(self, parameters, context):
        """The rule for relevant edges, as `selection.select` takes it."""
        from ...core.focus.selection import rule_of

        return rule_of(
            self.parameterAsEnumString(parameters, self.SELECTION, context),
            self.parameterAsEnumString(parameters, self.PLACES, context) == NATURAL,
            self.parameterAsDouble(parameters, self.SMALLEST_PART, context) / 100.0,
        )

    def parameter_problem(self, parameters, context):
        problem = scipy_problem()
        return (
            problem
            or self.number_problem(parameters, context, self.SCALE, 0.0)
            or self.number_problem(parameters, context, self.TAU, 1.0)
            or self.limit_problem(parameters, context, self.SMALLEST_PART)
            or self.number_problem(parameters, context, self.GROWTH, 0.0)
        )

    def processAlgorithm(self, parameters, context, feedback):
        source = self.parameterAsSource(parameters, self.INPUT, context)
        focus_source = self.parameterAsSource(parameters, self.FOCUS, context)
        for name, value in ((self.INPUT, source), (self.FOCUS, focus_source)):
            if value is None:
                raise QgsProcessingException(self.invalidSourceError(parameters, name))
        from ...core.errors import Cancelled, IsthmusError
        from ...core.focus.enlarge import enlarge
        from ...core.focus.globe import on_the_globe
        from ...core.metric import FARTHEST

        begun = time.monotonic()
        crs = source.sourceCrs()
        held, runs = [], []
        for feature in source.getFeatures(QgsFeatureRequest(), WITHOUT_VALIDITY_CHECK):
            if feedback.isCanceled():
                return {}
            held.append(feature)
            runs.append(wkb.Runs(feature.geometry()))
        wrong = [k for k, one in enumerate(runs) if not (np.abs(one.xy) <= FARTHEST).all()]
        for k in wrong:
            runs[k] = wkb.Runs(QgsGeometry())  # as if it had none
        if wrong:
            ids = ", ".join(str(held[k].id()) for k in wrong[:10]) + " ..." * (len(wrong) > 10)
            feedback.pushWarning(
                "Left where they are, since coordinates are not finite (NaN or infinity) or larger than "
                f"{FARTHEST:g}: feature {ids}."
            )
        counts = [count for one in runs for count in one.counts]
        if not counts:
            raise QgsProcessingException("The map has no features with a geometry that can be moved.")
        rows = np.concatenate([one.xy for one in runs])
        starts = np.append(0, np.cumsum(counts))
        polygons, first = [], 0
        for one in runs:
            polygons += [[first + ring for ring in rings] for rings in one.polygons]
            first += len(one.counts)
        focus = self._focus(focus_source, crs, context)
        given = self._given(parameters, context, crs, rows, feedback)
        feedback.pushInfo(f"{len(held)} features, {len(rows)} points.")
        frame = self.parameterAsBoolean(parameters, self.FRAME, context)
        growth, aspect = self.parameterAsDouble(parameters, self.GROWTH, context) / 100.0, 1.0
        if crs.isGeographic():
            growth, aspect = on_the_globe(rows, growth)
            feedback.pushInfo(
                f"The map is in degrees ({crs.authid()}). It is solved in the equidistant cylindrical "
                f"projection with true lengths at latitude {math.degrees(math.acos(aspect)):.1f}, and "
                "the result is in degrees."
            )
        try:
            result = enlarge(
                rows,
                starts,
                polygons,
                focus,
                self.parameterAsDouble(parameters, self.SCALE, context),
                edges=given,
                rule=self._rule(parameters, context),
                tau=self.parameterAsDouble(parameters, self.TAU, context),
                frame=frame,
                growth=growth,
                aspect=aspect,
                progress=lambda share: feedback.setProgress(95.0 * share),
                cancelled=feedback.isCanceled,
            )
        except Cancelled:
            return {}
        except IsthmusError as problem:
            message = str(problem).rstrip(".")
            end = "" if message.endswith("?") else "."
            raise QgsProcessingException(f"{message[0].upper()}{message[1:]}{end}") from None
        for reason in result.skipped[:20]:
            feedback.pushWarning(f"No relevant edges for {reason}.")
        if len(result.skipped) > 20:
            feedback.pushWarning(f"... and for {len(result.skipped) - 20} more.")
        if crs.isGeographic() and not (np.abs(result.rows) <= (180.0, 90.0)).all():
            raise QgsProcessingException(
                "The map would grow beyond the globe. Keep its extent (switch the frame on)."
            )
        width, height = (100.0 * (result.growth - 1.0)).tolist()
        feedback.pushInfo(f"The map becomes {width:.0f} % wider and {height:.0f} % higher.")
        if len(result.splits):
            feedback.pushInfo(
                f"{len(result.splits)} points were put into lines where others meet or cross them."
            )
        with Sinks(self, parameters, context, feedback) as sinks:
            self._write(sinks, source, held, runs, result)
            self._write_edges(sinks, crs, result)
            answer = self._carry(parameters, context, crs, result, feedback)
            feedback.setProgress(100)
        answer.update(sinks.destinations)
        style_on_load(context, answer.get(self.OUTPUT), None, 2)
        style_on_load(context, answer.get(self.EDGES_USED), "cuts.qml", 0)
        answer.update({
            self.SCALE_REACHED: result.scale,
            self.FLIPPED_AREA: 100.0 * result.distortion.flipped,
            self.MEDIAN_DISTORTION: result.distortion.median,
            self.HIGH_DISTORTION: result.distortion.high,
            self.CROSSINGS: 0,  # no triangle is turned
            self.EDGE_COUNT: len(result.edges),
            self.SECONDS: time.monotonic() - begun,
            self.PROBLEM: "",  # or there is no map at all
        })
        return answer

    def _focus(self, source, crs, context):
        """The region in focus, in the CRS of the map."""
        import shapely

        from ...core.metric import FARTHEST

        found = []
        for geometry in _geometries(source, crs, context):
            data = bytes(_straight(geometry).asWkb())
            # a ring of two points is no region
            found.append(shapely.force_2d(shapely.from_wkb(data, on_invalid="ignore")))
        found = [
            one for one in found
            if one is not None and (np.abs(shapely.get_coordinates(one)) <= FARTHEST).all()
        ]
        if not found:
            raise QgsProcessingException(
                "The layer of the region to enlarge has no polygons whose coordinates are finite."
            )
        return shapely.union_all(shapely.make_valid(found))

    def _given(self, parameters, context, crs, rows, feedback):
        """The rows at the ends of relevant edges that were given, or None."""
        source = self.parameterAsSource(parameters, self.EDGES, context)
        if source is None:
            return None
        from ...core.focus.graph import match

        ends = [np.empty((0, 2, 2))]
        for geometry in _geometries(source, crs, context):
            one, start = wkb.Runs(geometry), 0
            for count in one.counts:
                line = one.xy[start:start + count]
                line = np.where(np.isfinite(line), line, 1e300)  # where no point of the map is
                ends.append(np.stack((line[:-1], line[1:]), axis=1))
                start += count
        ends = np.concatenate(ends)
        found = match(rows, ends.reshape(-1, 2)).reshape(-1, 2)
        good = (found >= 0).all(axis=1)
        if not good.all():
            feedback.pushWarning(
                f"{np.count_nonzero(~good)} of {len(good)} relevant edges were left out: an end is "
                "not a point of the map."
            )
        return found[good]

    def _write(self, sinks, source, held, runs, result):
        kind = QgsWkbTypes.linearType(source.wkbType())
        sinks.open(self.OUTPUT, source.fields(), kind, source.sourceCrs())
        start = 0
        row, vertex, share = result.splits.T
        for feature, one in zip(held, runs):
            count = sum(one.counts)
            lo, hi = row.searchsorted((start, start + count))
            splits = zip(
                (row[lo:hi].astype(int) - start).tolist(),
                result.moved[vertex[lo:hi].astype(int)].tolist(), share[lo:hi].tolist(),
            )
            geometry = feature.geometry()
            if count:
                geometry = one.moved(result.rows[start:start + count], list(splits))
            start += count
            sinks.add(self.OUTPUT, geometry, feature.attributes(), f"feature {feature.id()}")

    def _write_edges(self, sinks, crs, result):
        fields, kind = make_fields(EDGE_FIELDS), QgsWkbTypes.Type.LineString
        if not sinks.open(self.EDGES_USED, fields, kind, crs, False):
            return
        before, after = (
            np.hypot(*(xy[result.edges[:, 0]] - xy[result.edges[:, 1]]).T)
            for xy in (result.points, result.moved)
        )
        lines = wkb.line_geometries(result.moved, result.edges, [0] * len(result.edges))
        for line, kind, length, longer in zip(
            lines, result.kind.tolist(), before.tolist(), (after / before).tolist()
        ):
            sinks.add(self.EDGES_USED, line, [kind, length, longer])

    def _carry(self, parameters, context, crs, result, feedback):
        layers = self.parameterAsLayerList(parameters, self.ALONG, context)
        if not layers:
            return {self.CARRIED_LAYERS: []}
        from ...core.focus.carrying import Carrier

        carrier = Carrier(result.points, result.moved, result.triangles)
        path = self.parameterAsFileOutput(parameters, self.CARRIED, context)
        path = path or QgsProcessingUtils.generateTempFilename("carried.gpkg")
        written, names = [], []
        try:
            for layer in layers:
                if feedback.isCanceled():
                    break
                name = layer.name() or "layer"
                while name.lower() in names:  # to a GeoPackage, Roads and roads are one name
                    name += "_2"
                names.append(name.lower())
                whole = QgsVectorFileWriter.ActionOnExistingFile
                action = whole.CreateOrOverwriteFile if len(names) == 1 else whole.CreateOrOverwriteLayer
                written.append(
                    self._carry_layer(layer, name, path, action, crs, carrier, context, feedback)
                )
        except QgsProcessingException:
            _discard(path)
            raise
        if feedback.isCanceled():
            _discard(path)
            return {self.CARRIED_LAYERS: []}
        return {self.CARRIED: path, self.CARRIED_LAYERS: written}

    def _carry_layer(self, layer, name, path, action, crs, carrier, context, feedback):
        options = QgsVectorFileWriter.SaveVectorOptions()
        options.driverName, options.layerName = "GPKG", name
        options.actionOnExistingFile = action
        kind = QgsWkbTypes.linearType(layer.wkbType())
        fields = QgsFields(layer.fields())
        writer = QgsVectorFileWriter.create(
            path, fields, kind, crs, context.transformContext(), options,
            QgsFeatureSink.SinkFlag.RegeneratePrimaryKey,
        )  # fmt: skip
        if writer.hasError() != QgsVectorFileWriter.WriterError.NoError:
            raise QgsProcessingException(f"{path} cannot be written: {writer.errorMessage()}")
        transform = QgsCoordinateTransform(layer.crs(), crs, context.transformContext())
        count, lost = 0, []
        for feature in layer.getFeatures():
            count += 1
            geometry = feature.geometry()
            if not geometry.isNull():
                try:
                    geometry.transform(transform)
                    one = wkb.Runs(geometry)
                    placed = np.isfinite(one.xy).all()
                except QgsCsException:
                    placed = False
                if not placed:
                    feature.clearGeometry()
                    lost.append(feature.id())
                elif one.counts:
                    feature.setGeometry(one.moved(carrier(one.xy)))
            if not writer.addFeature(feature, QgsFeatureSink.Flag.FastInsert):
                raise QgsProcessingException(
                    f"A feature of {name} could not be written: {writer.errorMessage()}"
                )
        del writer
        if lost:
            feedback.pushWarning(
                f"{name}: features {', '.join(map(str, lost[:10]))}{' ...' * (len(lost) > 10)} have no "
                "place in the CRS of the map, and are carried without a geometry."
            )
        address = f"{path}|layername={name}"
        # what a full disk swallows, the writer may tell nobody
        if QgsVectorLayer(address, name, "ogr").featureCount() != count:
            raise QgsProcessingException(
                f"{name} could not be written to {path} as a whole. Is the disk full?"
            )
        details = QgsProcessingContext.LayerDetails(name, context.project(), name)
        if context.project() is not None:
            carried = QgsVectorLayer(address, name, "ogr")
            context.temporaryLayerStore().addMapLayer(carried)
            context.addLayerToLoadOnCompletion(carried.id(), details)
        return address


def _discard(path):
    """Remove what is half written: it would look complete."""
    for end in ("", "-journal", "-wal", "-shm"):
        with contextlib.suppress(OSError):
            Path(path + end).unlink()


def scipy_problem():
    """Return what to do if scipy is missing, or ''."""
    try:
        import scipy.sparse.linalg  # noqa: F401
        import scipy.spatial  # noqa: F401
    except ImportError:
        return (
            f"This tool needs the Python package scipy. {install_hint(np.__version__, ['scipy'])}; "
            "on Debian and Ubuntu: apt install python3-scipy"
        )
    return ""


def _geometries(source, crs, context):
    """The geometries of a source in another CRS, none empty."""
    transform = QgsCoordinateTransform(source.sourceCrs(), crs, context.transformContext())
    request = QgsFeatureRequest().setSubsetOfAttributes([])
    for feature in source.getFeatures(request, WITHOUT_VALIDITY_CHECK):
        geometry = feature.geometry()
        if geometry.isNull() or geometry.isEmpty():
            continue
        if transform.isValid() and not transform.isShortCircuited():
            try:
                geometry.transform(transform)
            except QgsCsException:
                raise QgsProcessingException(
                    f"Feature {feature.id()} of {source.sourceName()} has no place in the CRS of the map "
                    f"({crs.authid()}). Is the CRS of {source.sourceName()} right?"
                ) from None
        yield geometry


def _straight(geometry):
    abstract = geometry.constGet()
    curved = QgsWkbTypes.isCurvedType(abstract.wkbType())
    return abstract.segmentize() if curved else abstract
