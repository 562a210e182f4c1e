"""How fast a layer of many polygons is, and polygons full of holes.

    ./run python tests/benchmarks/many_polygons.py [ROW ...] [--note]

Prints a row for each case, with what was to be reached: processor seconds of a tool on one core, GeoPackage to
GeoPackage, beside those of ``native:fixgeometries`` on the same layer in the same process before and after, in
the mean of three runs, and the peak of memory of that process. Layers are made (buildings, lakes, plates with
holes: see made.py), or taken from the maps of the aggregation experiments (see aggregation_data.py) and the
coasts of GSHHG (see gshhg.py); a row whose data are not there says so. --note writes the numbers to docs/measured/many_polygons.json.
"""

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

sys.path[:0] = [str(Path(__file__).resolve().parent), str(Path(__file__).resolve().parents[1])]
import conftest  # noqa: E402  (makes the package importable)
import made  # noqa: E402

sys.path.insert(0, str(conftest.ROOT / "tools"))
from measured import note  # noqa: E402

ROWS = {
    "buildings": "100,000 buildings: <= 5 x fixgeometries",
    "lakes": "50,000 made lakes, 110 vertices on average: <= 7 x fixgeometries",
    "gshhg_lakes": "50,000 lakes, those of GSHHG with 20 to 200 vertices repeated: <= 7 x fixgeometries",
    "land_cover": "55,191 land-cover polygons: <= 10 x fixgeometries",
    "prepare": "prepareaggregation on them: <= 20 s",
    "lakes_length": "10,000 lakes, MinLength with gap 0: <= 4 x MinSize",
    "multipolygon": "a multipolygon of 100,000 parts: <= 10 s, <= 1 GB",
    "cheese": "35,000 vertices in 7,800 round holes: <= 3 s",
    "plate_5000": "a polygon with 5,000 holes: <= 3 s",
    "plate_50000": "a polygon with 50,000 holes: <= 40 s",
}
EVERYWHERE = {"PLACES": "Any", "SMALLEST_PART": 0}  # the paper's problem
PATIENCE = 1200  # seconds for a row
ROUNDS = 3


def from_rings(polygons):
    """QgsGeometries of (coords, offsets)."""
    from isthmus.algorithms.layers import wkb
    from isthmus.core import wkb as core_wkb

    for coords, offsets in polygons:
        offsets = np.asarray(offsets)
        rings = np.array([0, len(offsets) - 1])
        data = core_wkb.polygons(
            np.ascontiguousarray(coords), np.arange(len(coords)), offsets, rings, [0], False
        )
        yield from wkb.geometries(data)


class Bench:
    """A QGIS with the tools, and a folder for layers."""

    def __init__(self, folder):
        from qgis.core import QgsApplication

        self.folder = folder
        self.application = QgsApplication([], False)
        self.application.initQgis()
        sys.path.append(str(Path(QgsApplication.pkgDataPath()) / "python" / "plugins"))
        from processing.core.Processing import Processing

        from isthmus.algorithms.provider import IsthmusProvider

        Processing.initialize()
        if not QgsApplication.processingRegistry().providerById("native"):  # Debian 12's does not register it
            from qgis.analysis import QgsNativeAlgorithms

            QgsApplication.processingRegistry().addProvider(QgsNativeAlgorithms())
        self.provider = IsthmusProvider()  # the registry does not keep it alive
        QgsApplication.processingRegistry().addProvider(self.provider)

    def layer(self, geometries, kind="Polygon"):
        """Write geometries to a GeoPackage; its path."""
        from qgis.core import QgsFeature, QgsVectorFileWriter, QgsVectorLayer

        layer = QgsVectorLayer(f"{kind}?crs=EPSG:3857&field=number:integer", "layer", "memory")
        features = []
        for number, geometry in enumerate(geometries):
            feature = QgsFeature(layer.fields())
            feature.setGeometry(geometry)
            feature.setAttributes([number])
            features.append(feature)
        layer.dataProvider().addFeatures(features)
        path = f"{self.folder}/input.gpkg"
        QgsVectorFileWriter.writeAsVectorFormatV3(
            layer, path, layer.transformContext(), QgsVectorFileWriter.SaveVectorOptions()
        )
        return path

    def run(self, tool, path, **parameters):
        """Processor seconds of a tool, from file to file, and its results."""
        import processing
        from qgis.core import QgsProcessingFeedback

        start = time.process_time()
        results = processing.run(
            tool,
            {"INPUT": path, "OUTPUT": f"{self.folder}/{tool.partition(':')[2]}.gpkg", **parameters},
            feedback=QgsProcessingFeedback(False),
        )
        return time.process_time() - start, results

    def partition(self, path, **parameters):
        return self.run(
            "isthmus:partition",
            path,
            **{"TAU": 4, **EVERYWHERE, "CUTS": f"{self.folder}/cuts.gpkg", **parameters},
        )


