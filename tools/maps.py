"""What the scripts of the documentation share: a QGIS, layers, runs of tools, and maps drawn by QGIS.

A picture is a row of panels. QGIS draws the layers of each; titles, names and the scale are painted
over them.
"""

import atexit
import os
import shlex
import shutil
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np
import shapely
from qgis.core import (
    QgsApplication,
    QgsCategorizedSymbolRenderer,
    QgsCoordinateReferenceSystem,
    QgsCoordinateTransform,
    QgsFeature,
    QgsFeatureRequest,
    QgsFillSymbol,
    QgsGeometry,
    QgsLineSymbol,
    QgsMapRendererParallelJob,
    QgsMapSettings,
    QgsPointXY,
    QgsProcessingFeedback,
    QgsProject,
    QgsRectangle,
    QgsRendererCategory,
    QgsSingleSymbolRenderer,
    QgsVectorFileWriter,
    QgsVectorLayer,
)
from qgis.PyQt.QtCore import QPointF, QRectF, QSize, Qt
from qgis.PyQt.QtGui import QColor, QFont, QFontMetricsF, QImage, QPainter, QPainterPath, QPen

ROOT = Path(__file__).resolve().parents[1]
PICTURES = ROOT / "docs" / "pictures"
BUILD = ROOT / "build" / "gallery"

DEGREES = "EPSG:4326"
WATER, LAND, SHORE, CUT, INK = "#eaf2f6", "#f0ece3", "#b9b2a5", "#8c1c13", "#2f3437"
LAND_PARTS = ("#f6d7a7", "#c3ddb4", "#d8cbe6", "#f3bfb0", "#b9d7e6", "#efe6a3", "#d9c9b4", "#bfe0d3")
WATER_PARTS = ("#8fc1dc", "#b4ddcf", "#c3cbea", "#a5d4e8", "#d7e5a8", "#9db9dd", "#cfe3ef", "#a9cdbb")
FONT = "DejaVu Sans"


# --- QGIS -------------------------------------------------------------------------------------------


def start():
    """Start a QGIS without a window, with its Processing tools and ours."""
    application = QgsApplication([], False)
    application.initQgis()
    sys.path.append(str(Path(QgsApplication.pkgDataPath()) / "python" / "plugins"))
    sys.path.insert(0, str(ROOT / "tests"))
    import conftest  # noqa: F401  (makes the package importable)
    from processing.core.Processing import Processing

    from isthmus.algorithms.provider import IsthmusProvider

    Processing.initialize()
    application.isthmus = IsthmusProvider()  # the registry does not keep it alive
    QgsApplication.processingRegistry().addProvider(application.isthmus)
    QgsProject.instance().setEllipsoid("EPSG:7030")
    return application


def stop(_application):
    """End the program at once: QGIS may crash when Python takes it down."""
    sys.stdout.flush()
    os._exit(0)


class Run(NamedTuple):
    """What a tool did.

    Attributes
    ----------
    command : str
        What a reader types for it, in a clone.
    results : dict
        What the tool returned.
    seconds : float
        Of the processor, layers read and written, without QGIS's start.
    """

    command: str
    results: dict
    seconds: float


class Quiet(QgsProcessingFeedback):
    """Says nothing but warnings."""

    def __init__(self):
        super().__init__(False)

    def pushWarning(self, text):
        print("  warning:", text)

    def reportError(self, text, fatal=False):
        print("  error:", text)


EVERY_DIAGONAL = {"PLACES": "Any", "SMALLEST_PART": 0}  # the problem of the paper


def run(tool, **parameters):
    """Run a tool; paths below the clone are shown relative to it."""
    import processing

    for value in parameters.values():
        if isinstance(value, Path):
            value.parent.mkdir(parents=True, exist_ok=True)
    start = time.process_time()
    results = processing.run(
        tool,
        {k: str(v) if isinstance(v, Path) else v for k, v in parameters.items()},
        feedback=Quiet(),
    )
    return Run(command(tool, parameters), results, time.process_time() - start)


def command(tool, parameters):
    """Return the qgis_process command for a run of a tool."""
    words = [f"./run qgis_process run {tool}"]
    for name, value in parameters.items():
        if isinstance(value, Path):
            value = value.relative_to(ROOT) if ROOT in value.parents else value
        words.append(f"--{name}={shlex.quote(str(value))}")
    lines = [words[0]]
    for word in words[1:]:
        if len(lines[-1]) + len(word) > 92:
            lines[-1] += " \\"
            lines.append("   ")
        lines[-1] += f" {word}"
    return "\n".join(lines)


