"""A case: a layer, a tool and its parameters, in a form that can be saved; how to draw and run one."""

import math
import shutil
import tempfile
import time
import warnings
from pathlib import Path
from typing import NamedTuple

import hostile
import numpy as np
from hypothesis import strategies as st
from qgis.core import (
    NULL,
    QgsCoordinateReferenceSystem,
    QgsFeature,
    QgsFeatureSink,
    QgsField,
    QgsFields,
    QgsGeometry,
    QgsMemoryProviderUtils,
    QgsProcessingContext,
    QgsProcessingException,
    QgsProcessingFeedback,
    QgsProject,
    QgsProperty,
    QgsVectorFileWriter,
    QgsVectorLayer,
    QgsWkbTypes,
)
from qgis.PyQt.QtCore import QDate, QDateTime, QVariant

from isthmus.tests.full_disk import small_files

POLYGONS = QgsWkbTypes.GeometryType.PolygonGeometry
DRIVERS = {"gpkg": "GPKG", "shp": "ESRI Shapefile", "geojson": "GeoJSON"}


class Case(NamedTuple):
    """All that a run depends on.

    Attributes
    ----------
    tool : str
        partition, partitionbudget, tradeoff or hierarchy.
    parameters : dict
        Numbers and texts; {"expression": text} for a data-defined number.
    wkb_type : str
        Type of the layer, such as MultiPolygonZ.
    crs : str
    fields : list of (name, kind)
    features : list of (hex, values)
        WKB, or None without geometry; or a text, for curves as WKT.
    lines : list of hex, or None
        Candidate lines.
    source, sink : str
        memory, gpkg, shp or geojson; a sink may also be nowhere.
    diagonals : bool
        Whether the layer DIAGONALS is asked for.
    cancel : int or None
        Cancel at this call of the feedback.
    room : int or None
        The largest size of a file in bytes, as if the disk were full.
    twin : bool
        Whether to run it again with rings turned round and features shuffled.
    """

    tool: str = "partition"
    parameters: dict = {}
    wkb_type: str = "Polygon"
    crs: str = "EPSG:3857"
    fields: list = []
    features: list = []
    lines: list = None
    source: str = "memory"
    sink: str = "memory"
    diagonals: bool = True
    cancel: int = None
    room: int = None
    twin: bool = False

    def dump(self):
        """All of it, with the geometries as text too, for JSON."""
        return {
            **self._asdict(),
            "wkt": [None if g is None else _geometry(g).asWkt(17) for g, _ in self.features],
        }

    @classmethod
    def load(cls, data):
        return cls(**{name: data[name] for name in cls._fields})._replace(
            fields=list(map(tuple, data["fields"]))
        )


# ---------------------------------------------------------------- strategies

