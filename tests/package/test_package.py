"""The Python package without QGIS: kinds of input, what is refused, its examples, and its installation."""

import doctest
import importlib
import importlib.metadata
import importlib.util
import inspect
import re
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest
import shapely

ROOT = Path(__file__).resolve().parents[2]
# two squares of 100, a corridor of 6 between them
ROOMS = shapely.from_wkt(
    "POLYGON ((0 0, 10 0, 10 4, 13 4, 13 0, 23 0, 23 10, 13 10, 13 6, 10 6, 10 10, 0 10, 0 0))"
)
BOWTIE = shapely.from_wkt("POLYGON ((0 0, 10 10, 10 0, 0 10, 0 0))")
TWO = shapely.MultiPolygon([ROOMS, shapely.transform(ROOMS, lambda xy: xy + 100)])
MIXED = np.array([ROOMS, BOWTIE, None, shapely.Polygon(), TWO, shapely.Point(0, 0)], dtype=object)
STATUS = ["", "", "", "Self-intersection", "no geometry", "empty", "", "", "", "", "", "", "no polygon"]
SOURCE = [0, 0, 0, 1, 2, 3, 4, 4, 4, 4, 4, 4, 5]


@pytest.fixture
def quiet():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        yield


def areas(geometries):
    return [0.0 if one is None else one.area for one in geometries]


@pytest.mark.parametrize("module", ["_cutting", "_aggregation", "_focus"])
def test_examples(package, module):
    if module == "_focus":
        pytest.importorskip("scipy")
    failed, tried = doctest.testmod(importlib.import_module(f"{package.__name__}.{module}"))
    assert tried and not failed


def test_a_geometry_gives_one_of_parts_and_one_of_cuts(package):
    found = package.partition(ROOMS, smallest_part=0)
    assert found.parts.geom_type == found.cuts.geom_type == "GeometryCollection"
    assert areas(found.parts.geoms) == [100, 100, 6]
    assert [one.length for one in found.cuts.geoms] == [2, 2]
    assert shapely.union_all(found.parts.geoms).equals(ROOMS)
    whole = package.partition(ROOMS, tau=50)
    assert whole.parts.geoms[0] == ROOMS and whole.cuts.is_empty and whole.cut_fields["length"].shape == (0,)


def test_an_array_gives_arrays(package, quiet):
    for given in (MIXED, list(MIXED)):
        found = package.partition(given, smallest_part=0)
        assert areas(found.parts) == [100, 100, 6, 0, 0, 0, 100, 100, 100, 100, 6, 6, 0]
        assert found.part_fields["source"].tolist() == SOURCE
        assert found.part_fields["parts"].tolist() == [3] * 3 + [1] * 3 + [6] * 6 + [1]
        assert all(a in b and bool(a) == bool(b) for a, b in zip(STATUS, found.part_fields["status"]))
        assert found.parts[3] is BOWTIE and found.parts[12] is MIXED[5]
        assert found.cut_fields["source"].tolist() == [0, 0, 4, 4, 4, 4]
        assert np.isnan(found.part_fields["cost"]).tolist() == [bool(one) for one in STATUS]


def test_what_was_not_cut_is_told_once_where_the_user_called(package):
    with pytest.warns(UserWarning, match="4 of 6 features were not cut.* 1: invalid geometry") as told:
        package.partition(MIXED)
    assert len(told) == 1 and told[0].filename == __file__
    with pytest.warns(UserWarning, match="4 of 6 features have no curve") as told:
        package.tradeoff(MIXED)
    assert told[0].filename == __file__


def test_nothing_gives_nothing(package):
    for function in (package.partition, package.partition_within, package.hierarchy):
        found = function([])
        assert len(found.parts) == len(found.cuts) == 0
    assert len(package.tradeoff([])["tau"]) == 0
    assert len(package.prepare_aggregation([]).pieces) == 0


def test_z_and_m_stay(package):
    text = "POLYGON {} ((" + ", ".join(f"{x:g} {y:g}" + " {}" for x, y in ROOMS.exterior.coords) + "))"
    kinds = {"": "", "Z": "7", "M": "8", "ZM": "7 8"}
    made = [shapely.from_wkt(text.format(kind, *[more] * 13)) for kind, more in kinds.items()]
    for given in ([one] for one in made):
        self_same(package, given)
    self_same(package, made)


