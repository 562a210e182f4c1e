"""The map of 55,191 polygons: shared boundaries, greedy, annealing; time and memory.

    python tests/benchmarks/aggregation_scale.py [--steps 5000000] [--made 500000] [--tools]

Seconds are those of the processor. ``--made``: instead, a made coverage of so many areas, its shared
boundaries and greedy. ``--tools``: from GeoPackage to GeoPackage by the tools, greedy, and with ``--made``
the preparation before it.
"""

import argparse
import resource
import tempfile
from time import process_time

import numpy as np
import shapely
from aggregation_data import layer, problem_of, rings

from isthmus.core import metric
from isthmus.core.aggregation import coverage
from isthmus.core.aggregation.annealing import annealing
from isthmus.core.aggregation.greedy import greedy
from isthmus.core.aggregation.instance import costs, hierarchical_distance, problems


def without_nodes(xy, offsets):
    """Drop the vertices on straight lines: T-junctions then are no vertices of one side."""
    k = len(xy)
    after = np.arange(1, k + 1)
    after[offsets[1:] - 1] = offsets[:-1]
    before = np.empty(k, dtype=int)
    before[after] = np.arange(k)
    first, second = xy - xy[before], xy[after] - xy
    cross = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    kept = np.abs(cross) > 1e-9 * np.hypot(*first.T) * np.hypot(*second.T)
    ring = np.repeat(np.arange(len(offsets) - 1), np.diff(offsets))
    return xy[kept], np.append(0, np.cumsum(np.bincount(ring[kept], minlength=len(offsets) - 1)))


def made(count):
    """A coverage of so many areas: Voronoi cells of random points, in eight classes."""
    rng = np.random.default_rng(0)
    side = np.sqrt(count) * 100.0
    points = shapely.multipoints(rng.random((count, 2)) * side)
    cells = shapely.get_parts(shapely.voronoi_polygons(points, extend_to=shapely.box(0.0, 0.0, side, side)))
    # classes in patches, so that neighbours often have the same
    middle = shapely.get_coordinates(shapely.centroid(cells)) / 700.0
    wave = np.sin(middle[:, 0]) + np.sin(middle[:, 1]) + rng.normal(0.0, 0.7, len(cells))
    return cells, np.clip(np.floor(wave + 4.0), 0, 7).astype(int)


def by_tools(count):
    """Greedy as a tool: on the land cover, or on a made coverage and its pieces."""
    from many_polygons import Bench, memory
    from qgis.core import QgsFeature, QgsGeometry, QgsVectorFileWriter, QgsVectorLayer

    if count:
        shapes, values = made(count)
    else:
        shapes, values = layer("nlcd2011_zion_55191.gpkg", "landcover", ["class"])
        values = values[:, 0]
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(folder)
        areas = QgsVectorLayer("Polygon?crs=EPSG:32612&field=class:integer", "areas", "memory")
        fields, path = areas.fields(), f"{folder}/areas.gpkg"
        options = QgsVectorFileWriter.SaveVectorOptions()
        writer = QgsVectorFileWriter.create(
            path, fields, areas.wkbType(), areas.crs(), areas.transformContext(), options
        )
        for blob, value in zip(shapely.to_wkb(shapes).tolist(), values.tolist()):
            feature, geometry = QgsFeature(fields), QgsGeometry()
            geometry.fromWkb(blob)
            feature.setGeometry(geometry)
            feature.setAttributes([None, int(value)][-len(fields) :])
            writer.addFeature(feature)
        del writer, shapes
        print(f"layer written, peak memory {memory():.2f} GB", flush=True)
        if count:
            took, results = bench.run(
                "isthmus:prepareaggregation", path, CLASS="class", TAU=4.0, PLACES="Any", SMALLEST_PART=0
            )
            path = results["OUTPUT"]
            print(
                f"prepareaggregation: {took:.0f} s, {results['PIECE_COUNT']} pieces, "
                f"peak memory {memory():.2f} GB",
                flush=True,
            )
        settings = {"AREA_ID": "area_id"} if count else {}
        took, results = bench.run(
            "isthmus:aggregate",
            path,
            CLASS="class",
            THRESHOLD=200_000.0,
            METHOD="greedy",
            DISTANCE="equal" if count else "code",
            WEIGHT_BOUNDARY=30.0,
            WEIGHT_CENTRE=1e-4,
            **settings,
        )
        print(
            f"aggregate, greedy: {took:.1f} s, {results['REGION_COUNT']} regions, "
            f"peak memory {memory():.2f} GB",
            flush=True,
        )


def big(count):
    began = process_time()
    shapes, values = made(count)
    print(f"made {len(shapes)} areas: {process_time() - began:.0f} s", flush=True)
    began = process_time()
    problem = problem_of(
        shapes,
        values,
        np.arange(8),
        1.0 - np.eye(8),
        np.full(8, 200_000.0),
        change=1.0,
        boundary=30.0,
        centre=1e-4,
    )
    print(f"shared boundaries and spreads: {process_time() - began:.0f} s", flush=True)
    began = process_time()
    found = greedy(problem)
    took, faulty = process_time() - began, len(problems(problem, found))
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024**2
    print(f"greedy: {took:.0f} s, {len(found.core)} regions, {faulty} faults, peak memory {memory:.2f} GB")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--steps", type=int, default=5_000_000)
    parser.add_argument("--made", type=int, default=0)
    parser.add_argument("--tools", action="store_true")
    parser.add_argument("--threshold", type=float, default=200_000.0)
    options = parser.parse_args()
    if options.tools:
        return by_tools(options.made)
    if options.made:
        return big(options.made)
    shapes, values = layer("nlcd2011_zion_55191.gpkg", "landcover", ["class"])
    xy, offsets, owner = rings(shapes)

    def shared(xy, offsets):
        began = process_time()
        pairs, length = coverage.shared(coverage.cover(xy, offsets, owner), metric.planar())
        return len(pairs), length.sum(), process_time() - began

    print("shared boundaries: {} pairs, {:.0f} m, {:.1f} s".format(*shared(xy, offsets)))
    fewer, starts = without_nodes(xy, offsets)
    print(
        "without {} nodes: {} pairs, {:.0f} m, {:.1f} s".format(len(xy) - len(fewer), *shared(fewer, starts))
    )
    began = process_time()
    found = coverage.faults(coverage.cover(xy, offsets, owner))
    print(f"{len(found.overlaps)} overlaps, {len(found.gaps)} gaps, {process_time() - began:.1f} s")

    codes = np.unique(values[:, 0])
    distance = hierarchical_distance([str(code) for code in codes.tolist()])
    problem = problem_of(
        shapes,
        values[:, 0],
        codes,
        distance,
        np.full(len(codes), options.threshold),
        change=1.0,
        boundary=30.0,
        centre=1e-4,
    )
    runs = (
        ("greedy", lambda: greedy(problem)),
        (f"annealing, {options.steps} steps", lambda: annealing(problem, seed=1, iterations=options.steps)),
    )
    for name, run in runs:
        began = process_time()
        solution = run()
        took = process_time() - began
        memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024**2
        print(
            f"{name}: {took:.1f} s, {len(solution.core)} regions, "
            f"cost {costs(problem, solution).total:.6g}, {len(problems(problem, solution))} faults, "
            f"peak memory {memory:.2f} GB",
            flush=True,
        )


if __name__ == "__main__":
    main()