# --- Layers -----------------------------------------------------------------------------------------


def world():
    """Return the countries of QGIS's world map as a layer: a copy, for opening it may write to it."""
    folder = Path(tempfile.mkdtemp())
    atexit.register(shutil.rmtree, folder, True)
    copy = folder / "world_map.gpkg"
    shutil.copyfile(Path(QgsApplication.pkgDataPath()) / "resources" / "data" / "world_map.gpkg", copy)
    return opened(f"{copy}|layername=countries")


def opened(source):
    """Open a vector layer, or stop."""
    made = QgsVectorLayer(str(source), "layer", "ogr")
    if not made.isValid():
        sys.exit(f"QGIS cannot open {source}")
    return made


def shapes(layer, request=None):
    """Return the geometries of a layer as shapely's."""
    features = layer.getFeatures(request or QgsFeatureRequest())
    return shapely.from_wkb([bytes(f.geometry().asWkb()) for f in features if f.hasGeometry()])


def memory(kind, geometries, crs=DEGREES, **fields):
    """Return a layer in memory of shapely geometries, and lists of values as fields."""
    from isthmus.algorithms.layers.fields import LONG, REAL, TEXT, field

    made = QgsVectorLayer(kind, "layer", "memory")
    made.setCrs(system(crs))
    kinds = {str: TEXT, int: LONG, float: REAL}
    made.dataProvider().addAttributes(
        [field(name, kinds[type(values[0])]) for name, values in fields.items()]
    )
    made.updateFields()
    features = []
    for k, shape in enumerate(geometries):
        feature = QgsFeature(made.fields())
        geometry = QgsGeometry()
        geometry.fromWkb(shapely.to_wkb(shape))
        feature.setGeometry(geometry)
        feature.setAttributes([values[k] for values in fields.values()])
        features.append(feature)
    ok, _ = made.dataProvider().addFeatures(features)
    if not ok:
        sys.exit(f"no layer of type {kind} could be made")
    return made


def saved(path, geometries, crs=DEGREES, **fields):
    """Write polygons to a GeoPackage and return its path."""
    path.parent.mkdir(parents=True, exist_ok=True)
    options = QgsVectorFileWriter.SaveVectorOptions()
    options.layerName = path.stem
    kind = "MultiPolygon" if any(g.geom_type == "MultiPolygon" for g in geometries) else "Polygon"
    layer = memory(kind, geometries, crs, **fields)
    problem = QgsVectorFileWriter.writeAsVectorFormatV3(layer, str(path), layer.transformContext(), options)
    if problem[0] != QgsVectorFileWriter.WriterError.NoError:
        sys.exit(f"{path}: {problem[1]}")
    return path


def system(text):
    if text.startswith("+"):
        return QgsCoordinateReferenceSystem.fromProj(text + " +datum=WGS84 +units=m +type=crs")
    return QgsCoordinateReferenceSystem(text)


# --- Styles -----------------------------------------------------------------------------------------


def fill(layer, colour, outline="transparent", width=0.15):
    """Fill all polygons alike; return the layer."""
    style = {"color": colour, "outline_color": outline, "outline_width": str(width)}
    if outline == "transparent":
        style["outline_style"] = "no"
    layer.setRenderer(QgsSingleSymbolRenderer(QgsFillSymbol.createSimple(style)))
    return layer


def line(layer, colour=CUT, width=0.45):
    """Draw all lines alike; return the layer."""
    symbol = QgsLineSymbol.createSimple({"line_color": colour, "line_width": str(width), "capstyle": "round"})
    layer.setRenderer(QgsSingleSymbolRenderer(symbol))
    return layer


