"""Fuzz the tools that work on whole maps: prepare, aggregate, focus map, and the example models.

    ./run fuzz maps [--polygons 20000] [--seed 1] [--tool aggregate] [--crowd 100000] [CASE]

Hypothesis draws hostile maps and parameters, `maps_run` runs the tool as QGIS would, `maps_checks` tells
by other means what is wrong; `frame` does the rest.
"""

import math
import sys
from collections import Counter
from pathlib import Path
from random import Random

sys.path[:0] = [str(Path(__file__).resolve().parent)]

import frame  # noqa: E402
from hypothesis import strategies as st  # noqa: E402

import maps_layers as layers  # noqa: E402

# ---- cases


def weights(*some):
    return st.sampled_from(some)


cancels = st.one_of(*[st.none()] * 12, st.integers(1, 200))


@st.composite
def outputs(draw):
    """Where to write, and when to cancel."""
    output = draw(
        weights(
            *["memory"] * 30,
            "gpkg",
            "gpkg",
            "geojson",
            "shp",
            "unwritable",
            "folder",
            "full 3000",
            "full 30000",
            "full 100000",
        )
    )
    return output, draw(cancels)


def common(case, output, cancel):
    lossless = output in ("memory", "gpkg", "geojson")
    return {
        **case,
        "output": output,
        "cancel": cancel,
        "may_refuse": case.get("may_refuse") or not lossless or (output != "memory" and case["odd"]),
    }


@st.composite
def prepare_cases(draw):
    areas, name, _ = draw(layers.area_layers())
    output, cancel = draw(outputs())
    parameters = {
        "TAU": draw(weights(1.0, 1.2, 2.0, 4.0, 1e9)),
        "OBJECTIVE": draw(weights("MinSize", "MinSize", "MinLength")),
        "MIN_LENGTH": draw(weights(0.0, 0.0, 1.0, 1e300)),
        "MIN_HOLE": draw(weights(0.0, 0.0, 2.0, 1e18)),
        "NEW_VERTICES": draw(st.booleans()),
    }
    odd = name != "code"
    bad = draw(st.integers(0, 29)) == 0
    if bad:
        what = draw(weights("TAU", "MIN_LENGTH", "MIN_HOLE"))
        parameters[what] = draw(weights(float("nan"), -1.0, float("inf"), 0.0, "x", None))
    return common({
        "tool": "prepareaggregation", "layers": {"INPUT": areas}, "fields": {"CLASS": name}, "parameters": parameters,
        "outputs": ["OUTPUT", "ADJACENCY"], "may_refuse": bad, "odd": odd,
    }, output, cancel)  # fmt: skip


def table(fields, rows):
    return {"type": "None", "crs": "", "fields": fields, "rows": [[None, row] for row in rows]}


def as_text(value):
    """A class as the tools read it."""
    value = int(value) if isinstance(value, float) and value.is_integer() else value
    return None if value is None else str(value).strip() or None