def self_same(package, given):
    """The ordinates of each polygon are those of its parts and cuts."""
    found = package.partition(given, smallest_part=0)
    for parts, source in (
        (found.parts, found.part_fields["source"]),
        (found.cuts, found.cut_fields["source"]),
    ):
        assert len(parts) >= 2 * len(given)
        for one, k in zip(parts, source):
            assert (one.has_z, one.has_m) == (given[k].has_z, given[k].has_m)
            theirs = shapely.get_coordinates(given[k], include_z=True, include_m=True)
            for row in shapely.get_coordinates(one, include_z=True, include_m=True):
                assert any(np.array_equal(row, other, equal_nan=True) for other in theirs)


def test_degrees_are_metres_on_the_ellipsoid(package):
    pyproj = pytest.importorskip("pyproj")
    far = shapely.transform(ROOMS, lambda xy: xy / 10 + (8, 60))
    plane, ground = (package.partition(far, smallest_part=0, crs=crs) for crs in (None, "EPSG:4326"))
    assert plane.cut_fields["length"].round(9).tolist() == [0.2, 0.2]
    ends = shapely.get_coordinates(ground.cuts.geoms[0]).T
    _, _, length = pyproj.Geod(ellps="WGS84").inv(ends[0, 0], ends[1, 0], ends[0, 1], ends[1, 1])
    assert ground.cut_fields["length"][0] == pytest.approx(length, rel=1e-4) != 0.2
    grads = package.partition(shapely.transform(far, lambda xy: xy / 0.9), smallest_part=0, crs="EPSG:4902")
    assert grads.cut_fields["length"][0] == pytest.approx(length, rel=1e-3)  # on another ellipsoid
    beyond = shapely.transform(ROOMS, lambda xy: xy + (0, 85))
    with pytest.warns(UserWarning, match="1 of 2 features are measured in the plane.*1: a latitude"):
        found = package.partition([far, beyond], smallest_part=0, crs="OGC:CRS84")
    assert found.cut_fields["length"][-2:].tolist() == [2, 2]


def test_what_a_focus_map_makes_invalid_is_told(package):
    """The long sides of the third are one where the border of the others crosses them."""
    pytest.importorskip("scipy")
    left = shapely.Polygon([(0, 0), (30, 0), (33, 100), (0, 100)])
    right = shapely.Polygon([(30, 0), (100, 0), (100, 100), (33, 100)])
    thin = shapely.box(10, 50, 90, 50 + 1e-9)
    with pytest.warns(UserWarning, match="1 of 3 features are no longer valid .*: 2: narrower"):
        found = package.enlarge([left, right, thin], shapely.box(40, 60, 60, 80), scale=2)
    assert shapely.is_valid(found.map).tolist() == [True, True, False]


def test_options_for_each_feature(package):
    tau = package.partition([ROOMS, ROOMS], tau=[3, 50], smallest_part=[0, 0])
    assert tau.part_fields["parts"].tolist() == [3, 3, 3, 1]
    with pytest.warns(UserWarning, match="1: tau must be a number of at least 1, and is 0.5"):
        package.partition([ROOMS, ROOMS], tau=[3, 0.5])


@pytest.mark.parametrize("options, error, message", [
    ({"tau": 0.5}, ValueError, "tau must be a number of at least 1, and is 0.5"),
    ({"tau": float("nan")}, ValueError, "tau must be"),
    ({"tau": [1, 2]}, ValueError, "tau must have a number for each of the 1 features"),
    ({"tau": "t"}, TypeError, "there is no table"),
    ({"objective": "minsize"}, ValueError, "objective must be MinSize, MinLength or MinWeight"),
    ({"places": "x"}, ValueError, "places must be Natural or Any"),
    ({"smallest_part": 101}, ValueError, "at most 100"),
    ({"min_hole": -1}, ValueError, "min_hole must be a number of at least 0"),
    ({"max_gap": -1}, ValueError, "max_gap"),
    ({"objective": "MinWeight"}, ValueError, "needs a function"),
    ({"objective": "MinWeight", "weight": lambda c: [1.0]}, ValueError, "a number for each of 9 candidates"),
    ({"crs": "EPSG:3035", "tau": 0}, ValueError, "tau"),
])  # fmt: skip
def test_what_cannot_be_used_is_said(package, options, error, message):
    options.setdefault("places", "Any")
    with pytest.raises(error, match=message):
        package.partition(ROOMS, smallest_part=options.pop("smallest_part", 0), **options)


