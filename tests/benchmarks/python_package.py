"""What the Python package takes beside the core, and what a second process gains.

In a virtual environment with the package and what the rows need:

    pip install '.[geopandas,pythoncdt]' dask-geopandas distributed pyarrow
    python tests/benchmarks/python_package.py series [COUNT]
    python tests/benchmarks/python_package.py cluster [COUNT]

``series``: processor seconds of the forest of the core (rings in arrays to parts in arrays, chunk by chunk), and
of ``isthmus.partition`` on a GeoSeries of the same buildings, three times in turns, with natural candidates and
with every diagonal. ``cluster``: a GeoParquet folder of so many buildings cut by one process, and by
map_partitions on a local cluster of two, every diagonal, results compared; seconds by the clock and of the processors, and the
peak of memory of each process. --note writes the numbers to docs/measured/python_package.json.
"""

import argparse
import json
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import shapely

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parents[1] / "tools")]
TILE = 50_000  # buildings that are made; larger maps repeat them
FILES = 20


def buildings(count):
    """So many buildings as polygons."""
    import made

    tile = np.array(
        [
            shapely.Polygon(coords[: offsets[1]], [coords[a:b] for a, b in zip(offsets[1:-1], offsets[2:])])
            for coords, offsets in made.buildings(min(count, TILE))
        ]
    )
    wide = np.ptp(shapely.get_coordinates(tile)[:, 0]) + 100.0
    copies = [shapely.transform(tile, lambda xy, k=k: xy + (k * wide, 0.0)) for k in range(-(-count // TILE))]
    return np.concatenate(copies)[:count]


def forest(polygons, natural, tau):
    """Processor seconds of the core, and its numbers of parts and cuts."""
    from isthmus._geometry import read_polygons
    from isthmus.core.partition import solve
    from isthmus.core.partition.features import CHUNK_FEATURES

    seconds, parts, cuts = 0.0, 0, 0
    for start in range(0, len(polygons), CHUNK_FEATURES):
        own = polygons[start : start + CHUNK_FEATURES]
        rings, smallest = read_polygons(own).rings, 0.01 * shapely.area(own) if natural else 0.0
        begun = time.process_time()
        prepared = solve.prepare(rings, natural=natural, smallest=smallest)
        selection = solve.select(prepared, tau, with_dilation=False)
        found = solve.finish(prepared, selection)
        seconds += time.process_time() - begun
        parts, cuts = parts + len(found.parts.area), cuts + len(selection.selected)
    return seconds, parts, cuts


def series(count):
    """The row of a GeoSeries."""
    import geopandas

    import isthmus

    polygons = buildings(count)
    given = geopandas.GeoSeries(polygons, crs=3857)
    rows = {}
    for places in ("Natural", "Any"):
        core, package = [], []
        options = {"tau": 3, "places": places, "smallest_part": 1 if places == "Natural" else 0}
        for _ in range(3):
            seconds, parts, cuts = forest(polygons, places == "Natural", 3.0)
            core.append(seconds)
            begun = time.process_time()
            found = isthmus.partition(given, **options)
            package.append(time.process_time() - begun)
            assert (len(found.parts), len(found.cuts)) == (parts, cuts)
        ratio = statistics.median(b / a for a, b in zip(core, package))
        rows[places.lower()] = {
            "core": min(core),
            "package": min(package),
            "ratio": ratio,
            "parts": parts,
            "cuts": cuts,
        }
        print(f"{places}: core {core}, package {package}, ratio {ratio:.3f}; {parts} parts, {cuts} cuts")
    return rows


def parts_of(table):
    import isthmus

    # every diagonal: the quickest that there is, so that handing over weighs most
    return isthmus.partition(table, tau=3, places="Any", smallest_part=0).parts


def usage():
    own = resource.getrusage(resource.RUSAGE_SELF)
    return {"processor": own.ru_utime + own.ru_stime, "gb": own.ru_maxrss / 2**20}


def alone(folder):
    """All of it in this process."""
    import geopandas
    import pandas

    begun = time.perf_counter()
    table = pandas.concat([geopandas.read_parquet(file) for file in sorted(Path(folder).glob("*.parquet"))])
    parts_of(table).to_parquet(f"{folder}.one.parquet")
    return {"seconds": time.perf_counter() - begun, **usage()}


def together(folder):
    """By two workers."""
    import dask_geopandas
    from dask.distributed import Client

    begun = time.perf_counter()
    with Client(n_workers=2, threads_per_worker=1, dashboard_address=None) as client:
        started = time.perf_counter() - begun
        table = dask_geopandas.read_parquet(folder)
        table.map_partitions(parts_of, meta=parts_of(table._meta)).to_parquet(f"{folder}.two")
        workers = list(client.run(usage).values())
    return {
        "seconds": time.perf_counter() - begun,
        "start": started,
        "processor": usage()["processor"] + sum(worker["processor"] for worker in workers),
        "gb": max(worker["gb"] for worker in workers),
        "scheduler_gb": usage()["gb"],
    }


def same(folder):
    """Whether both made the same parts; their number."""
    import geopandas
    import pandas

    one = geopandas.read_parquet(f"{folder}.one.parquet")
    two = pandas.concat(
        [
            geopandas.read_parquet(file)
            for file in sorted(
                Path(f"{folder}.two").glob("*.parquet"), key=lambda f: int(f.name.split(".")[1])
            )
        ]
    )
    assert list(one.columns) == list(two.columns)
    assert shapely.equals_identical(one.geometry.to_numpy(), two.geometry.to_numpy()).all()
    for column in one.columns.drop(one.geometry.name):
        assert one[column].equals(two[column]), column
    assert one.index.equals(two.index)
    return len(one)


def cluster(count):
    """The row of two workers."""
    import geopandas

    with tempfile.TemporaryDirectory() as scratch:
        folder = f"{scratch}/buildings"
        Path(folder).mkdir()
        table = geopandas.GeoDataFrame({"number": np.arange(count)}, geometry=buildings(count), crs=3857)
        for k, own in enumerate(np.array_split(np.arange(count), FILES)):
            table.iloc[own].to_parquet(f"{folder}/{k:02}.parquet")
        del table
        rows = {"count": count}
        for name in ("alone", "together"):  # each in a process of its own, for its peak of memory
            done = subprocess.run(
                [sys.executable, __file__, name, folder], stdout=subprocess.PIPE, encoding="utf-8", check=True
            )
            rows[name] = json.loads(done.stdout.splitlines()[-1])
            print(name, rows[name])
        rows["parts"] = same(folder)
        print(f"the same {rows['parts']} parts")
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("row", choices=("series", "cluster", "alone", "together"))
    parser.add_argument("what", nargs="?", default="100000")
    parser.add_argument("--note", action="store_true")
    options = parser.parse_args()
    if options.row in ("alone", "together"):
        print(json.dumps({"alone": alone, "together": together}[options.row](options.what)))
        return
    found = {"series": series, "cluster": cluster}[options.row](int(options.what))
    if options.note:
        from measured import note

        note("python_package", {f"{options.row}_{options.what}": found})


if __name__ == "__main__":
    main()