@st.composite
def aggregate_cases(draw):
    small = draw(st.integers(0, 3)) == 0
    areas, name, _ = draw(layers.area_layers(2 if small else 5, True if small else None))
    classes = sorted({as_text(row[1][0]) for row in areas["rows"]} - {None})
    output, cancel = draw(outputs())
    rng = Random(draw(layers.seeds))
    bad = False
    theta = draw(weights(0.0, 0.7, 1.5, 2.5, 4.0, 8.0, 1e9, 1e18))
    parameters = {
        "THRESHOLD": theta, "DISTANCE": draw(weights("equal", "equal", "code", "table")),
        "WEIGHT_CHANGE": draw(weights(1.0, 1.0, 0.0, 0.3, 1e6)),
        "WEIGHT_BOUNDARY": draw(weights(0.0, 0.2, 1.0, 45.0)),
        "WEIGHT_CENTRE": draw(weights(0.0, 0.1, 1e-4, 3.0)),
        "BOUNDARY": draw(weights("regions", "classes")),
        "METHOD": draw(weights("greedy", "greedy", "annealing", "exact")),
        "SEED": draw(st.integers(0, 9)), "ITERATIONS": draw(weights(1, 500, 3000)), "SECONDS": 0.0,
        "REGIONS": draw(weights(0, 0, 0, 1, 3, 10**9)), "DECOMPOSE": draw(st.booleans()),
    }  # fmt: skip
    if parameters["METHOD"] == "exact":
        parameters["SECONDS"] = 5.0
    case = {
        "tool": "aggregate", "layers": {"INPUT": areas}, "fields": {"CLASS": name}, "parameters": parameters,
        "outputs": ["OUTPUT", "ASSIGNMENT"], "odd": name != "code", "thresholds": {}, "distance": parameters["DISTANCE"],
        "brute": True,
    }  # fmt: skip
    if draw(st.integers(0, 3)) == 0:
        rows = [
            [one, rng.choice((0.0, 1.0, 3.0, None, 1e300))]
            for one in classes + ["not there"]
            if rng.random() < 0.6
        ]
        case["thresholds"] = {one: value for one, value in rows}
        kind = draw(weights("double", "string"))
        rows = [[a, b if kind == "double" or b is None else repr(b)] for a, b in rows]
        case["layers"]["THRESHOLDS"] = table([["CLASS", "string"], ["threshold", kind]], rows)
    if classes and draw(st.integers(0, 7)) == 0 and "," not in classes[0]:
        parameters["EXCLUDED"] = f"{classes[0]}, not there,"
        case["thresholds"][classes[0]] = None
    if parameters["DISTANCE"] == "table":
        rows, distance = [], {}
        for a in classes:
            for b in classes:
                if a < b:
                    there, back = (rng.choice((0.0, 0.5, 1.0, 3.0)) for _ in range(2))
                    rows.append([a, b, there])
                    distance[f"{a}|{b}"] = there
                    if rng.random() < 0.7:  # else the other way is equal
                        rows.append([b, a, back])
                        distance[f"{b}|{a}"] = back
        rng.shuffle(rows)
        if draw(st.integers(0, 9)) == 0:
            bad = True
            rows = [row for row in rows if rng.random() < 0.8]
            if rows:
                rows[0][2] = rng.choice((-1.0, None, float("nan"), float("inf"), 1e308))
        rows.append(["not there", classes[0] if classes else "x", 1.0])
        case["layers"]["DISTANCES"], case["distance"] = (
            table([["from", "string"], ["to", "string"], ["distance", "double"]], rows),
            distance,
        )
    if draw(st.integers(0, 19)) == 0:
        bad = True
        what = draw(
            weights("THRESHOLD", "WEIGHT_CHANGE", "WEIGHT_BOUNDARY", "WEIGHT_CENTRE", "SECONDS", "REGIONS")
        )
        parameters[what] = draw(weights(float("nan"), -1.0, float("inf"), "x", 1e308))
        case["brute"] = False
    case["may_refuse"] = bad
    return common(case, output, cancel)