@pytest.mark.parametrize("options, error, message", [
    ({"weight_boundary": "x"}, TypeError, "weight_boundary must be a number, and is 'x'"),
    ({"weight_centre": [1.0]}, TypeError, r"weight_centre must be a number, and is \[1.0\]"),
    ({"weight_change": float("nan")}, ValueError, "weight_change must be a number of at least 0, and is nan"),
    ({"threshold": -3}, ValueError, "threshold must be a number of at least 0, and is -3"),
    ({"seed": "x"}, TypeError, "seed must be a number"),
    ({"weights": "light"}, ValueError, "weights must be keep classes, balanced or compact"),
    ({"distance": "table"}, ValueError, "A table of class distances"),
    ({"regions": 1.5}, ValueError, "regions must be a whole number, and is 1.5"),
    ({"seed": 0.5}, ValueError, "seed must be a whole number, and is 0.5"),
    ({"distance": "table", "distances": [[0, 1], [1, 0]]}, TypeError, "distances must be a mapping of pairs"),
    ({"distance": "table", "distances": {"water": 1.0}}, TypeError, "distances must be a mapping of pairs"),
])  # fmt: skip
def test_what_an_aggregation_cannot_use_is_said(package, options, error, message):
    with pytest.raises(error, match=message):
        package.aggregate([ROOMS], class_=["a"], **options)


@pytest.mark.parametrize("distances", [{("a", "b"): 0.5}, {"a": 0.5}, []])
def test_distances_that_are_not_used_are_told(package, distances):
    with pytest.warns(UserWarning, match="distances are not used, since distance is 'equal'"):
        package.aggregate([ROOMS], class_=["a"], threshold=1, method="greedy", distances=distances)


def test_the_exact_method_says_that_it_does_not_count(package):
    pytest.importorskip("scipy", minversion="1.9")
    with pytest.warns(UserWarning, match="number of regions is not used"):
        package.aggregate([ROOMS], class_=["a"], threshold=1, method="exact", regions=3)


def test_new_vertices_only_where_they_are_allowed(package):
    """A tooth over a wall without a vertex: in a Z and an M of their own, and of neighbours of other kinds."""
    tooth = "(({0}0 0{1}, 20 0{2}, 20 10{2}, 11 10{1}, 10 1{1}, 9 10{1}, 0 10{1}, 0 0{1}))"
    flat = shapely.from_wkt("POLYGON " + tooth.format("", "", ""))
    high = shapely.from_wkt("POLYGON Z " + tooth.format("", " 4", " 8"))
    for function in (package.partition, package.hierarchy, package.partition_within):
        assert not any((10, 0) in one.exterior.coords for one in function(flat).parts.geoms)
        found = function([flat, high], new_vertices=True)
        assert 1.0 in found.cut_fields["length"].round(9)
        points = {point for one in found.parts for point in one.exterior.coords}
        assert {(10, 0), (10, 0, 6)} <= points
    steps = package.tradeoff(flat, tau_min=3, smallest_part=0, new_vertices=True)
    assert steps["length"][-1] == 1.0 != package.tradeoff(flat, tau_min=3, smallest_part=0)["length"][-1]


