"""How fast the partition is, beside other things one could do with the same polygon.

    ./run python tests/benchmarks/partition_speed.py [--quick] [--note] [--columns triangle pythoncdt ...]

Prints one table: coasts of GSHHG (see gshhg.py for the package to install) from 1,000 to 1,160,925 vertices, and a corridor and a spiral
of the same size, whose dual trees are as deep as they are long. Each cell is a process of its own,
and the median of three runs in it (one where a run takes more than 20 s). Seconds are those of the
processor, so that other programs disturb less; all of this runs on one core. Memory is the peak of
the process, 0.3 GB for reading GSHHG included. The slow columns are left out for the corridor and
the spiral, where they take more than ten minutes, and with --quick at more than 50,000 vertices.
--note writes the numbers to docs/measured/partition_speed.json, from where the README takes them.
"""

import argparse
import json
import re
import resource
import statistics
import subprocess
import sys
import time
from pathlib import Path

import gshhg
import numpy as np
import shapely

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import conftest  # noqa: E402  (makes the package importable)

sys.path.insert(0, str(conftest.ROOT / "tools"))
from measured import note, results  # noqa: E402

TAU = 4.0
SIZES = (1000, 10000, 100000, 10**9)
COLUMNS = {
    "triangle": "Triangle alone",
    "pythoncdt": "pythoncdt, with an inside test of our own",
    "shapely": "shapely's CDT",
    "core": "partition (core)",
    "rest": "of it all but the engine",
    "tool": "isthmus:partition, layer to layer",
    "geopackage": "the same, GeoPackage to GeoPackage",
    "new_vertices": "the same with new vertices",
    "natural": "default parameters, degrees where it is a coast",
    "hierarchy": "isthmus:hierarchy, the same way",
    "subdivide": "native:subdivide",
    "opening": "buffer opening",
}
SLOW = ("shapely", "opening")
DEEP = ("corridor", "spiral")
PATIENCE = 300  # seconds for a cell


