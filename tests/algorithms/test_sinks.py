"""What is on disk after a run: everything, or nothing."""

import pytest
from osgeo import gdal
from qgis.core import (
    QgsProcessingException,
    QgsProcessingFeatureSourceDefinition,
    QgsProcessingOutputLayerDefinition,
    QgsProject,
    QgsProperty,
    QgsRemappingSinkDefinition,
    QgsVectorLayer,
)

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
    ("gpkg", 4_000), ("gpkg", 130_000), ("shp", 4_000), ("shp", 60_000), ("geojson", 4_000),
    ("geojson", 60_000), ("csv", 20_000),
])  # fmt: skip
def test_a_full_disk_is_said_and_leaves_nothing(run, source, tmp_path, ending, room):
    """A GeoJSON file that broke off used to be called a success."""
    with small_files(room), pytest.raises(QgsProcessingException):
        partition(run, source, OUTPUT=str(tmp_path / f"parts.{ending}"))
    # a GeoPackage for which there is not even room to be made is left by QGIS, without a layer
    left = [path for path in tmp_path.iterdir() if (ending, room) != ("gpkg", 4_000)]
    assert not left
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
