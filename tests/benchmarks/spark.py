"""The lines for Spark of docs/more_than_one_machine.md, on local[2], against one process.

In an environment with Java: ``pip install '.[pythoncdt]' pyspark pandas pyarrow``, then
``python tests/benchmarks/spark.py [POLYGONS]``.
"""

import os
import sys

import numpy as np
import pandas as pd
import shapely
from pyspark.sql import SparkSession

import isthmus

ROOMS = np.array(
    [(0, 0), (10, 0), (10, 4.5), (12, 4.5), (12, 0), (22, 0), (22, 10), (12, 10), (12, 5.5), (10, 5.5)]
    + [(10, 10), (0, 10), (0, 0)]
)


def parts_of(tables):
    for table in tables:
        found = isthmus.partition(shapely.from_wkb(table["wkb"].to_numpy()), tau=3)
        of = found.part_fields["source"]
        yield pd.DataFrame({"id": table["id"].to_numpy()[of], "wkb": shapely.to_wkb(found.parts)})


def main(count=100_000):
    random = np.random.default_rng(1)
    place = random.uniform(0.0, 1e5, (count, 1, 2))
    table = pd.DataFrame(
        {
            "id": np.arange(count),
            "wkb": shapely.to_wkb(shapely.polygons(ROOMS * random.uniform(0.5, 2.0, (count, 1, 2)) + place)),
        }
    )
    os.environ.setdefault("PYSPARK_PYTHON", sys.executable)  # not the first python3 that a worker finds
    session = SparkSession.builder.master("local[2]").config("spark.ui.enabled", "false").getOrCreate()
    dealt = session.createDataFrame(table).repartition(8).mapInPandas(parts_of, "id long, wkb binary")
    found = [(row.id, bytes(row.wkb)) for row in dealt.collect()]
    alone = [row for part in parts_of([table]) for row in zip(part["id"].tolist(), part["wkb"])]
    assert sorted(found) == sorted(alone) and len(alone) > count
    print(f"{count:,} polygons, {len(alone):,} parts, the same by Spark and by one process")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