def corridor(n):
    """A winding strip of constant width: its dual tree is a path."""
    t = np.arange(n // 2, dtype=float)
    y = 3.0 * np.sin(t / 50.0)
    return np.concatenate((np.column_stack((t + 0.3, y - 1.0)), np.column_stack((t, y + 1.0))[::-1]))


def spiral(n):
    """A strip rolled up."""
    angle = np.sqrt(2.0 * np.arange(1, n // 2 + 1))
    around = np.column_stack((np.cos(angle), np.sin(angle)))
    return np.concatenate(((angle + 3.0)[:, None] * around, ((angle + 5.0)[:, None] * around)[::-1]))


def polygons():
    coasts = gshhg.coasts("f")
    rings = {}
    for size in SIZES:
        identity, ring = gshhg.nearest(coasts, size)
        rings[f"coast {identity}, {len(ring):,}"] = ring
    largest = max(map(len, rings.values()))
    for make in (corridor, spiral):
        rings[f"{make.__name__}, {len(make(largest)):,}"] = make(largest)
    return rings


def timed(call):
    """Median processor seconds of three calls (one if it is slow), and the last result."""
    seconds = []
    while len(seconds) < 3 and sum(seconds) < 20:
        start = time.process_time()
        result = call()
        seconds.append(time.process_time() - start)
    return statistics.median(seconds), result


def measure(column, ring):
    """One cell: (seconds, what came out of it)."""
    offsets = np.array([0, len(ring)])
    if column == "triangle":
        import triangle

        following = np.roll(np.arange(len(ring)), -1)
        segments = np.column_stack((np.arange(len(ring)), following)).astype(np.int32)
        graph = {"vertices": ring, "segments": segments}
        seconds, result = timed(lambda: triangle.triangulate(graph, "pQ"))
        return seconds, f"{len(result['triangles']):,} triangles"
    if column == "pythoncdt":
        from isthmus.core.partition import engines

        following = np.roll(np.arange(len(ring)), -1)
        segments = np.column_stack((np.arange(len(ring)), following))
        ring = ring if shapely.is_ccw(shapely.linearrings(ring)) else np.ascontiguousarray(ring[::-1])
        ends = [0, len(ring)]
        seconds, result = timed(lambda: engines.triangulate("pythoncdt", ring, ends, segments, ends))
        return seconds, f"{len(result[0]):,} triangles"
    if column == "shapely":
        shape = shapely.Polygon(ring)
        seconds, result = timed(lambda: shapely.constrained_delaunay_triangles(shape))
        return seconds, f"{len(result.geoms):,} triangles"
    if column == "opening":
        shape = shapely.Polygon(ring)
        width = shape.area**0.5 / 2000.0
        seconds, result = timed(lambda: shape.buffer(-width).buffer(width))
        return seconds, f"{shapely.get_num_geometries(result):,} pieces"
    if column in ("core", "rest"):
        from isthmus.core.partition import engines
        from isthmus.core.partition.solve import partition

        inside, call = [], engines.triangulate

        def clocked(*arguments, **more):
            start = time.process_time()
            try:
                return call(*arguments, **more)
            finally:
                inside.append(time.process_time() - start)

        engines.triangulate = clocked
        seconds, result = timed(lambda: partition(ring, offsets, TAU))
        if column == "rest":
            seconds -= statistics.median(inside)
        return seconds, f"{(result.role == 0).sum():,} cuts"
    return measure_in_qgis(column, ring)


def measure_in_qgis(column, ring):
    """The same for tools of QGIS."""
    import struct
    import tempfile

    from qgis.core import (
        QgsApplication,
        QgsFeature,
        QgsGeometry,
        QgsProcessingFeedback,
        QgsVectorFileWriter,
        QgsVectorLayer,
    )

    application = QgsApplication([], False)
    application.initQgis()
    sys.path.append(str(Path(QgsApplication.pkgDataPath()) / "python" / "plugins"))
    import processing
    from processing.core.Processing import Processing

    from isthmus.algorithms.provider import IsthmusProvider

    Processing.initialize()
    provider = IsthmusProvider()  # the registry does not keep it alive
    QgsApplication.processingRegistry().addProvider(provider)
    closed = np.concatenate((ring, ring[:1]))
    geometry = QgsGeometry()
    geometry.fromWkb(struct.pack("<BIII", 1, 3, 1, len(closed)) + closed.tobytes())
    feature = QgsFeature()
    feature.setGeometry(geometry)
    # a coast as it comes; the other columns compare with Triangle, which knows no ellipsoid
    degrees = column in ("natural", "hierarchy") and np.abs(ring[:, 1]).max() <= 90.0
    layer = QgsVectorLayer(f"Polygon?crs=EPSG:{4326 if degrees else 3857}", "layer", "memory")
    layer.dataProvider().addFeature(feature)
    with tempfile.TemporaryDirectory() as folder:
        parameters = {"INPUT": layer, "OUTPUT": "memory:"}
        if column == "geopackage":
            path = folder + "/layer.gpkg"
            QgsVectorFileWriter.writeAsVectorFormatV3(
                layer, path, layer.transformContext(), QgsVectorFileWriter.SaveVectorOptions()
            )
            layer = None
            parameters = {"INPUT": path, "OUTPUT": folder + "/p.gpkg", "CUTS": folder + "/c.gpkg"}
        if column == "subdivide":
            tool, more = "native:subdivide", {"MAX_NODES": 256}
        else:
            tool, more = "isthmus:partition", {"TAU": TAU, "PLACES": "Any", "SMALLEST_PART": 0}
            if column == "natural":
                more = {}
            if column == "hierarchy":
                tool, more = "isthmus:hierarchy", {}
            if column == "new_vertices":
                more["NEW_VERTICES"] = True
            parameters.setdefault("CUTS", "memory:")
        seconds, results = timed(
            lambda: processing.run(tool, {**parameters, **more}, feedback=QgsProcessingFeedback())
        )
        if column == "subdivide":
            (subdivided,) = results["OUTPUT"].getFeatures()
            pieces = subdivided.geometry()
            new = pieces.constGet().nCoordinates() - len(ring)
            return seconds, f"{pieces.constGet().numGeometries():,} boxes, {new:,} vertices more"
        return seconds, f"{results['PART_COUNT']:,} parts"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--note", action="store_true")
    parser.add_argument("--columns", nargs="+", choices=COLUMNS, default=list(COLUMNS))
    parser.add_argument("--cell", nargs=2, help=argparse.SUPPRESS)
    options = parser.parse_args()
    rings = polygons()
    if options.cell:
        column, name = options.cell
        seconds, result = measure(column, rings[name])
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024**2
        print(json.dumps([seconds, result, peak]))
        sys.stdout.flush()
        import os

        os._exit(0)  # QGIS may crash when Python takes it down
    for name, ring in rings.items():
        print(f"\n{name} vertices, tau = {TAU:g}")
        baseline, noted = None, {"vertices": len(ring)}
        for column in options.columns:
            label = COLUMNS[column]
            if column in SLOW and (name.startswith(DEEP) or options.quick and len(ring) > 50000):
                continue
            command = [sys.executable, __file__, "--cell", column, name]
            try:
                done = subprocess.run(command, capture_output=True, encoding="utf-8", timeout=PATIENCE)
            except subprocess.TimeoutExpired:
                print(f"  {label:36}not done after {PATIENCE} s", flush=True)
                continue
            if done.returncode:
                print(f"  {label:36} failed: {done.stderr.strip().splitlines()[-1:]}")
                continue
            seconds, result, peak = json.loads(done.stdout.strip().splitlines()[-1])
            baseline = baseline or seconds
            numbers = [int(word.replace(",", "")) for word in re.findall(r"\d[\d,]*", result)]
            noted[column] = {"seconds": round(seconds, 3), "gb": round(peak, 2), "count": numbers[0]}
            if len(numbers) > 1:
                noted[column]["new"] = numbers[1]
            print(
                f"  {label:36}{seconds:9.3f} s{seconds / baseline:8.2f} x Triangle{peak:7.2f} GB   {result}",
                flush=True,
            )
        if options.note:
            kind = "eurasia" if "0-E" in name else name.split(",")[0].replace(" ", "_")
            noted = {
                **results().get("partition_speed", {}).get(kind, {}),
                **noted,
            }  # of columns not asked for
            note("partition_speed", {kind: noted, "source": "partition_speed.py --note"})


if __name__ == "__main__":
    main()