FIELD_NAMES = [
    "part", "parts", "status", "cost", "gap", "tau", "fid", "id", "ID", "Fid", "geom", "geometry",
    "ogc_fid", "rowid", "select", "from", "order", "where", "group", "table", "index", "null", "name",
    "Name", "NAME", "x" * 300, "名前", "имя", "grün", "a b", "a.b", 'a"b', "a'b", "a,b", "a\\b", "%s",
    "source", "length", "detour", "0", "-", "é" * 12, "part_2", "@length", "$geometry",
]  # fmt: skip
FIELD_KINDS = ["String", "Int", "LongLong", "Double", "Date", "DateTime", "StringList", "Bool"]
VALUES = {
    "String": [None, "", "x", "ß" * 300, "x" * 5000, "NULL", "'; drop table x; --", "a\nb", "\u0000"],
    "Int": [None, 0, -1, 2**31 - 1, 1 - 2**31],
    "LongLong": [None, 0, 2**53 + 1, -(2**62)],
    "Double": [None, 0.0, -0.0, 0.1, 1e300, 5e-324, math.nan, math.inf],
    "Date": [None, "2024-02-29", "0001-01-01"],
    "DateTime": [None, "2024-02-29T23:59:59", "1900-01-01T00:00:00"],
    "StringList": [None, [], ["a", "b,c"]],
    "Bool": [None, True, False],
}
CURVES = [
    "CURVEPOLYGON(COMPOUNDCURVE(CIRCULARSTRING(0 0,5 5,10 0),(10 0,0 0)))",
    "CURVEPOLYGON(CIRCULARSTRING(0 0,5 5,10 0,5 -5,0 0))",
    "CURVEPOLYGON((0 0,20 0,20 20,0 20,0 0),CIRCULARSTRING(5 5,7 7,9 5,7 3,5 5))",
    "CURVEPOLYGON(COMPOUNDCURVE((0 0,10 0,10 4.5),CIRCULARSTRING(10 4.5,11 4.9,12 4.5),(12 4.5,12 0,"
    "22 0,22 10,12 10,12 5.5,10 5.5,10 10,0 10,0 0)))",
    "CURVEPOLYGON(CIRCULARSTRING(0 0,1e-9 1,0 0))",
    "CURVEPOLYGON(CIRCULARSTRING(0 0,5 5,nan 0,5 -5,0 0))",
    "MULTISURFACE(CURVEPOLYGON(CIRCULARSTRING(0 0,5 5,10 0,5 -5,0 0)),((20 0,30 0,30 9,20 0)))",
    "CURVEPOLYGON EMPTY",
]
TAUS = [1.0, 1.0 + 1e-12, 1.001, 1.2, 1.5, 2.0, 3.0, 4.0, 10.0, 100.0, 1e18]
BAD_TAUS = [0.99, -5.0, 1e300, math.nan, math.inf]
# data-defined: the expression, and what it is for the feature with an id; None where it is no number
BY_FEATURE = {
    "1 + $id": lambda k: 1.0 + k,
    "if($id % 3 = 0, NULL, 2)": lambda k: None if k % 3 == 0 else 2.0,
    "if($id % 2 = 0, 'x', 3)": lambda k: None if k % 2 == 0 else 3.0,
    "if($id % 2 = 0, -1, 1.5)": lambda k: -1.0 if k % 2 == 0 else 1.5,
    "1/0": lambda k: None,
    "no_such_function($id)": lambda k: None,
}
# for MinWeight: the weight of a candidate of this length, detour, and straight length in the plane
WEIGHTS = {
    "1": lambda length, detour, plane: 1.0,
    "0": lambda length, detour, plane: 0.0,
    "@length": lambda length, detour, plane: length,
    "@length / coalesce(@detour, 1)": lambda length, detour, plane: length / (detour or 1.0),
    "length($geometry)": lambda length, detour, plane: plane,
    "1 / @detour": lambda length, detour, plane: 1.0 / detour if detour else None,
    "-@length": lambda length, detour, plane: -length,
    "'heavy'": lambda length, detour, plane: None,
    "NULL": lambda length, detour, plane: None,
    "sqrt(-1)": lambda length, detour, plane: None,
}
BAD_WEIGHTS = ["", "   ", '"no such field"', "1 +", "no_such_function()"]
CRS = ["EPSG:3857", "EPSG:3857", "EPSG:25832", "EPSG:4326", "EPSG:4326", "", "EPSG:4269", "EPSG:4978"]

ODD_LINES = [
    None, "LINESTRING EMPTY", "LINESTRING(nan 0,1 1)", "LINESTRING(1 1,1 1)", "LINESTRING(0 0,inf 1)",
    "MULTILINESTRING((0 0,10 10),(2 2,3 3))", "COMPOUNDCURVE(CIRCULARSTRING(0 0,1 1,2 0))",
    "MULTILINESTRING EMPTY", "LINESTRING Z(0 0 1,10 10 nan)",
]  # fmt: skip

usually = st.integers(0, 9)