def measure(row):
    """Run one row in this process."""
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(folder)
        if row in ("buildings", "lakes", "gshhg_lakes", "land_cover"):
            geometries, kind = {
                "buildings": lambda: (from_rings(made.buildings(100_000)), "Polygon"),
                "lakes": lambda: (from_rings(made.lakes(50_000)), "Polygon"),
                "gshhg_lakes": lambda: (from_rings(real_lakes(50_000)), "Polygon"),
                "land_cover": land_cover,
            }[row]()
            path = bench.layer(geometries, kind)
            del geometries
            # in turn, for the processor's speed changes from one minute to the next
            fixes, runs = [bench.run("native:fixgeometries", path)[0]], []
            for _ in range(ROUNDS):
                own, results = bench.partition(path)
                runs.append(own)
                fixes.append(bench.run("native:fixgeometries", path)[0])
            peak = memory()
            seconds = sum(runs) / ROUNDS
            fix = (sum(fixes) - (fixes[0] + fixes[-1]) / 2) / ROUNDS  # before each run and after it
            return {
                "seconds": seconds,
                "fix": fix,
                "ratio": seconds / fix,
                "gb": peak,
                "parts": results["PART_COUNT"],
                "cuts": results["CUT_COUNT"],
            }
        if row == "prepare":
            path = bench.layer(*land_cover())
            seconds, results = bench.run("isthmus:prepareaggregation", path, CLASS="number")
            return {"seconds": seconds, "gb": memory(), "parts": results["PIECE_COUNT"]}
        if row == "lakes_length":
            path = bench.layer(from_rings(made.lakes(10_000)))
            fewest, _ = bench.partition(path)
            seconds, results = bench.partition(path, OBJECTIVE="MinLength", MAX_GAP=0)
            gap = results["COST"] - results["LOWER_BOUND"]
            return {
                "seconds": seconds,
                "size": fewest,
                "ratio": seconds / fewest,
                "gb": memory(),
                "gap": gap / results["COST"],
                "cuts": results["CUT_COUNT"],
            }
        if row == "multipolygon":
            from qgis.core import QgsGeometry

            whole = QgsGeometry.collectGeometry(list(from_rings(made.buildings(100_000))))
            path = bench.layer([whole], "MultiPolygon")
        else:
            made_row = {
                "cheese": lambda: made.cheese(7_800),
                "plate_5000": lambda: made.plate_with_holes(5_000),
                "plate_50000": lambda: made.plate_with_holes(50_000),
            }[row]
            path = bench.layer(from_rings([made_row()]))
        seconds, results = bench.partition(path)
        return {
            "seconds": seconds,
            "gb": memory(),
            "parts": results["PART_COUNT"],
            "cuts": results["CUT_COUNT"],
        }


def real_lakes(count):
    """Lakes of GSHHG in metres, each as often as it takes."""
    import itertools

    import gshhg

    rings = []
    for ring in gshhg.lakes("f", 20, 200):
        x, y = np.radians(ring).T
        rings.append(6_371_000.0 * np.column_stack((x * np.cos(y.mean()), y)))
    for ring in itertools.islice(itertools.cycle(rings), count):
        yield ring, [0, len(ring)]


def land_cover():
    """The land-cover polygons, and their type."""
    import aggregation_data
    from qgis.core import QgsGeometry

    path = aggregation_data.folder() / "nlcd2011_zion_55191.gpkg"
    import sqlite3

    database = sqlite3.connect(f"file:{path}?mode=ro&immutable=1", uri=True)
    (table,) = database.execute("select table_name from gpkg_contents").fetchone()
    (column,) = database.execute("select column_name from gpkg_geometry_columns").fetchone()
    envelope = [0, 32, 48, 48, 64]
    geometries = []
    for (blob,) in database.execute(f'select "{column}" from "{table}"'):
        geometry = QgsGeometry()
        geometry.fromWkb(blob[8 + envelope[(blob[3] >> 1) & 7] :])
        geometries.append(geometry)
    return geometries, "Polygon" if not geometries[0].isMultipart() else "MultiPolygon"


def memory():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024**2


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("rows", nargs="*", metavar="ROW", help=", ".join(ROWS))
    parser.add_argument("--note", action="store_true")
    parser.add_argument("--cell", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.cell:
        print(json.dumps(measure(options.cell)))
        sys.stdout.flush()
        os._exit(0)  # QGIS may crash when Python takes it down
    found = {"source": "many_polygons.py --note"}
    for row in options.rows or ROWS:
        print(ROWS[row], flush=True)
        done = subprocess.run(
            [sys.executable, __file__, "--cell", row],
            capture_output=True,
            encoding="utf-8",
            timeout=PATIENCE,
        )
        lines = done.stdout.strip().splitlines()
        if done.returncode or not lines:
            print("   ", (done.stderr.strip().splitlines() or ["nothing came back"])[-1], flush=True)
            continue
        found[row] = {key: round(value, 4) for key, value in json.loads(lines[-1]).items()}
        print("   ", ", ".join(f"{key} {value:,.4g}" for key, value in found[row].items()), flush=True)
    if options.note:
        note("many_polygons", found)


if __name__ == "__main__":
    main()
