"""Partition all countries of the world map that QGIS ships by the real qgis_process; draw the result.

Run it by ``./run demo``, which sets up QGIS and the environment. All that it makes is in
build/demo. The README's picture, resources/readme.png, is a copy of its map.png, and its numbers are
those that ``./run docs demo --note`` has written to docs/measured/demo.json: they are of the world map
of QGIS 3.22, and other versions ship another edition. With the same map QGIS 3.22 and 3.40 make the same
cuts, to the last bit; that of 3.40 has Russia and Ukraine in other outlines.
"""

import json
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

from measured import note
from osgeo import gdal
from qgis.core import (
    Qgis,
    QgsApplication,
    QgsCoordinateReferenceSystem,
    QgsFillSymbol,
    QgsMapRendererParallelJob,
    QgsMapSettings,
    QgsProject,
    QgsRectangle,
    QgsReferencedRectangle,
    QgsSingleSymbolRenderer,
    QgsVectorLayer,
)
from qgis.PyQt.QtCore import QSize
from qgis.PyQt.QtGui import QColor

ROOT = Path(__file__).resolve().parents[1]
OUT = ROOT / "build" / "demo"
PARTS, CUTS, PICTURE = OUT / "parts.gpkg", OUT / "cuts.gpkg", OUT / "map.png"
PROJECT = OUT / "demo.qgz"
STYLES = ROOT / "resources" / "styles"

FRAME = QgsRectangle(4_000_000, 1_400_000, 5_900_000, 2_730_000)  # of the picture, in EPSG:3035
WIDTH = 1200  # pixels


def main():
    app = QgsApplication([], False)
    app.initQgis()
    gdal.PushErrorHandler("CPLQuietErrorHandler")  # it has a remark about the map's metadata
    shutil.rmtree(OUT, ignore_errors=True)
    OUT.mkdir(parents=True)
    # a copy, because opening a GeoPackage may write to it, and this one belongs to the system
    world = OUT / "world_map.gpkg"
    shutil.copyfile(Path(app.pkgDataPath()) / "resources" / "data" / "world_map.gpkg", world)

    results, seconds = partition(world)
    layers = draw(world)
    count = layers[1].featureCount()
    save_project(layers)
    if "--note" in sys.argv:
        note(
            "demo",
            {
                "countries": count,
                "parts": results["PART_COUNT"],
                "cuts": results["CUT_COUNT"],
                "km": round(results["CUT_LENGTH"] / 1000, 1),
                "seconds": round(seconds, 1),
            },
        )
    app.exitQgis()

    print(
        f"QGIS {Qgis.QGIS_VERSION.split('-')[0]}: {count} countries were cut into {results['PART_COUNT']} parts by "
        f"{results['CUT_COUNT']} cuts, {results['CUT_LENGTH'] / 1000:,.0f} km in all, in "
        f"{seconds:.1f} s (QGIS's start included). "
        f"Features not solved: {results['SKIPPED_COUNT']}.\n"
        f"parts    {PARTS}\ncuts     {CUTS}\npicture  {PICTURE}\n"
        f"project  {PROJECT} (open it in QGIS)"
    )


def partition(world):
    """Run isthmus:partition with its defaults; return its results and the seconds it took."""
    qgis_process("plugins", "enable", "isthmus")
    start = time.monotonic()
    answer = qgis_process(
        "run", "--json", "isthmus:partition", "--",
        f"INPUT={world}|layername=countries", f"OUTPUT={PARTS}", f"CUTS={CUTS}",
    )  # fmt: skip
    return json.loads(answer[answer.index("{") :])["results"], time.monotonic() - start


def qgis_process(*arguments):
    """Run the real qgis_process, show the command, and return what it printed."""
    command = [os.environ["QGIS_PROCESS"], *arguments]
    print("$", *(f'"{word}"' if " " in word else word for word in command), flush=True)
    with subprocess.Popen(
        command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, encoding="utf-8"
    ) as process:
        start = time.monotonic()
        while True:
            try:
                said, wrong = process.communicate(timeout=10)
                break
            except subprocess.TimeoutExpired:
                print(f"  at work, {time.monotonic() - start:.0f} s", flush=True)
    if process.returncode:
        sys.exit(f"{said}\n{wrong}\nqgis_process failed ({process.returncode})")
    return said


def draw(world):
    """Draw parts and cuts into map.png, in the plugin's own styles; return the layers, the upper first."""
    parts, cuts = layer(PARTS, "Parts"), layer(CUTS, "Cuts")
    cuts.loadNamedStyle(str(STYLES / "cuts.qml"))
    parts.loadNamedStyle(str(STYLES / "parts.qml"))
    borders = layer(f"{world}|layername=countries", "Countries")
    borders.setRenderer(fill("transparent", "#77726a", 0.18))

    settings = QgsMapSettings()
    settings.setLayers([cuts, borders, parts])
    settings.setDestinationCrs(QgsCoordinateReferenceSystem("EPSG:3035"))
    settings.setExtent(FRAME)
    settings.setOutputSize(QSize(WIDTH, round(WIDTH * FRAME.height() / FRAME.width())))
    settings.setOutputDpi(110)
    settings.setBackgroundColor(QColor("#f1f6f8"))
    job = QgsMapRendererParallelJob(settings)
    job.start()
    job.waitForFinished()
    if job.errors() or not job.renderedImage().save(str(PICTURE)):
        sys.exit("the picture could not be drawn")
    return [cuts, borders, parts]


def save_project(layers):
    """Save a project with the layers beside them."""
    project = QgsProject()
    project.setFileName(str(PROJECT))
    project.setCrs(QgsCoordinateReferenceSystem("EPSG:3035"))
    for one in layers:
        project.addMapLayer(one, False)
        project.layerTreeRoot().addLayer(one)
    frame = QgsReferencedRectangle(FRAME, project.crs())
    project.viewSettings().setDefaultViewExtent(frame)
    if not project.write():
        sys.exit(f"the project could not be saved: {project.error()}")


def layer(source, name):
    """Open a vector layer, or stop."""
    made = QgsVectorLayer(str(source), name, "ogr")
    if not made.isValid():
        sys.exit(f"QGIS cannot open {source}")
    return made


def fill(colour, outline, width):
    """Make a renderer of one fill."""
    style = {"color": colour, "outline_color": outline, "outline_width": str(width)}
    return QgsSingleSymbolRenderer(QgsFillSymbol.createSimple(style))


if __name__ == "__main__":
    main()
