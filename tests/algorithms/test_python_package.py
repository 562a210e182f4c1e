"""The functions of the Python package give what the tools give, feature by feature and bit by bit."""

import math
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
import shapely
from qgis.core import NULL, QgsFeature, QgsGeometry, QgsProperty, QgsVectorLayer

sys.path.append(str(Path(__file__).resolve().parents[1] / "fuzz"))

import hostile  # noqa: E402

pytestmark = pytest.mark.filterwarnings("ignore::UserWarning")
CASES = [
    (kind, seed, place, ordinates, multi)
    for place in ("as it is", "in degrees")
    for ordinates in ("", "Z")
    for seed, kind in enumerate(sorted(hostile.KINDS), 1)
    if seed % 7  # these rings close with another Z: a tool gives such a point back twice
    for multi in (False, True)
]


def polygons(place, ordinates):
    """Hostile geometries that shapely can hold, some None and empty among them, and what is no polygon."""
    made = [None, shapely.Polygon()]
    for k, (kind, seed, own_place, own_ordinates, multi) in enumerate(CASES):
        if (own_place, own_ordinates) == (place, ordinates):
            mutations = ((), ("vertex_on_edge",), ("touches_itself",), ("minus_zero",))[k % 4]
            data = hostile.geometry(kind, seed, place, mutations, ordinates, multi)
            made.append(shapely.from_wkb(data, on_invalid="ignore"))
    return np.array(made, dtype=object)


@pytest.fixture
def tools(run):
    """Run a tool: ``tools(name, parameters)`` to its results."""
    return lambda name, *arguments: run(f"isthmus:{name}", *arguments)


def layer_of(geometries, crs, fields=(), kind="MultiPolygon"):
    """A memory layer; fields are (definition, values)."""
    uri = f"{kind}?crs={crs}" + "".join(f"&field={definition}" for definition, _ in fields)
    layer = QgsVectorLayer(uri, "layer", "memory")
    assert layer.isValid()
    features = []
    for k, one in enumerate(geometries):
        feature = QgsFeature(layer.fields())
        feature.setAttributes([NULL if values[k] is None else values[k] for _, values in fields])
        if one is not None:
            geometry = QgsGeometry()
            geometry.fromWkb(shapely.to_wkb(one, flavor="iso"))
            feature.setGeometry(geometry)
        features.append(feature)
    assert layer.dataProvider().addFeatures(features)[0]
    return layer


def plain(geometry):
    """WKB of the simple parts of a geometry, whether or not it is wrapped as a multi one."""
    if isinstance(geometry, QgsGeometry):
        geometry = (
            None if geometry.isNull() else shapely.from_wkb(bytes(geometry.asWkb()), on_invalid="ignore")
        )
    parts = shapely.get_parts(np.array([geometry], dtype=object))
    return [shapely.to_wkb(one, flavor="iso") for one in parts if not one.is_empty]


def none(value):
    """A value as the package would have it."""
    if value is None or value == NULL:
        return math.nan
    return value


def assert_same(layer, geometries, fields, ids=("source",), names=None):
    """A result of a tool, and one of the package; ids count from 1 in memory layers."""
    found = list(layer.getFeatures())
    assert len(found) == len(next(iter(fields.values())) if geometries is None else geometries)
    for name, values in fields.items():
        name = (names or {}).get(name, name)
        theirs = [none(feature[name]) for feature in found]
        if name in ids:
            theirs = [value - 1 for value in theirs]
        ours = [none(value) for value in values.tolist()]
        for a, b in zip(theirs, ours):
            assert a == b or a != a and b != b, (name, a, b)
    if geometries is not None:
        for feature, one in zip(found, geometries):
            assert plain(feature.geometry()) == plain(one)


def new_points(parts, geometries):
    """How many places with a vertex of a part had none before."""
    after, before = (set(map(tuple, shapely.get_coordinates(one).tolist())) for one in (parts, geometries))
    return len(after - before)


KIND = {"": "MultiPolygon", "Z": "MultiPolygonZ"}
CRS = {"as it is": "EPSG:3035", "in degrees": "EPSG:4326"}


