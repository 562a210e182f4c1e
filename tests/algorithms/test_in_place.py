"""The tool partition on an editable layer: parts take the place of the selected polygons, and one undo takes them back."""

import pytest
from qgis.core import QgsApplication, QgsProcessingContext, QgsProject, QgsVectorLayer

ROOMS = "POLYGON(({0} 0,{1} 0,{1} 4.5,{2} 4.5,{2} 0,{3} 0,{3} 10,{2} 10,{2} 5.5,{1} 5.5,{1} 10,{0} 10,{0} 0))"


def rooms(x):
    return ROOMS.format(x, x + 10, x + 12, x + 22)


def edit(layer, feedback, **parameters):
    """What the dialog of the toolbox does in the mode "edit features in place"."""
    from processing.gui.AlgorithmExecutor import execute_in_place_run

    tool = QgsApplication.processingRegistry().createAlgorithmById("isthmus:partition", {"IN_PLACE": True})
    assert tool.supportInPlaceEdit(layer)
    names = [p.name() for p in tool.parameterDefinitions() if p.isDestination()]
    assert names == ["OUTPUT"]  # other layers would be lost
    context = QgsProcessingContext()
    context.setProject(QgsProject.instance())
    context.setFeedback(feedback)
    return execute_in_place_run(
        tool, {"INPUT": layer, **parameters}, context=context, feedback=feedback, raise_exceptions=True
    )


@pytest.fixture
def editable(layer, provider):
    made = layer(
        "Polygon?crs=EPSG:3857&field=name:string&field=part:integer",
        [
            (rooms(0), ["a", 7]),
            (rooms(100), ["b", 8]),
            (rooms(200), ["c", 9]),
            ("POLYGON((0 50,9 59,9 50,0 59,0 50))", ["d", 4]),
        ],
    )
    QgsProject.instance().addMapLayer(made)
    made.startEditing()
    yield made
    QgsProject.instance().removeMapLayer(made)


def rows(layer):
    return sorted((f["name"], f["part"], round(f.geometry().area(), 6)) for f in layer.getFeatures())


def test_selected_polygons_are_cut_with_one_undo(editable, feedback, run):
    before = rows(editable)
    editable.selectByExpression("name in ('a', 'd')")
    ok, _ = edit(editable, feedback)
    assert ok
    after = rows(editable)
    parts = [row for row in after if row[0] == "a"]
    # as the tool cuts them; fields of the layer keep their values, though the tool has one of that name
    assert len(parts) == 2 and {row[1] for row in parts} == {7}
    assert sum(row[2] for row in parts) == pytest.approx(202)
    assert [row for row in after if row[0] != "a"] == [row for row in before if row[0] != "a"]
    assert editable.fields().names() == ["name", "part"]
    assert editable.undoStack().count() == 1
    editable.undoStack().undo()
    assert rows(editable) == before
    editable.undoStack().redo()
    assert rows(editable) == after
    assert editable.commitChanges()


def test_a_geopackage_keeps_its_keys(editable, feedback, tmp_path):
    from qgis.core import QgsVectorFileWriter

    path = str(tmp_path / "rooms.gpkg")
    options = QgsVectorFileWriter.SaveVectorOptions()
    QgsVectorFileWriter.writeAsVectorFormatV3(
        editable, path, QgsProject.instance().transformContext(), options
    )
    stored = QgsVectorLayer(path, "stored", "ogr")
    QgsProject.instance().addMapLayer(stored)
    stored.startEditing()
    stored.selectByExpression("name = 'b'")
    assert edit(stored, feedback)[0] and stored.commitChanges(), stored.commitErrors()
    assert [row[0] for row in rows(stored)] == ["a", "b", "b", "c", "d"]
    QgsProject.instance().removeMapLayer(stored)


def test_cancelled_nothing_is_lost(editable, cancelling):
    """QGIS deletes what was selected, whether the tool came to it or not."""
    before = rows(editable)
    area = sum(row[2] for row in before)
    for after in (1, 2, 3, 4):
        editable.selectAll()
        edit(editable, cancelling(cancel_after=after))
        assert sum(row[2] for row in rows(editable)) == pytest.approx(area)
        editable.undoStack().undo()
        assert rows(editable) == before


def test_only_polygons(layer, provider):
    tool = QgsApplication.processingRegistry().algorithmById("isthmus:partition")
    assert not tool.supportInPlaceEdit(layer("LineString?crs=EPSG:3857", []))
    assert not tool.supportInPlaceEdit(None)
    assert "CUTS" in [p.name() for p in tool.parameterDefinitions()]