def coloured(parts, cuts, colours, outline="#8a857b", width=0.12, least=0.0):
    """Return the parts as a layer in which parts on both sides of a cut differ in colour.

    Parts are coloured from the largest to the smallest, each with the colour that its neighbours
    have not and that was used least so far.
    """
    from collections import Counter, defaultdict

    several = parts.fields().lookupField("source") >= 0
    geometries, keys = [], []
    for feature in parts.getFeatures():
        geometries.append(shapely.from_wkb(bytes(feature.geometry().asWkb())))
        keys.append((feature["source"] if several else 0, feature["part"]))
    beside = defaultdict(set)
    for feature in cuts.getFeatures():
        source = feature["source"] if several else 0
        a, b = (source, feature["part_a"]), (source, feature["part_b"])
        if a != b:
            beside[a].add(b)
            beside[b].add(a)
    chosen, used = {}, Counter()
    for k in np.argsort([-shape.area for shape in geometries]):
        part = keys[k]
        near = {chosen.get(other) for other in beside[part]}
        # and not that of a neighbour's neighbour, if it can be helped
        far = {chosen.get(one) for other in beside[part] for one in beside[other]}
        free = [c for c in range(len(colours)) if c not in near]
        best = [c for c in free if c not in far] or free or range(len(colours))
        chosen[part] = min(best, key=lambda c: (used[c], c))
        used[chosen[part]] += geometries[k].area
    layer = memory(
        "MultiPolygon" if any(g.geom_type == "MultiPolygon" for g in geometries) else "Polygon",
        geometries, parts.crs().authid() or DEGREES, colour=[chosen[key] for key in keys],
    )  # fmt: skip
    layer.setCrs(parts.crs())
    return classes(layer, "colour", dict(enumerate(colours)), outline, width)


def classes(layer, field, colours, outline="transparent", width=0.1):
    """Colour polygons by the values of a field."""
    categories = []
    for value, colour in colours.items():
        style = {"color": colour, "outline_color": outline, "outline_width": str(width)}
        if outline == "transparent":
            style["outline_style"] = "no"
        categories.append(QgsRendererCategory(value, QgsFillSymbol.createSimple(style), ""))
    layer.setRenderer(QgsCategorizedSymbolRenderer(field, categories))
    return layer


# --- Pictures ---------------------------------------------------------------------------------------


class Panel(NamedTuple):
    """One map of a picture.

    Attributes
    ----------
    layers : list of QgsVectorLayer
        The uppermost first.
    frame : tuple
        West, south, east, north of the map, in the coordinates of ``crs``.
    crs : str
    title : str
        Below the map.
    names : list of (text, x, y, options)
        Painted centred on a place given in ``names_crs``; options: size, angle, colour, italic,
        spacing, align ("left", "right").
    names_crs : str
    scale : float
        Length of the scale bar in metres; 0 for none.
    scale_text : str
        For a plan that is in no system.
    background : str
    """

    layers: list
    frame: tuple
    crs: str
    title: str = ""
    names: list = ()
    names_crs: str = DEGREES
    scale: float = 0
    background: str = WATER
    corner: str = "left"


def frame_of(crs, west, south, east, north):
    """Return the frame around a box of degrees in a projection."""
    transform = QgsCoordinateTransform(system(DEGREES), system(crs), QgsProject.instance())
    box = transform.transformBoundingBox(QgsRectangle(west, south, east, north))
    return box.xMinimum(), box.yMinimum(), box.xMaximum(), box.yMaximum()


def picture(name, panels, width=1200, gap=10, dpi=110, title_height=34, footer=""):
    """Draw panels side by side, in equal heights, to docs/pictures/NAME.png."""
    shares = [(p.frame[2] - p.frame[0]) / (p.frame[3] - p.frame[1]) for p in panels]
    height = round((width - gap * (len(panels) - 1)) / sum(shares))
    below = title_height if any(p.title for p in panels) else 0
    image = QImage(width, height + below, QImage.Format.Format_RGB32)
    image.fill(QColor("white"))
    painter = QPainter(image)
    painter.setRenderHints(QPainter.RenderHint.Antialiasing | QPainter.RenderHint.TextAntialiasing)
    left = 0
    for k, (panel, share) in enumerate(zip(panels, shares)):
        wide = width - left if k == len(panels) - 1 else round(share * height)
        _paint(painter, panel, left, wide, height, dpi)
        if panel.title:
            painter.setPen(QColor(INK))
            painter.setFont(_font(12.5))
            painter.drawText(
                QRectF(left, height + 2, wide, below - 2), Qt.AlignmentFlag.AlignCenter, panel.title
            )
        left += wide + gap
    painter.end()
    PICTURES.mkdir(parents=True, exist_ok=True)
    path = PICTURES / f"{name}.png"
    save(image, path)
    print(f"  {path.relative_to(ROOT)}: {width} x {image.height()}, {path.stat().st_size // 1000} kB")


