"""What is on disk after a run: everything, or nothing."""

import os

import pytest
from osgeo import gdal
from qgis.core import (
    QgsApplication,
    QgsProcessingContext,
    QgsProcessingException,
    QgsProcessingFeatureSourceDefinition,
    QgsProcessingOutputLayerDefinition,
    QgsProject,
    QgsProperty,
    QgsRemappingSinkDefinition,
    QgsVectorLayer,
)

from isthmus.algorithms.layers import sinks
from isthmus.tests.full_disk import small_files

from .test_partition import BOWTIE, DUMBBELL, partition

MANY = 300


@pytest.fixture
def source(layer):
    return layer("Polygon?crs=EPSG:3857&field=name:string", [(DUMBBELL, ["x" * 50])] * MANY)


@pytest.fixture
def few(layer):
    return layer("Polygon?crs=EPSG:3857&field=name:string", [(DUMBBELL, ["x"])] * 3)


def layers_of(path):
    source = gdal.OpenEx(str(path))
    return {
        source.GetLayer(k).GetName(): source.GetLayer(k).GetFeatureCount()
        for k in range(source.GetLayerCount())
    }


@pytest.mark.parametrize("ending, room", [
    ("gpkg", 4_000), ("gpkg", 130_000), ("shp", 50), ("shp", 4_000), ("shp", 60_000), ("geojson", 4_000),
    ("geojson", 60_000), ("csv", 20_000),
])  # fmt: skip
def test_a_full_disk_is_said_and_leaves_nothing(run, source, tmp_path, ending, room):
    """A GeoJSON file that broke off used to be called a success."""
    with small_files(room), pytest.raises(QgsProcessingException):
        partition(run, source, OUTPUT=str(tmp_path / f"parts.{ending}"))
    assert not list(tmp_path.iterdir())
    partition(run, source, OUTPUT=str(tmp_path / f"parts.{ending}"))
    assert layers_of(tmp_path / f"parts.{ending}") == {"parts": 3 * MANY}


def reports_of(run, source, whole):
    """How often a run reports its progress; the last ones while it writes."""
    partition(run, source, whole)
    return len(whole.shares)


@pytest.mark.parametrize("ending", ["gpkg", "shp", "geojson"])
def test_a_cancelled_run_leaves_no_file_that_looks_complete(run, source, tmp_path, cancelling, ending):
    feedback = cancelling(reports_of(run, source, cancelling()) - 20)
    results = partition(
        run,
        source,
        feedback,
        OUTPUT=str(tmp_path / f"parts.{ending}"),
        CUTS=str(tmp_path / f"cuts.{ending}"),
    )
    assert 0 < results["PART_COUNT"] < 3 * MANY
    assert "OUTPUT" not in results and "CUTS" not in results
    assert not list(tmp_path.iterdir())
    assert any("removed" in text for text in feedback.infos)


@pytest.mark.parametrize("room", [40, 300])
def test_a_table_without_geometry_in_a_shapefile_goes_too(run, few, tmp_path, cancelling, room):
    """GDAL makes only its .dbf: one that broke off was called a success, and after a cancel it was left."""
    given = {"INPUT": few, "CLASS": "name", "OUTPUT": "memory:", "ADJACENCY": str(tmp_path / "pairs.shp")}
    with small_files(room), pytest.raises(QgsProcessingException, match="could|Could"):
        run("isthmus:tradeoff", {"INPUT": few, "OUTPUT": str(tmp_path / "steps.shp")})
    assert not list(tmp_path.iterdir())
    run("isthmus:prepareaggregation", given, cancelling(1))
    assert not list(tmp_path.iterdir())
    run("isthmus:prepareaggregation", given)
    assert (tmp_path / "pairs.dbf").is_file()


def test_other_layers_of_a_geopackage_stay(run, source, tmp_path, cancelling):
    path = tmp_path / "all.gpkg"
    partition(run, source, OUTPUT=str(path))
    target = f"ogr:dbname='{path}' table=\"again\" (geom)"
    partition(run, source, OUTPUT=target)
    assert layers_of(path) == {"all": 3 * MANY, "again": 3 * MANY}
    partition(run, source, cancelling(reports_of(run, source, cancelling()) - 20), OUTPUT=target)
    assert layers_of(path) == {"all": 3 * MANY}
    assert QgsVectorLayer(str(path)).isValid()