def test_neighbours_get_the_new_vertices(package):
    upper = "(0 0{0}, 20 0{1}, 20 10{1}, 11 10{0}, 10 1{0}, 9 10{0}, 0 10{0}, 0 0{0})"
    lower = "(0 -5{0}, 20 -5{1}, 20 0{1}, 0 0{0}, 0 -5{0})"
    kinds = {"": ("", ""), "Z": (" 4", " 8"), "ZM": (" 4 1", " 8 3")}
    for a, b in (("", ""), ("Z", ""), ("", "Z"), ("Z", "ZM")):
        if "M" in b and not hasattr(shapely, "has_m"):
            continue
        above = shapely.from_wkt(f"POLYGON {a} ({upper.format(*kinds[a])})")
        below = shapely.from_wkt(f"POLYGON {b} ({lower.format(*kinds[b])})")
        found = package.prepare_aggregation([above, below], new_vertices=True)
        assert found.piece_fields["area_id"].tolist() == [0, 0, 1]
        assert found.neighbours["length"].tolist() == [1, 10, 10]
        for piece, kind in zip(found.pieces, (a, a, b)):
            assert (piece.has_z, getattr(piece, "has_m", False)) == ("Z" in kind, "M" in kind)
            rows = shapely.get_coordinates(
                piece, include_z="Z" in kind, **({"include_m": True} if "M" in kind else {})
            )
            assert [10, 0, 6, 2][: 2 + len(kind)] in rows.tolist()
    alone = package.prepare_aggregation([above, below])
    assert len(alone.pieces) == 2 and alone.pieces[1] == below


def test_what_is_no_geometry_is_said(package):
    for wrong in (["x"], 5, [[ROOMS]], None):
        with pytest.raises(TypeError):
            package.partition(wrong)


def test_defaults_and_names_are_those_of_the_tools(package):
    pytest.importorskip("qgis.core")
    from isthmus.algorithms.provider import IsthmusProvider

    provider = IsthmusProvider()
    tools = {one.name(): one.create() for one in (provider.loadAlgorithms() or provider.algorithms())}
    functions = {
        "partition": "partition",
        "partition_within": "partitionbudget",
        "tradeoff": "tradeoff",
        "hierarchy": "hierarchy",
        "prepare_aggregation": "prepareaggregation",
        "aggregate": "aggregate",
        "enlarge": "focusmap",
    }
    more = {"crs", "diagonals"}
    kinds = ("sink", "fileDestination")
    for function, tool in functions.items():
        given = inspect.signature(getattr(package, function)).parameters
        options = {
            name.rstrip("_"): one.default for name, one in given.items() if one.kind == one.KEYWORD_ONLY
        }
        theirs = {
            one.name().lower(): one.defaultValue()
            for one in tools[tool].parameterDefinitions()
            if one.type() not in kinds
        }
        theirs = {name: value for name, value in theirs.items() if name not in ("input", "focus")}
        assert set(options) - more == set(theirs), function
        for name, value in theirs.items():
            if value in (None, "") or options[name] in (None, inspect.Parameter.empty, ()):
                continue
            assert options[name] == value, (function, name)


def test_geopandas_objects_come_back_as_they_came(package, quiet):
    geopandas = pytest.importorskip("geopandas", reason="geopandas is not installed for this Python")
    table = geopandas.GeoDataFrame(
        {"part": list("abcdef"), "tau": [3.0, 3, 3, 3, 50, 3]}, geometry=MIXED, crs=3857, index=list("uvwxyz")
    ).rename_geometry("shape")
    found = package.partition(table, tau="tau", smallest_part=0)
    assert type(found.parts) is type(found.cuts) is geopandas.GeoDataFrame
    assert found.parts.crs == found.cuts.crs == table.crs and found.parts.geometry.name == "shape"
    assert list(found.parts.columns) == [
        "part",
        "tau",
        "shape",
        "part_2",
        "parts",
        "status",
        "cost",
        "gap",
        "source",
    ]
    assert list(found.parts.index) == list("uuuvwxyyz") == list(found.parts["source"])
    assert list(found.parts["part"]) == list("aaabcdeef") and list(found.parts["part_2"]) == [
        1,
        2,
        3,
        1,
        1,
        1,
        1,
        2,
        1,
    ]
    assert list(found.cuts.columns) == ["source", "length", "detour", "part_a", "part_b", "share", "geometry"]
    series = package.partition(table.geometry, smallest_part=0)
    assert type(series.parts) is type(series.cuts) is geopandas.GeoSeries
    assert series.parts.crs == table.crs and list(series.parts.index) == list("uuuvwxyyyyyyz")
    assert series.parts.name == "shape"
    steps = package.tradeoff(table, smallest_part=0)
    assert list(steps.index) == list(steps["source"]) and list(steps.columns)[:3] == ["source", "tau", "cuts"]
    empty = package.partition(table.iloc[:0])
    assert type(empty.parts) is geopandas.GeoDataFrame and len(empty.parts) == 0
    assert list(empty.parts.columns) == list(found.parts.columns)
    assert list(empty.cuts.columns) == list(found.cuts.columns) and empty.cuts.crs == table.crs
    degrees = package.partition(table.iloc[:1].set_crs(4326, allow_override=True).geometry, smallest_part=0)
    assert degrees.cut_fields["length"].min() > 1e5