@st.composite
def recipes(draw, kinds):
    """A geometry as WKB in hex, curve as WKT, or None."""
    kind = draw(st.sampled_from(kinds))
    if kind == "null":
        return None
    if kind == "curve":
        return draw(st.sampled_from(CURVES))
    mutations = draw(st.sampled_from(SOME_MUTATIONS))
    place = draw(st.sampled_from(SOME_PLACES))
    ordinates = draw(st.sampled_from(SOME_ORDINATES))
    seed = draw(st.integers(0, 2**32 - 1))
    return hostile.geometry(kind, seed, place, mutations, ordinates, seed % 3 == 0).hex()


def _some(share, names, rng):
    """Lists of names, short ones and mostly none."""
    count = lambda: 0 if rng.random() > share else int(rng.integers(1, 4))  # noqa: E731
    return [tuple(rng.choice(names, count()).tolist()) for _ in range(400)]


_rng = np.random.default_rng(20160927)
SOME_MUTATIONS = _some(0.4, list(hostile.MUTATIONS), _rng)
SOME_PLACES = ["as it is"] * 10 + list(hostile.PLACES)
SOME_ORDINATES = [""] * 6 + ["Z", "M", "ZM"]
KINDS = list(hostile.KINDS) * 2 + ["small_tour", "lattice_tour"] * 4 + ["null", "curve"]
SMALL_KINDS = [
    "small_tour",
    "lattice_tour",
    "by_hand",
    "triangle_or_square",
    "star",
    "nested",
    "many",
    "null",
    "lattice_mosaic",
]


