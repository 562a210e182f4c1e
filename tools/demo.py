"""Partition countries of the world map that QGIS ships by the real qgis_process; draw the result.

Run it by ``./run demo``, which sets up QGIS and the environment. All that it makes is in
build/demo. The README's picture, resources/readme.png, is a copy of its map.png, and its numbers are
those that ``./run docs demo --note`` has written to docs/measured/demo.json: they are of the world map
of QGIS 3.22, and other versions ship another edition.
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
    QgsApplication,
    QgsCoordinateReferenceSystem,
    QgsFillSymbol,
    QgsMapRendererParallelJob,
    QgsMapSettings,
    QgsProperty,
    QgsRectangle,
    QgsSingleSymbolRenderer,
    QgsSymbolLayer,
    QgsVectorLayer,
)
from qgis.PyQt.QtCore import QSize
from qgis.PyQt.QtGui import QColor

ROOT = Path(__file__).resolve().parents[1]
OUT = ROOT / "build" / "demo"
PARTS, CUTS, PICTURE = OUT / "parts.gpkg", OUT / "cuts.gpkg", OUT / "map.png"
STYLES = ROOT / "resources" / "styles"

# Around the Adriatic and the Aegean; by ISO code, for names differ between editions of the map.
# The number is the colour of the style, of eight, that a country begins with: so that neighbours
# look different.
COUNTRIES = {
    "AL": 2, "AT": 6, "BA": 5, "BG": 3, "CH": 1, "FR": 7, "GR": 7, "HR": 7, "HU": 3, "IT": 3,
    "ME": 7, "MK": 0, "RO": 1, "RS": 6, "SI": 0, "TR": 7, "XK": 4,
}  # fmt: skip
# in metres and square metres, for the map's coordinates are degrees
TAU, MIN_LENGTH, MIN_HOLE = 4, 20_000, 100_000_000

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
    draw(world)
    if "--note" in sys.argv:
        note("demo", {
            "countries": len(COUNTRIES),
            "parts": results["PART_COUNT"],
            "cuts": results["CUT_COUNT"],
            "km": round(results["CUT_LENGTH"] / 1000, 1),
            "tau": TAU,
            "min_length_km": MIN_LENGTH / 1000,
            "min_hole_km2": MIN_HOLE / 1e6,
            "seconds": round(seconds, 1),
        })
    app.exitQgis()

    print(
        f"{len(COUNTRIES)} countries were cut into {results['PART_COUNT']} parts by "
        f"{results['CUT_COUNT']} cuts, {results['CUT_LENGTH'] / 1000:,.0f} km in all, in "
        f"{seconds:.1f} s (QGIS's start included).\n"
        f"Of the diagonals of {MIN_LENGTH / 1000:.0f} km and more, none now has a detour above "
        f"{results['MAX_DILATION']:.3f} (allowed: {TAU}). "
        f"Features not solved: {results['SKIPPED_COUNT']}.\n"
        f"parts    {PARTS}\ncuts     {CUTS}\npicture  {PICTURE}"
    )


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
        f"MIN_HOLE={MIN_HOLE}",
        f"OUTPUT={PARTS}",
        f"CUTS={CUTS}",
    )  # fmt: skip
    return json.loads(answer[answer.index("{"):])["results"], time.monotonic() - start


def qgis_process(*arguments):
    """Run the real qgis_process, show the command, and return what it printed."""
    command = [os.environ["QGIS_PROCESS"], *arguments]
    print("$", *(f'"{word}"' if " " in word else word for word in command), flush=True)
    done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, encoding="utf-8")
    if done.returncode:
        sys.exit(f"{done.stdout}\n{done.stderr}\nqgis_process failed ({done.returncode})")
    return done.stdout


def draw(world):
    """Draw land, parts and cuts into map.png, in the plugin's own styles."""
    land, parts, cuts = layer(f"{world}|layername=countries"), layer(PARTS), layer(CUTS)
    land.setRenderer(fill("#e9e6df", "#c6c1b7", 0.15))
    cuts.loadNamedStyle(str(STYLES / "cuts.qml"))
    parts.loadNamedStyle(str(STYLES / "parts.qml"))
    first = ", ".join(f"'{code}', {colour}" for code, colour in COUNTRIES.items())
    fill_colour = QgsSymbolLayer.Property.PropertyFillColor
    symbol = parts.renderer().symbol().symbolLayer(0)
    expression = symbol.dataDefinedProperties().property(fill_colour).expressionString()
    own = expression.replace("abs($id)", f"(part + map_get(map({first}), iso_a2))")
    symbol.setDataDefinedProperty(fill_colour, QgsProperty.fromExpression(own))
    borders = layer(f"{world}|layername=countries")
    borders.setRenderer(fill("transparent", "#77726a", 0.18))

    settings = QgsMapSettings()
    settings.setLayers([cuts, borders, parts, land])
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


def layer(source):
    """Open a vector layer, or stop."""
    made = QgsVectorLayer(str(source), "", "ogr")
    if not made.isValid():
        sys.exit(f"QGIS cannot open {source}")
    return made


def fill(colour, outline, width):
    """Make a renderer of one fill."""
    style = {"color": colour, "outline_color": outline, "outline_width": str(width)}
    return QgsSingleSymbolRenderer(QgsFillSymbol.createSimple(style))


if __name__ == "__main__":
    main()