def _paint(painter, panel, left, wide, height, dpi):
    settings = QgsMapSettings()
    settings.setLayers(panel.layers)
    settings.setDestinationCrs(system(panel.crs))
    settings.setExtent(QgsRectangle(*panel.frame))
    settings.setOutputSize(QSize(wide, height))
    settings.setOutputDpi(dpi)
    settings.setBackgroundColor(QColor(panel.background))
    settings.setFlag(QgsMapSettings.Flag.Antialiasing, True)
    job = QgsMapRendererParallelJob(settings)
    job.start()
    job.waitForFinished()
    if job.errors():
        sys.exit(f"a map could not be drawn: {[e.message for e in job.errors()]}")
    painter.save()
    painter.setClipRect(QRectF(left, 0, wide, height))
    painter.drawImage(left, 0, job.renderedImage())
    painter.translate(left, 0)
    to_map = QgsCoordinateTransform(system(panel.names_crs), system(panel.crs), QgsProject.instance())
    pixels = settings.mapToPixel()
    for text, x, y, *more in panel.names:
        place = pixels.transform(to_map.transform(QgsPointXY(x, y)))
        _name(painter, text, place.x(), place.y(), **(more[0] if more else {}))
    if panel.scale:
        _scale(painter, panel, settings, wide, height)
    painter.restore()


def _font(size, italic=False, bold=False, spacing=0.0):
    font = QFont(FONT)
    font.setPixelSize(round(size * 1.35))
    font.setItalic(italic)
    font.setBold(bold)
    if spacing:
        font.setLetterSpacing(QFont.SpacingType.AbsoluteSpacing, spacing)
    return font


def _name(
    painter, text, x, y, size=10.0, angle=0.0, colour=INK, italic=False, bold=False, spacing=0.0,
    align="centre", halo="#ffffff",
):  # fmt: skip
    """Paint a name with a halo; lines are parted by a line feed."""
    font = _font(size, italic, bold, spacing)
    metrics = QFontMetricsF(font)
    path, lines = QPainterPath(), text.split("\n")
    for k, one in enumerate(lines):
        wide = metrics.horizontalAdvance(one)
        at = {"centre": -wide / 2, "left": 0.0, "right": -wide}[align]
        base = metrics.ascent() / 2 - metrics.descent() / 3
        path.addText(QPointF(at, base + (k - (len(lines) - 1) / 2) * metrics.height()), font, one)
    painter.save()
    painter.translate(x, y)
    painter.rotate(-angle)
    if halo:
        edge = QColor(halo)
        edge.setAlpha(200)
        pen = QPen(edge, 3.2)
        pen.setJoinStyle(Qt.PenJoinStyle.RoundJoin)
        painter.strokePath(path, pen)
    painter.fillPath(path, QColor(colour))
    painter.restore()


def _scale(painter, panel, settings, wide, height):
    """A bar of a round length, true at the lower edge of the map."""
    metres = panel.scale
    extent = settings.visibleExtent()
    pixels = metres / (extent.width() / wide)
    y, x = height - 22, 18
    if panel.corner == "right":
        x = wide - 18 - pixels
    text = f"{metres / 1000:,.0f} km" if metres >= 1000 else f"{metres:g} m"
    painter.setPen(QPen(QColor(255, 255, 255, 200), 5))
    painter.drawLine(QPointF(x, y), QPointF(x + pixels, y))
    pen = QPen(QColor(INK), 1.6)
    pen.setCapStyle(Qt.PenCapStyle.FlatCap)
    painter.setPen(pen)
    painter.drawPolyline(QPointF(x, y - 5), QPointF(x, y), QPointF(x + pixels, y), QPointF(x + pixels, y - 5))
    _name(painter, text, x + pixels / 2, y - 12, size=9)


def save(image, path, colours=256):
    """Write an image with a palette of its most frequent colours: flat maps lose nothing to see."""
    size = image.width() * image.height()
    image = image.convertToFormat(QImage.Format.Format_RGB32)
    bits = image.constBits()
    bits.setsize(4 * size)
    pixels = np.frombuffer(bits, dtype="<u4") & 0xFFFFFF
    # count what looks alike as one, but keep the exact colour of each group's most frequent member
    exact, count = np.unique(pixels, return_counts=True)
    alike = (exact >> 19 & 31) << 10 | (exact >> 11 & 31) << 5 | exact >> 3 & 31
    order = np.lexsort((-count, alike))
    first = np.flatnonzero(np.diff(alike[order], prepend=-1))
    total = np.add.reduceat(count[order], first)
    best = exact[order[first]][np.argsort(-total)[:colours]]
    table = [int(0xFF000000 | c) for c in best]
    image.convertToFormat(QImage.Format.Format_Indexed8, table).save(str(path), "PNG", 0)