def test_a_cancelled_curve_leaves_no_table_and_no_report(run, source, tmp_path, cancelling):
    whole = cancelling()
    run("isthmus:tradeoff", {"INPUT": source, "OUTPUT": "memory:"}, whole)
    results = run(
        "isthmus:tradeoff",
        {"INPUT": source, "OUTPUT": str(tmp_path / "steps.csv"),
         "REPORT": str(tmp_path / "report.html")},
        cancelling(cancel_after=len(whole.shares) - 20),
    )  # fmt: skip
    assert results["STEP_COUNT"] > 0
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("tool, more", [
    ("partition", ["OUTPUT", "CUTS", "DIAGONALS"]), ("hierarchy", ["OUTPUT", "CUTS"]),
    ("tradeoff", ["OUTPUT", "REPORT"]), ("prepareaggregation", ["OUTPUT", "ADJACENCY"]),
    ("aggregate", ["OUTPUT", "ASSIGNMENT", "REPORT"]), ("focusmap", ["OUTPUT", "EDGES_USED"]),
])  # fmt: skip
def test_a_cancel_at_any_time_leaves_nothing(run, layer, tmp_path, cancelling, tool, more):
    """A report that was removed used to be in the results, and a map not read yet had no area with a class."""

    class Asked(cancelling):
        calls, last = 0, None

        def isCanceled(self):
            self.calls += 1
            if self.calls == self.last:
                self.cancel()
            return super().isCanceled()

    boxes = [
        (f"POLYGON(({x} 0,{x + 10} 0,{x + 10} 10,{x} 10,{x} 0))", ["ab"[x // 10 % 2]])
        for x in range(0, 80, 10)
    ]
    areas = layer("Polygon?crs=EPSG:25832&field=code:string", boxes)
    given = {"INPUT": areas}
    if tool == "focusmap":
        given["FOCUS"] = layer("Polygon?crs=EPSG:25832", [("POLYGON((25 -1,45 -1,45 11,25 11,25 -1))", [])])
    elif "aggreg" in tool:
        given["CLASS"] = "code"
    if tool == "aggregate":
        made = run("isthmus:prepareaggregation", {**given, "OUTPUT": "memory:", "ADJACENCY": "memory:"})
        given |= {
            "INPUT": made["OUTPUT"],
            "ADJACENCY": made["ADJACENCY"],
            "THRESHOLD": 250,
            "METHOD": "greedy",
        }
    for name in more:
        given[name] = str(tmp_path / f"{name}.{'html' if name == 'REPORT' else 'gpkg'}")
    feedback = Asked()
    results = run(f"isthmus:{tool}", given, feedback)
    assert all(results[name] == given[name] for name in more) and len(list(tmp_path.iterdir())) >= len(more)
    calls, cancelled = feedback.calls, 0
    for last in sorted({1, 2, 3, calls // 3, 2 * calls // 3, calls - 4, calls - 2, calls - 1}):
        for path in tmp_path.iterdir():
            path.unlink()
        feedback = Asked()
        feedback.last = last
        results = run(f"isthmus:{tool}", given, feedback)
        if feedback.isCanceled():
            cancelled += 1
            assert not list(tmp_path.iterdir()) and not set(more) & set(results)
            assert not [text for text in feedback.warnings if "Cancelled" not in text]
    assert cancelled >= 4


def test_a_curve_that_could_not_be_written_takes_its_report_with_it(run, layer, tmp_path):
    """The end of a GeoPackage is written last; only then the disk may turn out to be full."""
    nothing = layer("Polygon?crs=EPSG:3857", [])
    given = {"INPUT": nothing, "OUTPUT": str(tmp_path / "steps.gpkg")}
    with small_files(8192), pytest.raises(QgsProcessingException, match="could be written"):
        run("isthmus:tradeoff", {**given, "REPORT": str(tmp_path / "report.html")})
    assert not [path for path in tmp_path.iterdir() if path.suffix == ".html"]


def test_a_report_that_cannot_be_written_takes_the_table_with_it(run, few, tmp_path):
    given = {"INPUT": few, "OUTPUT": str(tmp_path / "steps.csv")}
    with pytest.raises(QgsProcessingException, match="The report could not be written: .*nowhere"):
        run("isthmus:tradeoff", {**given, "REPORT": str(tmp_path / "nowhere" / "report.html")})
    assert not list(tmp_path.iterdir())


def test_a_second_result_that_cannot_be_made_takes_the_first_with_it(run, source, tmp_path):
    with pytest.raises(QgsProcessingException, match="nowhere"):
        partition(run, source, OUTPUT=str(tmp_path / "parts.gpkg"), CUTS="/proc/nowhere/cuts.gpkg")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("tool, name, file", [
    ("partition", "CUTS", "cuts.gpkg"),
    ("hierarchy", "OUTPUT", "deeper/and/deeper/parts.gpkg"),
    ("tradeoff", "REPORT", "report.html"),
    ("aggregate", "REPORT", "report.html"),
    ("aggregate", "OUTPUT", "regions"),
    ("focusmap", "OUTPUT", "map.shp"),
    ("prepareaggregation", "ADJACENCY", "pairs.csv"),
])  # fmt: skip
def test_what_may_not_be_written_is_said_before_anything_is_computed(
    provider, few, tool, name, file, tmp_path, monkeypatch
):
    """The tools for whole maps used to find out after minutes."""
    made = QgsApplication.processingRegistry().algorithmById(f"isthmus:{tool}")
    given = {"INPUT": few, "FOCUS": few, "CLASS": "name", "THRESHOLD": 1, "OUTPUT": "memory:"}
    given = {key: value for key, value in given.items() if made.parameterDefinition(key)}
    if made.parameterDefinition("ADJACENCY"):
        given["ADJACENCY"] = few if tool == "aggregate" else "memory:"
    context = QgsProcessingContext()
    context.setProject(QgsProject.instance())
    given[name] = str(tmp_path / file)
    assert made.checkParameterValues(given, context) == (True, "")
    # root may write anywhere but to a disk that is mounted for reading
    locked = lambda path, mode: mode != os.W_OK or str(path) != str(tmp_path)  # noqa: E731
    monkeypatch.setattr(sinks.os, "access", locked)
    good, problem = made.checkParameterValues(given, context)
    assert not good and problem.startswith(f"{name} cannot be written to {tmp_path}/{file}")
    assert problem.endswith(f"nothing may be written to the folder {tmp_path}. Choose another place.")


def test_a_file_that_may_not_be_changed(run, few, tmp_path, monkeypatch):
    path = tmp_path / "parts.gpkg"
    partition(run, few, OUTPUT=str(path))
    monkeypatch.setattr(sinks.os, "access", lambda file, mode: str(file) != str(path))
    with pytest.raises(QgsProcessingException, match="OUTPUT cannot be written .*: the file there may not"):
        partition(run, few, OUTPUT=str(path))
    assert layers_of(path) == {"parts": 9}


def test_a_file_that_is_no_folder_and_a_folder_that_is_not_there(run, few, tmp_path):
    (tmp_path / "file.txt").write_text("x")
    with pytest.raises(QgsProcessingException, match="CUTS cannot be written to .*file.txt is no folder"):
        partition(run, few, CUTS=str(tmp_path / "file.txt" / "deep" / "cuts.gpkg"))
    with pytest.raises(QgsProcessingException, match="OUTPUT cannot be written to .*there is no such folder"):
        partition(run, few, OUTPUT=str(tmp_path / "new" / "parts.gpkg"))
    assert [path.name for path in tmp_path.iterdir()] == ["file.txt"]


def test_a_format_that_drops_features_is_said(run, layer, tmp_path):
    source = layer("Polygon?crs=EPSG:3857", [(DUMBBELL, []), (None, []), (BOWTIE, [])])
    # newer versions of GDAL refuse the feature themselves
    with pytest.raises(QgsProcessingException, match="without geometry|NULL geometry"):
        partition(run, source, OUTPUT=str(tmp_path / "parts.fgb"))
    assert not list(tmp_path.iterdir())


def test_no_input_is_overwritten(run, few, tmp_path):
    """QGIS would make the file anew and then read it; a cancel would even remove it."""
    path = tmp_path / "land.gpkg"
    partition(run, few, OUTPUT=str(path))
    ways = [str(path), QgsVectorLayer(str(path)), f"{path}|layername=land"]
    ways.append(QgsProcessingFeatureSourceDefinition(str(path), True))
    for number, way in enumerate(ways):
        if isinstance(way, QgsVectorLayer):
            QgsProject.instance().addMapLayer(way)
            ways.append(QgsProcessingFeatureSourceDefinition(way.id(), False))
        for name in ("OUTPUT", "CUTS"):
            with pytest.raises(QgsProcessingException, match=f"{name} would overwrite the input INPUT"):
                partition(run, way, **{name: str(path)})
        with pytest.raises(QgsProcessingException, match="would overwrite the input INPUT"):
            partition(run, way, OUTPUT=f"ogr:dbname='{path}' table=\"land\" (geom)")
        assert layers_of(path)["land"] == 9
        if number != 3:  # nothing is selected
            partition(run, way, OUTPUT=f"ogr:dbname='{path}' table=\"parts{number}\" (geom)")
            assert layers_of(path)[f"parts{number}"] >= 9
    assert len(layers_of(path)) == 5
    QgsProject.instance().clear()


def test_a_result_without_an_ending_is_no_input_either(run, few, tmp_path):
    """QGIS makes a GeoPackage of it, and land.gpkg was gone before it was read."""
    path = tmp_path / "land.gpkg"
    partition(run, few, OUTPUT=str(path))
    for name in ("land", "land.gpkg"):
        with pytest.raises(QgsProcessingException, match="OUTPUT would overwrite the input INPUT"):
            partition(run, str(path), OUTPUT=str(tmp_path / name))
    with pytest.raises(QgsProcessingException, match="CUTS would overwrite the result OUTPUT"):
        partition(run, str(path), OUTPUT=str(tmp_path / "both.gpkg"), CUTS=str(tmp_path / "both"))
    assert layers_of(path) == {"land": 9}


def test_a_cancelled_run_adds_nothing_to_a_layer_that_was_there(run, source, tmp_path, cancelling):
    """A third of the parts used to be added."""
    path = tmp_path / "all.gpkg"
    partition(run, source, OUTPUT=str(path))
    layer = QgsVectorLayer(str(path))
    append = QgsRemappingSinkDefinition()
    append.setDestinationFields(layer.fields())
    append.setDestinationWkbType(layer.wkbType())
    append.setDestinationCrs(layer.crs())
    names = [name for name in layer.fields().names() if name != "fid"]
    append.setFieldMap({name: QgsProperty.fromField(name) for name in names})
    target = QgsProcessingOutputLayerDefinition(f"ogr:dbname='{path}' table=\"all\" (geom)")
    target.setRemappingDefinition(append)
    feedback = cancelling(reports_of(run, source, cancelling()) - 20)
    assert "OUTPUT" not in partition(run, source, feedback, OUTPUT=target)
    assert layers_of(path) == {"all": 3 * MANY}
    partition(run, source, OUTPUT=target)
    assert layers_of(path) == {"all": 6 * MANY}


def test_two_results_in_one_file(run, few, tmp_path):
    path = tmp_path / "both.gpkg"
    with pytest.raises(QgsProcessingException, match="CUTS would overwrite the result OUTPUT"):
        partition(run, few, OUTPUT=str(path), CUTS=str(path))
    assert not path.exists()
    tables = {name: f"ogr:dbname='{path}' table=\"{name.lower()}\" (geom)" for name in ("OUTPUT", "CUTS")}
    partition(run, few, **tables)
    assert layers_of(path) == {"output": 9, "cuts": 6}