def test_a_map_in_geopandas(package, quiet):
    geopandas = pytest.importorskip("geopandas", reason="geopandas is not installed for this Python")
    land = geopandas.GeoDataFrame(
        {"class": ["wood", "road", None, "road"]},
        index=[7, 8, 9, 10],
        crs=3035,
        geometry=[
            shapely.box(0, 0, 800, 600),
            shapely.box(800, 0, 900, 600),
            shapely.box(900, 0, 1800, 600),
            None,
        ],
    )
    pieces = package.prepare_aggregation(land, class_="class").pieces
    assert list(pieces["area_id"]) == [7, 8, 9, 10] and list(pieces["size"]) == [480000, 60000, 540000, 0]
    found = package.aggregate(pieces, class_="class", method="greedy")
    assert list(found.regions.columns) == ["region", "class", "size", "areas", "core", "status", "geometry"]
    assert list(found.regions["class"].fillna("")) == ["wood", ""]
    assert list(found.assignment["new_class"].fillna("")) == ["wood", "wood", "", "road"]
    pytest.importorskip("scipy")
    enlarged = package.enlarge(land, land.geometry.iloc[[1]], scale=1.2, along=[land.geometry])
    assert list(enlarged.map.columns) == list(land.columns) and list(enlarged.map.index) == list(land.index)
    assert enlarged.map.geometry[8].area == pytest.approx(1.44 * land.geometry[8].area)
    assert enlarged.carried[0][8].area == pytest.approx(1.44 * land.geometry[8].area)


def test_version(package):
    metadata = (ROOT / "metadata.txt").read_text(encoding="utf-8")
    assert package.__version__ == re.search(r"^version=(.*)$", metadata, re.M)[1]


def test_installs_and_runs_without_qgis(tmp_path):
    """`pip install .`, in a folder of its own, and what the README says to try."""
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--target", str(tmp_path / "site")]
    # without it pip would have to fetch it; it cannot be imported where QGIS has imported distutils before
    if not importlib.util.find_spec("setuptools"):
        pytest.skip("setuptools is not installed")
    if int(importlib.metadata.version("setuptools").split(".")[0]) < 71 and not importlib.util.find_spec(
        "wheel"
    ):
        pytest.skip("setuptools is old, and needs wheel")
    source = tmp_path / "source"
    source.mkdir()
    for name in ("pyproject.toml", "README.md", "python", "core"):
        (source / name).symlink_to(ROOT / name)
    done = subprocess.run([*pip, "--no-build-isolation", str(source)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    names = sorted(path.name for path in (tmp_path / "site").iterdir())
    assert names[0] == "isthmus" and len(names) == 2 and names[1].startswith("isthmus-")
    assert (tmp_path / "site" / "isthmus" / "py.typed").exists()
    code = (
        "import sys, time, numpy, shapely; start = time.process_time(); import isthmus;"
        "seconds = time.process_time() - start;"
        f"found = isthmus.partition(shapely.from_wkt({ROOMS.wkt!r}), smallest_part=0);"
        "print(seconds, len(found.parts.geoms), *(m in sys.modules for m in ('qgis', 'geopandas', 'scipy')))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        env={"PYTHONPATH": f"{tmp_path / 'site'}:{Path(shapely.__file__).parents[1]}", "PATH": "/usr/bin"},
    )
    assert done.returncode == 0, done.stderr
    seconds, *rest = done.stdout.split()
    assert rest == ["3", "False", "False", "False"] and float(seconds) < 0.5