@st.composite
def cases(draw, largest=80, sinks=("memory",) * 6 + ("gpkg", "shp", "geojson"), cancels=True):
    """A whole case."""
    rare = draw(st.integers(0, 99))
    tool = draw(
        st.sampled_from(["partition"] * 7 + ["partitionbudget"] * 2 + ["tradeoff", "hierarchy", "hierarchy"])
    )
    parameters = draw(_parameters(tool))
    fields = draw(_fields()) if rare < 30 else [("name", "String")]
    dear = tool == "tradeoff" or parameters.get("OBJECTIVE", "MinSize") != "MinSize"
    with_lines = draw(usually) == 0 and tool != "hierarchy"
    kinds = SMALL_KINDS if with_lines or (dear and draw(usually) < 7) else KINDS
    count = draw(st.integers(0 if rare == 99 else 1, largest // 3 if dear else largest))
    features = [
        (draw(recipes(kinds)), [_value(kind, number + rare) for _, kind in fields]) for number in range(count)
    ]
    source = draw(st.sampled_from(sinks))
    case = Case(
        tool=tool,
        parameters=parameters,
        wkb_type=draw(
            st.sampled_from(
                ["Polygon"] * 3 + ["MultiPolygon", "PolygonZ", "MultiPolygonZM", "CurvePolygon", "PolygonM"]
            )
        ),
        crs=draw(st.sampled_from(CRS)),
        fields=fields,
        features=features,
        source=source,
        sink=draw(st.sampled_from(sinks)),
        diagonals=tool not in ("tradeoff", "hierarchy") and draw(usually) > 0,
        twin=draw(usually) < 2 and source == "memory" and tool != "hierarchy",
    )
    if with_lines:
        case = case._replace(lines=_lines(case, draw(st.integers(0, 2**32 - 1))))
    if cancels and draw(st.integers(0, 15)) == 0:
        case = case._replace(cancel=draw(st.integers(1, 40 * max(1, count))), twin=False)
        case = case._replace(sink=draw(st.sampled_from(["memory", "gpkg", "gpkg", "shp", "geojson"])))
    elif cancels and case.sink != "memory" and draw(st.integers(0, 4)) == 0:
        case = case._replace(room=draw(st.integers(0, 8)) ** 2 * 8192, twin=False)
    elif cancels and rare == 98:
        case = case._replace(sink="nowhere", twin=False)
    return case


@st.composite
def _parameters(draw, tool):
    rare = draw(st.integers(0, 59))
    p = {}
    dynamic = st.sampled_from([{"expression": text} for text in BY_FEATURE])
    if tool == "partition":
        p["TAU"] = draw(dynamic if draw(usually) == 0 else st.sampled_from(TAUS))
        p["MAX_GAP"] = draw(st.sampled_from([0.1, 0.0, 5.0]))
        if rare == 0:
            p["TAU"] = draw(st.sampled_from(BAD_TAUS))
    elif tool == "partitionbudget":
        budgets = st.sampled_from([0.0, 1.0, 2.0, 3.0, 2.5, 10.0, 1e6, 1e18, 1e-300])
        p["BUDGET"] = draw(dynamic if draw(usually) == 0 else budgets)
        if rare == 0:
            p["BUDGET"] = draw(st.sampled_from([-1.0, math.nan, math.inf]))
    elif tool == "hierarchy":
        p["TAU"] = draw(dynamic if draw(usually) == 0 else st.sampled_from([1.0, 1.2, 1.5, 2.0, 4.0]))
        if draw(usually) < 3:
            p["PARTS"] = draw(st.sampled_from([1, 2, 3, 50]))
        if rare == 0:
            p["TAU"] = draw(st.sampled_from(BAD_TAUS))
    else:
        p["TAU_MIN"] = draw(st.sampled_from([1.0, 1.5, 4.0, 20.0]))
        p["TAU_MAX"] = draw(st.sampled_from([0.0, 0.0, 20.0, 1e300]))
        p["STEPS"] = draw(st.sampled_from([1, 2, 5, 50]))
        if rare == 0:
            p["TAU_MAX"] = draw(st.sampled_from([1.0, 0.5, math.nan]))
    # what is proven is proven for the paper's problem: natural places only choose other candidates
    p["PLACES"] = draw(st.sampled_from(["Any"] * 3 + ["Natural"]))
    p["SMALLEST_PART"] = draw(st.sampled_from([0.0] * 5 + [1.0, 20.0, 100.0]))
    p["NEW_VERTICES"] = draw(st.sampled_from([False, False, True]))
    p["OBJECTIVE"] = (
        "MinSize"
        if tool == "hierarchy"
        else draw(st.sampled_from(["MinSize"] * 5 + ["MinLength", "MinWeight"]))
    )
    if p["OBJECTIVE"] == "MinWeight":
        p["WEIGHT"] = draw(st.sampled_from(list(WEIGHTS)))
        if draw(usually) == 0:
            p["WEIGHT"] = draw(st.sampled_from(BAD_WEIGHTS))
    p["MIN_LENGTH"] = draw(st.sampled_from([0.0] * 8 + [1e-300, 3.0, 1e5, 1e300]))
    p["MIN_HOLE"] = draw(st.sampled_from([0.0] * 8 + [1e-300, 2.0, 1e10, 1e18]))
    if rare == 1:
        p[draw(st.sampled_from(["MIN_LENGTH", "MIN_HOLE"]))] = draw(st.sampled_from([-1.0, math.nan]))
    if rare == 2:
        p["MIN_HOLE"] = 1e300
    return p


@st.composite
def _fields(draw):
    names = draw(st.lists(st.sampled_from(FIELD_NAMES), max_size=8, unique=True))
    kinds = draw(st.lists(st.sampled_from(FIELD_KINDS), min_size=len(names), max_size=len(names)))
    return list(zip(names, kinds))


def _value(kind, number):
    values = VALUES[kind]
    return values[number % len(values)]


def _lines(case, seed):
    """Candidate lines: between vertices, and some that lie badly."""
    rng = np.random.default_rng(seed)
    lines = []
    for text, _ in case.features:
        if text is None or not _is_hex(text):
            continue
        for polygon in hostile.read_wkb(bytes.fromhex(text)):
            xy = [ring[:-1, :2] for ring in polygon if len(ring)]
            if not xy:
                continue
            xy = np.concatenate(xy)
            n = len(xy)
            for _ in range(int(rng.integers(0, 2 * n + 1))):
                points = xy[rng.integers(0, n, 2 if rng.random() < 0.95 else 3)]
                if rng.random() < 0.05:
                    points = points + rng.normal(size=points.shape)
                lines.append(points)
                if rng.random() < 0.1:
                    lines.append(points[::-1])
    lines = [_line_wkb(points).hex() for points in lines[:3000]]
    lines[len(lines) // 2 : 0] = rng.choice(ODD_LINES, 2).tolist()
    return lines


def _line_wkb(points):
    import struct

    data = np.ascontiguousarray(points, dtype="<f8")
    return struct.pack("<BII", 1, 2, len(data)) + data.tobytes()


def _is_hex(text):
    return text[:2] == "01"


def _geometry(text):
    if not _is_hex(text):
        return QgsGeometry.fromWkt(text)
    geometry = QgsGeometry()
    geometry.fromWkb(bytes.fromhex(text))
    return geometry


# ---------------------------------------------------------------- layers


def _variant(kind, value):
    if value is None:
        return NULL
    if kind == "Date":
        return QDate.fromString(value, "yyyy-MM-dd")
    if kind == "DateTime":
        return QDateTime.fromString(value, "yyyy-MM-ddTHH:mm:ss")
    return value


def make_layer(name, wkb_type, crs, fields, rows):
    """A memory layer of (geometry text, values)."""
    definition = QgsFields()
    for field, kind in fields:
        definition.append(QgsField(field, getattr(QVariant, kind)))
    system = QgsCoordinateReferenceSystem(crs) if crs else QgsCoordinateReferenceSystem()
    layer = QgsMemoryProviderUtils.createMemoryLayer(
        name, definition, QgsWkbTypes.parseType(wkb_type), system
    )
    assert layer.isValid()
    features = []
    for text, values in rows:
        feature = QgsFeature(layer.fields())
        if len(values) == len(layer.fields()):
            feature.setAttributes([_variant(kind, v) for (_, kind), v in zip(fields, values)])
        if text is not None:
            feature.setGeometry(_geometry(text))
        features.append(feature)
    ok, _ = layer.dataProvider().addFeatures(features, QgsFeatureSink.Flag.FastInsert)
    assert ok, layer.dataProvider().lastError()
    return layer


def as_file(layer, driver, folder):
    """The layer written to a file and read again: whatever survives is the input. None: nothing."""
    path = str(Path(folder) / f"in.{driver}")
    options = QgsVectorFileWriter.SaveVectorOptions()
    options.driverName = DRIVERS[driver]
    if driver == "geojson":
        options.layerOptions = ["COORDINATE_PRECISION=17"]
    QgsVectorFileWriter.writeAsVectorFormatV3(layer, path, QgsProject.instance().transformContext(), options)
    result = QgsVectorLayer(path, "in", "ogr")
    return result if result.isValid() and result.geometryType() == POLYGONS else None


# ---------------------------------------------------------------- running


PATIENCE = 60.0  # seconds for a case; most take less than one


class Feedback(QgsProcessingFeedback):
    """Keeps what a tool says, and cancels at a call, or when it takes far too long."""

    def __init__(self, cancel=None):
        super().__init__(False)
        self.warnings, self.infos, self.errors = [], [], []
        self.left, self.calls = cancel, 0
        self.end, self.late = time.monotonic() + PATIENCE, False

    def _count(self):
        self.calls += 1
        if self.left is not None and self.calls >= self.left:
            self.cancel()
        if time.monotonic() > self.end:
            self.late = True
            self.cancel()

    def isCanceled(self):
        self._count()
        return super().isCanceled()

    def setProgress(self, progress):
        self._count()
        assert 0.0 <= progress <= 100.0 + 1e-9, progress
        super().setProgress(progress)

    def pushWarning(self, text):
        self.warnings.append(text)

    def pushInfo(self, text):
        self.infos.append(text)

    def reportError(self, text, fatalError=False):
        self.errors.append(text)


class Outcome(NamedTuple):
    """What a run left.

    Attributes
    ----------
    case : Case
    source : QgsVectorLayer
    results : dict or None
    layers : dict
        The output layers by name, opened.
    feedback : Feedback
    error : str or None
        What was said, if the run failed.
    raised : list
        Exceptions as the tool itself raised them: QGIS makes one kind of all.
    warnings : list of str
        Of Python and numpy.
    folder : Path
    """

    case: Case
    source: object
    results: dict
    layers: dict
    feedback: Feedback
    error: str
    raised: list
    warnings: list
    folder: Path


_raised = []


def watch(tools):
    """Keep the exceptions of tools as they were raised."""
    from isthmus.algorithms.base import _without_frames

    for tool in tools:
        for name in ("processAlgorithm", "checkParameterValues", "prepareAlgorithm"):
            original = getattr(tool, name, None)
            if original is None or getattr(original, "watched", False):
                continue

            def watched(self, *arguments, original=original):
                try:
                    return original(self, *arguments)
                except BaseException as error:
                    _raised.append(error)
                    raise

            watched.watched = True
            # QGIS keeps what processAlgorithm raises: nothing of this frame may go with it
            setattr(tool, name, _without_frames(watched) if name == "processAlgorithm" else watched)


def parameters_of(case, source, lines, folder):
    """The parameters as Processing takes them."""
    p = {
        name: QgsProperty.fromExpression(value["expression"]) if isinstance(value, dict) else value
        for name, value in case.parameters.items()
    }
    p = {"PLACES": "Any", "SMALLEST_PART": 0, **p, "INPUT": source}
    if case.tool == "hierarchy":
        del p["OBJECTIVE"]
    if lines is not None:
        p["CANDIDATES"] = lines
    names = ["OUTPUT"]
    if case.tool == "tradeoff":
        p["REPORT"] = str(Path(folder) / "report.html")
    else:
        names += ["CUTS"] + ["DIAGONALS"] * case.diagonals
    table = case.tool == "tradeoff" and case.sink in ("shp", "geojson")
    for name in names:
        ending = "csv" if table else case.sink
        p[name] = "memory:" if case.sink == "memory" else str(Path(folder) / f"{name}.{ending}")
        if case.sink == "nowhere":
            p[name] = f"/proc/nowhere/{name}.gpkg"
    return p, names


def run(case, **changed):
    """Run a case; returns its Outcome, or None where the layer cannot be made in its format."""
    import processing

    case = case._replace(**changed)
    folder = Path(tempfile.mkdtemp(prefix="isthmus-fuzz-"))
    source = make_layer("fuzz", case.wkb_type, case.crs, case.fields, case.features)
    if case.source != "memory":
        source = as_file(source, case.source, folder)
        if source is None:
            shutil.rmtree(folder)
            return None
    lines = None
    if case.lines is not None:
        rows = [(line, []) for line in case.lines]
        lines = make_layer("lines", "LineString", case.crs, [], rows)
    context = QgsProcessingContext()
    context.setProject(QgsProject.instance())
    feedback = Feedback(case.cancel)
    parameters, names = parameters_of(case, source, lines, folder)
    results, error = None, None
    _raised.clear()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            with small_files(case.room):
                results = processing.run(
                    f"isthmus:{case.tool}", parameters, feedback=feedback, context=context
                )
        except QgsProcessingException as problem:
            error = "\n".join([*feedback.errors, str(problem)])
    layers = {}
    for name in names if results else ():
        layer = results.get(name)
        if isinstance(layer, str):
            layer = QgsVectorLayer(layer, name, "ogr")
        layers[name] = layer
    said = [
        f"{w.category.__name__}: {w.message} ({Path(w.filename).name}:{w.lineno})"
        for w in caught
        if issubclass(w.category, (RuntimeWarning, UserWarning))
    ]
    feedback.context = context  # owns the layers
    return Outcome(case, source, results, layers, feedback, error, list(_raised), said, folder)


def clean(outcome):
    """Remove what a run left on disk."""
    outcome.layers.clear()
    shutil.rmtree(outcome.folder, ignore_errors=True)