@pytest.mark.parametrize("place", CRS)
@pytest.mark.parametrize("ordinates, options", [
    ("", {}),
    ("Z", {"TAU": 2, "PLACES": "Any", "SMALLEST_PART": 0, "OBJECTIVE": "MinLength", "MAX_GAP": 1}),
    ("Z", {"TAU": 2.5, "NEW_VERTICES": True}),
    ("", {"TAU": 2.5, "SMALLEST_PART": 0.2, "MIN_LENGTH": 0.01, "MIN_HOLE": 0.02}),
])  # fmt: skip
def test_partition(tools, package, place, ordinates, options):
    geometries = polygons(place, ordinates)
    layer = layer_of(geometries, CRS[place], kind=KIND[ordinates])
    theirs = tools("partition", {
        "INPUT": layer, **options, "OUTPUT": "memory:", "CUTS": "memory:", "DIAGONALS": "memory:"
    })  # fmt: skip
    own = {name.lower(): value for name, value in options.items()}
    ours = package.partition(geometries, diagonals=True, crs=CRS[place], **own)
    assert len(ours.cuts) > 30 and (ours.part_fields["status"] != "").sum() > 5
    assert_same(theirs["OUTPUT"], ours.parts, ours.part_fields)
    assert_same(theirs["CUTS"], ours.cuts, ours.cut_fields)
    assert_same(theirs["DIAGONALS"], ours.diagonals, ours.diagonal_fields)


def test_partition_with_numbers_of_each_feature_and_weights(tools, package):
    geometries = polygons("as it is", "Z")
    tau = [1.0 + k % 5 for k in range(len(geometries))]
    tau[5], tau[9] = 0.5, math.nan
    part = [float(k % 3) for k in range(len(geometries))]
    layer = layer_of(geometries, "EPSG:3035", [("t:double", tau), ("s:double", part)], KIND["Z"])
    theirs = tools("partition", {
        "INPUT": layer, "TAU": QgsProperty.fromField("t"), "SMALLEST_PART": QgsProperty.fromField("s"),
        "OBJECTIVE": "MinWeight", "WEIGHT": 'if("t" = 3, -1, if(@detour is null, 2, 10 * @length / @detour))',
        "OUTPUT": "memory:", "CUTS": "memory:",
    })  # fmt: skip

    def weight(candidates):
        own = np.where(np.isinf(candidates.detour), 2.0, 10 * candidates.length / candidates.detour)
        return np.where(np.array(tau)[candidates.source.astype(int)] == 3.0, -1.0, own)

    ours = package.partition(geometries, tau=tau, smallest_part=part, objective="MinWeight", weight=weight)
    reasons = ours.part_fields.pop("status")
    assert (
        sum("weight" in reason for reason in reasons) > 2 and sum("tau" in reason for reason in reasons) > 0
    )
    assert_same(theirs["OUTPUT"], ours.parts, ours.part_fields)
    assert_same(theirs["CUTS"], ours.cuts, ours.cut_fields)
    for feature, reason in zip(theirs["OUTPUT"].getFeatures(), reasons):
        assert feature["status"].split(" of candidate")[0] == reason.split(" of candidate")[0]


def test_partition_by_given_lines(tools, package, feedback):
    geometries = polygons("as it is", "")
    some = package.partition(geometries, tau=1.5, places="Any", smallest_part=0).cuts[::2]
    bent = shapely.LineString([(0, 0), (1, 1), (2, 0)])
    lines = np.append(some, [bent, shapely.LineString([(-7, -7), (-8, -9)])])
    options = {"tau": 2, "objective": "MinLength"}
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        ours = package.partition(geometries, candidates=lines, **options)
    theirs = tools("partition", {
        "INPUT": layer_of(geometries, "EPSG:3035"), "CANDIDATES": layer_of(lines, "EPSG:3035", kind="LineString"),
        "TAU": 2, "OBJECTIVE": "MinLength", "OUTPUT": "memory:", "CUTS": "memory:",
    }, feedback)  # fmt: skip
    assert len(ours.cuts) > 10
    left = [one for one in feedback.warnings if one.startswith("Candidate line")]
    assert any(f"{len(left)} candidate lines were left out" in str(one.message) for one in told)
    assert_same(theirs["OUTPUT"], ours.parts, ours.part_fields)
    assert_same(theirs["CUTS"], ours.cuts, ours.cut_fields)


@pytest.mark.parametrize("place", CRS)
def test_partition_within(tools, package, place):
    geometries = polygons(place, "")
    budget = [k % 4 for k in range(len(geometries))]
    layer = layer_of(geometries, CRS[place], [("b:integer", budget)])
    theirs = tools("partitionbudget", {
        "INPUT": layer, "BUDGET": QgsProperty.fromField("b"), "OUTPUT": "memory:", "CUTS": "memory:"
    })  # fmt: skip
    ours = package.partition_within(geometries, budget=budget, crs=CRS[place])
    assert any("budget" in reason for reason in ours.part_fields["status"])
    assert_same(theirs["OUTPUT"], ours.parts, ours.part_fields)
    assert_same(theirs["CUTS"], ours.cuts, ours.cut_fields)


