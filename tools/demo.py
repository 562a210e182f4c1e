"""Partition countries of the world map that QGIS ships, with the real qgis_process, and draw the result.

Run it by ``./run demo``, which sets up QGIS and the environment. Everything it makes is in build/demo.
"""

import json
import os
import shlex
import shutil
import subprocess
import sys
import time
from pathlib import Path

from qgis.core import (
    QgsApplication,
    QgsCoordinateReferenceSystem,
    QgsFillSymbol,
    QgsMapRendererParallelJob,
    QgsMapSettings,
    QgsProject,
    QgsRectangle,
    QgsSingleSymbolRenderer,
    QgsVectorLayer,
)
from qgis.PyQt.QtCore import QSize
from qgis.PyQt.QtGui import QColor

ROOT = Path(__file__).resolve().parents[1]
OUT = ROOT / "build" / "demo"
STYLES = ROOT / "resources" / "styles"

# by ISO code: names differ between editions of the map
COUNTRIES = (
    "AL AT BA BE BG BY CH CZ DE DK EE ES FI FR GB GR HR HU IE IT LT LU LV MD ME MK NL NO PL PT RO RS "
    "SE SI SK TR UA XK"
).split()
TAU, MIN_LENGTH = 4, 20_000  # metres, for the map's coordinates are degrees

FRAME = QgsRectangle(2_450_000, 1_330_000, 6_500_000, 4_980_000)  # of the picture, in its CRS
WIDTH = 1200  # pixels


def main():
    app = QgsApplication([], False)
    app.initQgis()
    shutil.rmtree(OUT, ignore_errors=True)
    OUT.mkdir(parents=True)
    # a copy, because opening a GeoPackage may write to it, and this one belongs to the system
    world = OUT / "world_map.gpkg"
    shutil.copyfile(Path(app.pkgDataPath()) / "resources" / "data" / "world_map.gpkg", world)

    results, seconds = partition(world)
    draw(world, results)
    app.exitQgis()

    print(f"{len(COUNTRIES)} countries -> {results['PART_COUNT']} parts by {results['CUT_COUNT']} cuts"
          f" ({results['CUT_LENGTH'] / 1000:,.0f} km) in {seconds:.1f} s, start of QGIS included")
    print(f"largest detour left: {results['MAX_DILATION']:.3f} (allowed: {TAU}),"
          f" features not solved: {results['SKIPPED_COUNT']}")
    for file in ("parts.gpkg", "cuts.gpkg", "map.png"):
        print(OUT / file)


def partition(world):
    """Run isthmus:partition on some countries; return its results and the seconds it took."""
    codes = ", ".join(f"'{code}'" for code in COUNTRIES)
    qgis_process("plugins", "enable", "isthmus")
    start = time.monotonic()
    answer = qgis_process(
        "run", "--json", "isthmus:partition", "--",
        f'INPUT={world}|layername=countries|subset=iso_a2 IN ({codes})',
        f"TAU={TAU}",
        f"MIN_LENGTH={MIN_LENGTH}",
        f"OUTPUT={OUT / 'parts.gpkg'}",
        f"CUTS={OUT / 'cuts.gpkg'}",
    )  # fmt: skip
    return json.loads(answer[answer.index("{"):])["results"], time.monotonic() - start


def qgis_process(*arguments):
    """Run the real qgis_process, show the command, and return what it printed."""
    command = [os.environ["QGIS_PROCESS"], *arguments]
    print("$", shlex.join(command), flush=True)
    done = subprocess.run(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, encoding="utf-8")
    if done.returncode:
        sys.exit(f"{done.stdout}\nqgis_process failed ({done.returncode})")
    return done.stdout


def draw(world, results):
    """Draw countries, parts and cuts into map.png."""
    crs = QgsCoordinateReferenceSystem("EPSG:3035")
    land = layer(f"{world}|layername=countries")
    land.setRenderer(fill("#eeebe4", "#cfcac0"))
    parts, cuts = layer(OUT / "parts.gpkg", "parts.qml"), layer(OUT / "cuts.gpkg", "cuts.qml")
    borders = layer(f"{world}|layername=countries")
    borders.setRenderer(fill("transparent", "#8d877c"))

    settings = QgsMapSettings()
    settings.setLayers([cuts, borders, parts, land])
    settings.setDestinationCrs(crs)
    settings.setTransformContext(QgsProject.instance().transformContext())
    settings.setExtent(FRAME)
    settings.setOutputSize(QSize(WIDTH, round(WIDTH * FRAME.height() / FRAME.width())))
    settings.setOutputDpi(110)
    settings.setBackgroundColor(QColor("#dbe6ec"))
    settings.setFlag(QgsMapSettings.Flag.Antialiasing, True)
    job = QgsMapRendererParallelJob(settings)
    job.start()
    job.waitForFinished()
    image = job.renderedImage()
    image.save(str(OUT / "map.png"))


def layer(source, style=None):
    made = QgsVectorLayer(str(source), "", "ogr")
    if not made.isValid():
        sys.exit(f"QGIS cannot open {source}")
    if style:
        made.loadNamedStyle(str(STYLES / style))
    return made


def fill(colour, outline):
    return QgsSingleSymbolRenderer(
        QgsFillSymbol.createSimple(
            {"color": colour, "outline_color": outline, "outline_width": "0.15"}
        )
    )


if __name__ == "__main__":
    main()
