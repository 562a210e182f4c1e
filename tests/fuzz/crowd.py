"""10^5 small features in one layer, from GeoPackage to GeoPackage."""

import math
import tempfile
import time
from collections import Counter, defaultdict
from pathlib import Path

import cases
import hostile
import numpy as np

ROOMS = np.array(
    [[0, 0], [10, 0], [10, 4.5], [12, 4.5], [12, 0], [22, 0], [22, 10], [12, 10], [12, 5.5],
     [10, 5.5], [10, 10], [0, 10]], dtype=float,
)  # fmt: skip
KINDS = {  # rings, and how many parts they have at tau 4
    "rooms": ([ROOMS], 3),
    "square": ([np.array(hostile.shapes.box(0, 0, 10, 10), dtype=float)], 1),
    "triangle": ([np.array([[0, 0], [9, 0], [4, 7]], dtype=float)], 1),
    "bowtie": ([np.array([[0, 0], [10, 10], [10, 0], [0, 10]], dtype=float)], 1),
    "nothing": ([], 1),
}


def run(count, seed):
    """Cut so many small polygons in one run and check every one; returns what was counted."""
    import processing
    from qgis.core import QgsVectorLayer

    rng = np.random.default_rng(seed)
    names = rng.choice(list(KINDS), count, p=[0.2, 0.5, 0.2, 0.05, 0.05]).tolist()
    rows = []
    for k, name in enumerate(names):
        shift = [30.0 * (k % 400), 30.0 * (k // 400)]
        rings = [ring + shift for ring in KINDS[name][0]]
        rows.append((hostile.write_wkb([rings]).hex() if rings else None, [k, f"n{k}"]))
    with tempfile.TemporaryDirectory(prefix="isthmus-fuzz-") as folder:
        layer = cases.make_layer(
            "crowd", "Polygon", "EPSG:3857", [("number", "Int"), ("name", "String")], rows
        )
        layer = cases.as_file(layer, "gpkg", folder)
        feedback = cases.Feedback()
        feedback.end = math.inf  # this one may take its time
        begin = time.process_time()
        results = processing.run(
            "isthmus:partition",
            {
                "INPUT": layer,
                "TAU": 4,
                "PLACES": "Any",
                "SMALLEST_PART": 0,
                "OUTPUT": f"{folder}/out.gpkg",
                "CUTS": f"{folder}/cuts.gpkg",
            },
            feedback=feedback,
        )
        seconds = time.process_time() - begin
        parts, area, reasons = Counter(), defaultdict(float), {}
        for row in QgsVectorLayer(results["OUTPUT"]).getFeatures():
            number = row["number"]
            assert row["name"] == f"n{number}"
            parts[number] += 1
            area[number] += row.geometry().area()
            reasons[number] = row["status"]
        for k, name in enumerate(names):
            assert parts[k] == KINDS[name][1], (name, parts[k])
            assert bool(reasons[k]) == (name in ("bowtie", "nothing")), (name, reasons[k])
            if name == "rooms":
                assert math.isclose(area[k], 202.0)
        assert results["CUT_COUNT"] == 2 * names.count("rooms")
        assert results["PART_COUNT"] == sum(parts.values())
        assert not list(Path(folder).glob("*-journal"))
    return Counter({"features of one crowd": count, "seconds for the crowd": round(seconds)})