@st.composite
def focus_cases(draw, kinds=("areas", "areas", "lines", "crossing", "points")):
    """Lines, areas or points, a focus, and what else may be given."""
    crs = draw(weights(*["EPSG:3035"] * 18, "EPSG:25832", "", "EPSG:4326"))
    rng = Random(draw(layers.seeds))
    nx, ny = draw(st.integers(1, 6)), draw(st.integers(2, 5))
    rows = [[one, []] for one in layers.tessellation(
        draw(layers.seeds), draw(weights("lattice", "quads", "triangles", "voronoi")), nx, ny,
        draw(weights(0.0, 0.3, 0.6)), draw(weights(0.0, 0.3, 0.5)),
    )]  # fmt: skip
    layers.mutate(rows, draw(st.one_of(layers.gentle, layers.hostile)))
    what = draw(weights(*kinds))
    if what == "lines":
        rows = [
            [
                {
                    **one,
                    "type": "MultiLineString",
                    "parts": [[run] for part in one["parts"] for run in part],
                },
                [],
            ]
            if one
            else [None, []]
            for one, _ in rows
        ]
    elif what == "crossing":
        rows = [[{"type": "LineString", "dims": "", "parts": [[[
            [rng.uniform(0, nx), rng.uniform(0, ny)] for _ in range(rng.randint(1, 6))]]]}, []]
            for _ in range(rng.randint(1, 6))]  # fmt: skip
    elif what == "points":
        rows = [
            [{"type": "Point", "dims": one["dims"], "parts": [[[p]]]}, []]
            for one, _ in rows
            if one
            for p in layers.points_of(one)[:2]
        ]
    for key, row in enumerate(rows):
        row[1] = [key]
    fields = [["key", "integer"]]
    points = [p[:2] for one, _ in rows for p in layers.points_of(one)] or [[0.0, 0.0]]
    focus = []
    for _ in range(draw(weights(1, 1, 1, 2, 3))):
        shape = draw(
            weights(
                *["box"] * 8,
                *["face"] * 3,
                "all",
                "outside",
                "hole",
                "hole",
                "bow",
                "tiny",
                "tiny",
                "nothing",
                "nan",
                "curl",
                "curl",
            )
        )
        focus.append([_focus(rng, shape, rows, points), [0]])
    other_crs = draw(st.integers(0, 9)) == 0
    case = {
        "tool": "focusmap", "odd": False, "other_crs": other_crs,
        "layers": {
            "INPUT": layers.layer(rows, fields, crs, draw(layers.stores)),
            "FOCUS": layers.layer(focus, fields, "EPSG:4326" if other_crs else crs),
        },
        "parameters": {
            "SCALE": draw(weights(1.0, 1.0 + 1e-9, *[1.1, 1.3, 1.3, 1.5, 2.0] * 3, 3.0, 100.0, 0.5, 0.9, 0.1)),
            "SELECTION": draw(weights("MinSize", "MinSize", "MinLength", "Greedy", "Proximity", "None")),
            "TAU": draw(weights(1.0, 2.0, 4.0)), "FRAME": draw(weights(True, True, False)),
            "GROWTH": draw(weights(0.0, 0.0, 50.0)),
        },
        "outputs": ["OUTPUT", "EDGES_USED"], "may_refuse": True,
    }  # fmt: skip
    if draw(st.integers(0, 4)) == 0:
        lines = []
        for _ in range(draw(st.integers(0, 4))):
            a, b = rng.choice(points), rng.choice(points + [[1e3, 1e3], [float("nan"), 0.0]])
            lines.append([{"type": "LineString", "dims": "", "parts": [[[list(a), list(b)]]]}, [0]])
        case["layers"]["EDGES"] = (
            layers.layer(lines, fields, crs)
            if lines
            else {"type": "LineString", "crs": crs, "fields": fields, "rows": []}
        )
    if draw(st.integers(0, 4)) == 0:
        along = [[one, [k]] for k, one in enumerate(_along(rng, points))]
        case["layers"]["ALONG"] = [
            layers.layer(along, fields, crs),
            {"type": "Point", "crs": "EPSG:4326", "fields": fields, "rows": [[None, [0]]]},
        ]
        case["parameters"]["CARRIED"] = True
    if draw(st.integers(0, 19)) == 0:
        case["parameters"][draw(weights("SCALE", "TAU"))] = draw(
            weights(float("nan"), 0.0, -1.0, float("inf"), "x", 1e6)
        )
    return common(case, *draw(outputs()))