@pytest.mark.parametrize("place", CRS)
def test_tradeoff(tools, package, place):
    geometries = polygons(place, "")
    theirs = tools("tradeoff", {
        "INPUT": layer_of(geometries, CRS[place]), "TAU_MIN": 1.5, "STEPS": 6, "PLACES": "Any", "OUTPUT": "memory:"
    })  # fmt: skip
    ours = package.tradeoff(geometries, tau_min=1.5, steps=6, places="Any", crs=CRS[place])
    assert len(ours["tau"]) > 80
    assert_same(theirs["OUTPUT"], None, ours)


@pytest.mark.parametrize("place", CRS)
@pytest.mark.parametrize("parts", [None, 3])
def test_hierarchy(tools, package, place, parts):
    geometries = polygons(place, "Z")
    theirs = tools("hierarchy", {
        "INPUT": layer_of(geometries, CRS[place], kind=KIND["Z"]), "PARTS": parts, "SMALLEST_PART": 0.1,
        "NEW_VERTICES": parts is None,
        "OUTPUT": "memory:", "CUTS": "memory:",
    })  # fmt: skip
    ours = package.hierarchy(
        geometries, parts=parts, smallest_part=0.1, new_vertices=parts is None, crs=CRS[place]
    )
    assert len(ours.cuts) > 20
    assert_same(theirs["OUTPUT"], ours.parts, ours.part_fields)
    assert_same(theirs["CUTS"], ours.cuts, ours.cut_fields)