def _focus(rng, shape, rows, points):
    xs, ys = [p[0] for p in points], [p[1] for p in points]
    finite = [one for one in xs + ys if abs(one) < 1e290] or [0.0]
    lo, hi = min(finite), max(finite)
    size = (hi - lo) or 1.0

    def box(x, y, a, b):
        return [[x, y], [x + a, y], [x + a, y + b], [x, y + b], [x, y]]

    x, y = rng.choice(points)
    if shape == "face":
        faces = [one for one, _ in rows if one and one["type"] == "Polygon" and one["parts"][0]]
        return rng.choice(faces) if faces else None
    if shape == "nothing":
        return None
    if shape == "all":
        return layers.polygon(box(lo - size, lo - size, 3 * size, 3 * size))
    if shape == "outside":
        return layers.polygon(box(hi + size, hi + size, size, size))
    if shape == "nan":
        return layers.polygon([[x, y], [float("nan"), y], [x, y + 1.0], [x, y]])
    if shape == "tiny":
        return layers.polygon(box(x - 1e-9 * size, y - 1e-9 * size, 2e-9 * size, 2e-9 * size))
    a, b = rng.uniform(0.05, 0.4) * size, rng.uniform(0.05, 0.4) * size
    outline = box(x - a / 2, y - b / 2, a, b)
    if shape == "hole":
        return layers.polygon(outline, box(x - a / 4, y - b / 4, a / 2, b / 2))
    if shape == "bow":
        outline[1], outline[2] = outline[2], outline[1]
    if shape == "curl":  # through vertices of the map
        ring = [rng.choice(points) for _ in range(5)]
        outline = ring + ring[:1]
    return layers.polygon(outline)


def _along(rng, points):
    made = [None]
    for _ in range(rng.randint(0, 4)):
        line = [list(rng.choice(points)) + [rng.random()] for _ in range(rng.randint(1, 4))]
        made.append({"type": "LineString", "dims": "Z", "parts": [[line]]})
    return made


@st.composite
def aggregation_model_cases(draw):
    areas, name, _ = draw(layers.area_layers(4))
    _not_infinite(areas)
    parameters = {
        "TAU": draw(weights(1.0, 1.3, 2.0)), "THRESHOLD": draw(weights(0.0, 0.7, 2.5, 8.0)),
        "METHOD": draw(weights("greedy", "annealing")), "ITERATIONS": 500, "SEED": 1,
        "BOUNDARY": draw(weights("regions", "classes")), "DISTANCE": draw(weights("equal", "code")),
    }  # fmt: skip
    return {
        "tool": "prepare_and_aggregate", "layers": {"INPUT": areas}, "fields": {"CLASS": name}, "parameters": parameters,
        "outputs": ["aggregate:regions", "aggregate:areas"], "output": "memory", "cancel": draw(cancels), "may_refuse": False,
    }  # fmt: skip


def _not_infinite(layer):
    """QGIS 3.22 runs no model, not one of its own tools either, on a layer with infinite coordinates."""
    for geometry, _ in layer["rows"]:
        for p in layers.points_of(geometry):
            p[:] = [float("nan") if abs(c) == float("inf") else c for c in p]


@st.composite
def focus_model_cases(draw):
    case = draw(focus_cases(["areas"]))  # what can be partitioned
    inputs = {"map": case["layers"]["INPUT"], "focus": case["layers"]["FOCUS"]}
    for one in inputs.values():
        _not_infinite(one)
    parameters = {"scale": case["parameters"]["SCALE"], "tau": case["parameters"]["TAU"]}
    return {
        "tool": "partition_and_focus_map", "layers": inputs, "parameters": parameters, "output": "memory",
        "cancel": case["cancel"], "may_refuse": True,
        "outputs": ["partition:Parts", "focusmap:Focus map", "focusmap:Relevant edges"],
    }  # fmt: skip


TOOLS = {
    "prepareaggregation": prepare_cases(), "aggregate": aggregate_cases(), "focusmap": focus_cases(),
    "prepare_and_aggregate": aggregation_model_cases(), "partition_and_focus_map": focus_model_cases(),
}  # fmt: skip


def crowd(count, seed):
    """A map of so many small areas through each of the tools: what was counted, and what is wrong."""
    for case in _crowds(math.isqrt(count), seed):
        counts = Counter()
        yield counts, problem(case, counts)


def _crowds(side, number):
    """The cases; the focus is a corner of the map."""
    rows = [
        [one, [key]] for key, one in enumerate(layers.tessellation(number, "quads", side, side, 0.0, 0.02))
    ]
    rng = Random(number)
    focus = layers.polygon([[2, 2], [side / 5, 2], [side / 5, side / 5], [2, side / 5], [2, 2]])
    areas = layers.layer(
        [[one, [rng.choice("abcd"), key]] for one, (key,) in rows],
        [["code", "string"], ["key", "integer"]],
        "EPSG:25832",
        "gpkg",
    )
    base = {"layers": {"INPUT": areas}, "fields": {"CLASS": "code"}, "output": "gpkg", "cancel": None, "odd": False,
            "may_refuse": False}  # fmt: skip
    yield {
        **base,
        "tool": "prepareaggregation",
        "outputs": ["OUTPUT", "ADJACENCY"],
        "parameters": {"TAU": 2.0},
    }
    yield {
        **base, "tool": "aggregate", "outputs": ["OUTPUT", "ASSIGNMENT"], "thresholds": {}, "distance": "equal",
        "parameters": {
            "THRESHOLD": 8.0, "DISTANCE": "equal", "WEIGHT_CHANGE": 1.0, "WEIGHT_BOUNDARY": 0.2, "WEIGHT_CENTRE": 0.1,
            "BOUNDARY": "regions", "METHOD": "annealing", "SEED": 1, "ITERATIONS": 10**6, "SECONDS": 0.0, "REGIONS": 0,
            "DECOMPOSE": True,
        },
    }  # fmt: skip
    plain = [["key", "integer"]]
    yield {
        **base, "tool": "focusmap", "outputs": ["OUTPUT", "EDGES_USED"], "fields": {}, "other_crs": False,
        "layers": {"INPUT": layers.layer(rows, plain, "EPSG:25832"),
                   "FOCUS": layers.layer([[focus, [0]]], plain, "EPSG:25832")},
        "parameters": {"SCALE": 1.2, "SELECTION": "None", "TAU": 2.0, "FRAME": True, "GROWTH": 0.0},
    }  # fmt: skip


# ---- runs


def problem(case, counts):
    """Run a case; return what is wrong, '' if nothing, and count."""
    import maps_checks as checks
    from maps_run import run

    check = {
        "prepareaggregation": checks.check_prepare, "aggregate": checks.check_aggregate,
        "focusmap": checks.check_focus, "prepare_and_aggregate": checks.check_aggregation_model,
        "partition_and_focus_map": checks.check_focus_model,
    }[case["tool"]]  # fmt: skip
    out = run(case)
    wrong = check(case, out)
    tool = case["tool"]
    counts[f"{tool} cases"] += 1
    counts["polygons"] += polygons_of(case)
    for name, holds in (
        ("refused", out.refused),
        ("cancelled", out.feedback.isCanceled()),
        ("compared with the brute force", hasattr(out, "brute")),
        ("in files", case["output"] != "memory"),
    ):
        counts[f"{tool} {name}"] += bool(holds)
    vars(out).clear()  # QGIS keeps the frames of a run that failed, and what is in them
    return "\n".join(wrong)


def polygons_of(case):
    return len(case["layers"].get("INPUT", case["layers"].get("map"))["rows"])


def start():
    """Nothing: what a tool raises is seen by `maps_run`."""


def smaller(case, shows):
    """As few features in each layer, and as few parts, rings and points in each, as show the same."""
    for name, layer in case["layers"].items():
        if isinstance(layer, list):
            continue

        def make(rows, name=name, layer=layer):
            return {**case, "layers": {**case["layers"], name: {**layer, "rows": rows}}}

        rows = frame.fewer(layer["rows"], lambda rows: shows(make(rows)))
        for k, (geometry, values) in enumerate(rows):
            if not geometry or geometry["type"] not in ("Polygon", "MultiPolygon"):
                continue

            def closed(parts, k=k, geometry=geometry, values=values):
                parts = [[ring + ring[:1] for ring in part] for part in parts]
                return [*rows[:k], [{**geometry, "parts": parts}, values], *rows[k + 1 :]]

            parts = [[ring[:-1] for ring in part] for part in geometry["parts"]]
            if shows(make(closed(parts))):  # no ring was open
                rows = closed(frame.less(parts, lambda parts: shows(make(closed(parts))), 3))
        case = make(rows)
    return case


def dump(case):
    return case


load = dump


def after(count, seed, counts):
    return ()


if __name__ == "__main__":
    frame.main(sys.modules[__name__])