def land(seed=3, count=60, size=3000.0):
    """A map that fills a square: cells around random points, some joined to long areas."""
    rng = np.random.default_rng(seed)
    points = shapely.multipoints(rng.random((count, 2)) * size)
    frame = shapely.box(0, 0, size, size)
    cells = np.array([one for one in shapely.get_parts(shapely.voronoi_polygons(points, extend_to=frame))])
    cells = shapely.intersection(shapely.set_precision(cells, 0.5), frame)
    group = rng.integers(0, count // 2, len(cells))
    whole = [shapely.union_all(cells[group == g]) for g in np.unique(group)]
    areas = np.array(whole + [None], dtype=object)
    classes = [str(rng.choice(["311", "312", "231"])) for _ in areas]
    classes[4] = None
    return areas, classes


@pytest.mark.parametrize("crs", ["EPSG:3035", "EPSG:4326"])
def test_aggregation(tools, package, crs):
    areas, classes = land()
    if crs == "EPSG:4326":
        areas = shapely.transform(areas, lambda xy: xy / 60_000 + (8.0, 50.0))
    layer = layer_of(areas, crs, [("class:string", classes)])
    theirs = tools("prepareaggregation", {
        "INPUT": layer, "CLASS": "class", "TAU": 2.5, "NEW_VERTICES": crs == "EPSG:3035", "OUTPUT": "memory:",
        "ADJACENCY": "memory:",
    })  # fmt: skip
    ours = package.prepare_aggregation(
        areas, class_=classes, tau=2.5, new_vertices=crs == "EPSG:3035", crs=crs
    )
    assert len(ours.pieces) > len(areas)
    assert_same(theirs["OUTPUT"], ours.pieces, ours.piece_fields, ids=("area_id",))
    assert_same(theirs["ADJACENCY"], None, ours.neighbours, ids=())

    pieces, of = theirs["OUTPUT"], ours.piece_fields["area_id"]
    own_classes = [classes[k] for k in of]
    for method, more in (
        ("greedy", {"DISTANCE": "code", "REGIONS": 5}),
        ("annealing", {"ITERATIONS": 3000, "SEED": 4}),
        ("greedy", {"EXCLUDED": "312", "WEIGHTS": "compact", "BOUNDARY": "classes", "WEIGHT_CHANGE": 2.0}),
    ):
        there = tools("aggregate", {
            "INPUT": pieces, "CLASS": "class", "METHOD": method, **more, "OUTPUT": "memory:",
            "ASSIGNMENT": "memory:",
        })  # fmt: skip
        options = {name.lower(): value for name, value in more.items()}
        if "excluded" in options:
            options["excluded"] = [options["excluded"]]
        here = package.aggregate(
            ours.pieces, class_=own_classes, method=method, area_id=of.tolist(), crs=crs, **options
        )
        assert here.costs.total == there["TOTAL_COST"]
        assert sum(gone for gone, _ in here.lost.values()) == there["LOST_COUNT"]
        assert_same(there["OUTPUT"], here.regions, here.region_fields, ids=("core",))
        # the pieces have a status of their own
        assert_same(
            there["ASSIGNMENT"], here.assignment, here.assignment_fields, names={"status": "status_2"}
        )


def floors(count=5, angle=0.3):
    """Floors of a tower, whose ceilings have teeth that almost meet the walls below; the walls lack vertices."""
    rng = np.random.default_rng(7)
    walls = []
    for k in range(count + 1):
        wall = [(0.0, 10.0 * k)]
        for x in np.cumsum(rng.uniform(8, 14, 4 if 0 < k < count else 0)):
            wall += [(x - 1, 10.0 * k), (x, 10.0 * k - rng.uniform(8.5, 9.5)), (x + 1, 10.0 * k)]
        walls.append(wall + [(60.0, 10.0 * k)])
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    areas = [shapely.Polygon(317.0 * np.array(a + b[::-1]) @ turn) for a, b in zip(walls, walls[1:])]
    return np.array(areas + [None], dtype=object), list("abcab") + [None]


@pytest.mark.parametrize("crs, ordinates", [("EPSG:3035", ""), ("EPSG:3035", "Z"), ("EPSG:4326", "")])
def test_aggregation_with_new_vertices(tools, package, crs, ordinates):
    areas, classes = floors()
    if ordinates:
        areas = shapely.transform(
            shapely.force_3d(areas), lambda xyz: xyz + xyz[:, [2, 2, 0]] * (0, 0, 0.5), include_z=True
        )
    if crs == "EPSG:4326":
        areas = shapely.transform(areas, lambda xy: xy / 60_000 + (8.0, 50.0), include_z=bool(ordinates))
    theirs = tools("prepareaggregation", {
        "INPUT": layer_of(areas, crs, [("class:string", classes)], KIND[ordinates]), "CLASS": "class", "TAU": 2.5,
        "NEW_VERTICES": True, "OUTPUT": "memory:", "ADJACENCY": "memory:",
    })  # fmt: skip
    ours = package.prepare_aggregation(areas, class_=classes, tau=2.5, new_vertices=True, crs=crs)
    assert new_points(ours.pieces, areas) > 5
    assert_same(theirs["OUTPUT"], ours.pieces, ours.piece_fields, ids=("area_id",))
    assert_same(theirs["ADJACENCY"], None, ours.neighbours, ids=())


@pytest.mark.parametrize("crs, options", [
    ("EPSG:3035", {"scale": 1.5}), ("EPSG:3035", {"frame": False, "selection": "Greedy", "tau": 3}),
    ("EPSG:3035", {"scale": 1.5, "places": "Natural", "smallest_part": 1}),
    ("EPSG:4326", {"scale": 2, "growth": 20}),
])  # fmt: skip
def test_enlarge(tools, package, crs, options):
    pytest.importorskip("scipy")
    areas, _ = land(seed=5, count=30)
    areas = np.append(shapely.force_3d(areas[:-1], 7.0), areas[-1:])
    if crs == "EPSG:4326":
        areas = shapely.transform(areas, lambda xyz: xyz / (1000, 1000, 1) + (8, 50, 0), include_z=True)
    bounds = shapely.total_bounds(areas)
    middle = (bounds[:2] + bounds[2:]) / 2
    focus = shapely.Point(middle).buffer((bounds[2] - bounds[0]) / 8)
    roads = np.array(
        [shapely.LineString([bounds[:2], middle, bounds[2:]]), shapely.MultiPoint([middle, bounds[:2]])]
    )
    theirs = tools("focusmap", {
        "INPUT": layer_of(areas, crs, kind="MultiPolygonZ"), "FOCUS": layer_of([focus], crs),
        **{name.upper(): value for name, value in options.items()},
        "ALONG": [layer_of(roads[:1], crs, kind="LineString"), layer_of(roads[1:], crs, kind="MultiPoint")],
        "OUTPUT": "memory:", "EDGES_USED": "memory:",
    })  # fmt: skip
    ours = package.enlarge(areas, focus, along=[roads[:1], roads[1:]], crs=crs, **options)
    assert_same(theirs["OUTPUT"], ours.map, {})
    assert_same(theirs["EDGES_USED"], ours.edges, ours.edge_fields)
    assert theirs["MEDIAN_DISTORTION"] == ours.median_distortion
    for address, carried in zip(theirs["CARRIED_LAYERS"], ours.carried):
        assert_same(QgsVectorLayer(address, "carried", "ogr"), carried, {})
