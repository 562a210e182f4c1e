"""What must hold after every run, found out from the layers alone.

Tiling is proven by half-edges: every directed edge of the input's boundary borders one part, every cut
one part on each side, and no part has any other edge. The winding numbers of the parts then add up to
that of the polygon, and as each part is valid, and has its interior on the left, parts neither overlap
nor leave a gap. No tolerance is involved.
"""

import math
import traceback
from collections import Counter, defaultdict
from fractions import Fraction
from html.parser import HTMLParser
from typing import NamedTuple

import brute_force
import checker
import hostile
import numpy as np
import shapely
from cases import BAD_WEIGHTS, BY_FEATURE, WEIGHTS, run
from isthmus.algorithms.base import LARGEST
from isthmus.algorithms.partition.solving import measure_of
from isthmus.core import metric
from qgis.core import NULL, QgsDistanceArea, QgsGeometry, QgsProcessingException, QgsWkbTypes

CLOSE = 1e-9
EXTRA = {
    "partition": 6,
    "partitionbudget": 7,
    "hierarchy": 7,
}  # fields of a part besides those of its feature
SOLVABLE_REASONS = (  # why a valid polygon may not be solved, and what must be so then
    ("tau must be a number", lambda case, polygon: isinstance(case.parameters.get("TAU"), dict)),
    ("the budget must be", lambda case, polygon: isinstance(case.parameters.get("BUDGET"), dict)),
    ("the budget of", lambda case, polygon: case.tool == "partitionbudget"),
    ("the weight of candidate", lambda case, polygon: case.parameters["OBJECTIVE"] == "MinWeight"),
    ("do not connect", lambda case, polygon: len(polygon) > 1 and (
        case.lines is not None or case.parameters["MIN_HOLE"] > 0.0 or not plain(case))),
    ("could not be triangulated", lambda case, polygon: too_fine(polygon)),
)  # fmt: skip


def plain(case):
    """Whether it is the paper's problem, with lengths of the outline as it is."""
    p = case.parameters
    return p.get("PLACES", "Any") == "Any" and not p.get("SMALLEST_PART", 0.0)


class Counts(Counter):
    """What was looked at."""


def check(case, outcome, rng):
    """Raise AssertionError where something does not hold.

    Returns
    -------
    Counts
    """
    counts = Counts(runs=1)
    counts[f"tool {case.tool}"] += 1
    counts[f"{case.source} to {case.sink}"] += 1
    check_errors(case, outcome, counts)
    if case.sink != "memory":
        check_files(case, outcome)
    if outcome.error is not None:
        return counts
    features = list(outcome.source.getFeatures())
    counts["features"] += len(features)
    if case.cancel is not None and outcome.feedback.isCanceled():
        check_cancelled(case, outcome, features, counts)
        return counts
    if case.tool == "tradeoff":
        check_tradeoff(case, outcome, features, counts, rng)
    elif case.tool == "hierarchy":
        check_hierarchy(case, outcome, features, counts, rng)
    else:
        answer = check_cutting(case, outcome, features, counts, rng)
        if case.twin and case.sink == "memory":
            check_twin(case, answer, features, counts, rng)
    return counts


# ---------------------------------------------------------------- errors


def check_errors(case, outcome, counts):
    """Only QgsProcessingException, only where there is a reason, and in words."""
    assert not outcome.feedback.late, "it takes far too long"
    assert not outcome.warnings, outcome.warnings[:3]
    for error in outcome.raised:
        assert isinstance(error, QgsProcessingException), (
            repr(error) + "\n" + "".join(traceback.format_tb(error.__traceback__)[-3:])
        )
    for text in [*outcome.feedback.warnings, *outcome.feedback.errors, outcome.error or "x"]:
        assert text.strip() and "Traceback" not in text and "object at 0x" not in text, text
    refused = refusal(case)
    if outcome.error is None:
        assert not refused, f"{refused} was accepted"
        assert case.sink != "nowhere"
        return
    if refused:
        counts["refused parameters"] += 1
        assert refused in outcome.error, (refused, outcome.error)
        return
    if case.room is not None or case.sink == "nowhere":
        words = ("could not be written", "could be written", "Could not create layer")
        assert any(w in outcome.error for w in words), outcome.error
        counts["runs on a full disk"] += case.room is not None
        counts["runs to nowhere"] += case.sink == "nowhere"
        return
    # the format may not take these fields or values; else a run may not fail
    odd = (case.source, case.sink) != ("memory",) * 2 and case.fields[:1] != [("name", "String")]
    odd |= case.sink in ("shp", "geojson") and "non-finite" in outcome.error
    odd |= case.sink == "shp" and "non-polygon" in outcome.error  # GDAL 3.8 at what is empty
    assert odd and len(outcome.error) > 30, outcome.error
    counts["refused by the format"] += 1


def check_files(case, outcome):
    """No lock is left, and nothing at all of a run that was cancelled or failed."""
    left = [path.name for path in outcome.folder.iterdir() if not path.name.startswith("in.")]
    locks = [name for name in left if name.endswith(("-journal", "-wal", "-shm"))]
    assert not locks or outcome.error is None, locks
    if outcome.error is not None or outcome.feedback.isCanceled():
        # what QGIS itself could not even create may leave an empty file
        failed = outcome.error.partition("Could not create layer ")[2] if outcome.error else ""
        left = [name for name in left if f"/{name.split('.')[0]}." not in failed]
        assert not left, f"left behind: {sorted(left)}: {outcome.error}"


def refusal(case):
    """The parameter that must be refused, or ''."""
    p = case.parameters
    for name, least in (("TAU", 1.0), ("BUDGET", 0.0), ("TAU_MIN", 1.0)):
        value = p.get(name, least)
        if not isinstance(value, dict) and not least <= value <= LARGEST:
            return name
    high = p.get("TAU_MAX", 0.0)
    if not (high == 0.0 or high >= p["TAU_MIN"]):
        return "TAU_MAX"
    for name in ("MIN_LENGTH", "MIN_HOLE"):
        if not 0.0 <= p[name] <= (LARGEST if name == "MIN_HOLE" else math.inf):
            return name
    if p["OBJECTIVE"] == "MinWeight" and p["WEIGHT"] in BAD_WEIGHTS:
        return "WEIGHT"
    return ""


# ---------------------------------------------------------------- reading


class Feature:
    """A feature of the source, as the checks need it.

    Attributes
    ----------
    polygons : list of polygons
        Of rings of rows, without a closing row that is the same bit for bit; none empty.
    """

    def __init__(self, feature, crs):
        self.crs = crs
        self.id, self.attributes = feature.id(), feature.attributes()
        self.geometry = feature.geometry()
        self.polygons = polygons_of(self.geometry)
        self.usable = [usable(polygon) for polygon in self.polygons]


def linear(geometry):
    abstract = geometry.constGet()
    return abstract.segmentize() if QgsWkbTypes.isCurvedType(abstract.wkbType()) else abstract


def polygons_of(geometry):
    if geometry.isNull() or geometry.isEmpty():
        return []
    polygons = hostile.read_wkb(bytes(linear(geometry).asWkb()))
    polygons = [[_open(ring) for ring in rings] for rings in polygons]
    return [rings for rings in polygons if sum(map(len, rings))]


def _open(ring):
    if len(ring) > 1 and ring[0].tobytes() == ring[-1].tobytes():
        return ring[:-1]
    return ring


def usable(polygon):
    """Whether a polygon is finite, has rings of three points at least, and is valid."""
    if not all(len(ring) for ring in polygon):
        return False
    if not all(np.isfinite(ring[:, :2]).all() for ring in polygon):
        return False
    rings = [_distinct(ring[:, :2]) for ring in polygon]
    if any(len(ring) < 3 for ring in rings):
        return False
    power = _scale(rings)
    if any((np.ldexp(np.ldexp(ring, power), -power) != ring).any() for ring in rings):
        return False  # from 1e200 to 1e-300: doubles do not hold both in one unit
    return bool(shapely.is_valid(_shape(rings)))


def _distinct(xy):
    return xy[(xy != np.roll(xy, 1, axis=0)).any(axis=1)]


def _scale(rings):
    largest = max(np.abs(ring).max() for ring in rings)
    return 0 if 1e-50 < largest < 1e50 else -int(np.frexp(largest)[1])


def _shape(rings):
    """The shapely polygon, of extreme size scaled by a power of two."""
    power = _scale(rings)
    if power:
        rings = [np.ldexp(ring, power) for ring in rings]
    return shapely.Polygon(rings[0], rings[1:])


def too_fine(polygon):
    """Whether a polygon has details that doubles hardly tell apart."""
    xy = np.concatenate([ring[:, :2] for ring in polygon])
    xy = np.ldexp(xy, _scale([xy]))
    points = np.unique(xy, axis=0)
    size = np.abs(points).max()
    tree = shapely.STRtree(shapely.points(points))
    lines = shapely.linestrings(
        [
            (a, b)
            for ring in polygon
            for a, b in zip(
                np.ldexp(ring[:, :2], _scale([xy])), np.ldexp(np.roll(ring[:, :2], -1, axis=0), _scale([xy]))
            )
        ]
    )
    near, _ = tree.query(lines, predicate="dwithin", distance=1e-7 * size)
    return len(near) > 2 * len(lines) or np.abs(xy[xy != 0.0]).min(initial=1.0) < 1e-60


# ---------------------------------------------------------------- the tools that cut


class Part:
    """A row of OUTPUT."""

    def __init__(self, feature, extra):
        values = feature.attributes()
        self.geometry = feature.geometry()
        self.attributes = values[:-extra]
        self.part, self.parts, self.status, self.cost, self.gap, self.source = values[-extra:][:6]
        self.tau = values[-1] if extra > 6 else None
        if self.status == NULL:  # shapefiles know no empty text
            self.status = ""


def check_cutting(case, outcome, rows, counts, rng):
    """All that holds of parts, cuts and diagonals; returns what a twin must have too."""
    features = [Feature(row, outcome.source.crs()) for row in rows]
    counts["polygons"] += sum(len(f.polygons) for f in features)
    parts = [Part(f, EXTRA[case.tool]) for f in outcome.layers["OUTPUT"].getFeatures()]
    lines = {
        name: _lines_by_source(outcome, name) if name in outcome.layers else None
        for name in ("CUTS", "DIAGONALS")
    }
    check_numbers(case, outcome, parts, lines)
    # GeoJSON may give two features the same id
    exact = case.sink in ("memory", "gpkg") and len({f.id for f in features}) == len(features)
    answer, place, solved_features = [], 0, 0
    for feature in features:
        own = parts[place : place + parts[place].parts] if place < len(parts) else []
        assert own, f"feature {feature.id} was lost"
        assert [p.part for p in own] == list(range(1, len(own) + 1)), "rows of a feature"
        assert {p.parts for p in own} == {len(own)}
        place += len(own)
        check_attributes(case, outcome, feature, own)
        cuts = lines["CUTS"].pop(feature.id, [])
        diagonals = lines["DIAGONALS"].pop(feature.id, []) if lines["DIAGONALS"] else None
        if exact:
            solved = check_feature(case, feature, own, cuts, diagonals, counts, rng)
            solved_features += solved
        answer.append(summary(own, cuts))
    assert place == len(parts), "parts of no feature"
    assert not any(lines["CUTS"]) and not any(lines["DIAGONALS"] or ()), "lines of no feature"
    counts["features solved"] += solved_features
    return answer


def _lines_by_source(outcome, name):
    layer = outcome.layers[name]
    result = defaultdict(list)
    own = len(layer.fields()) - (6 if name == "CUTS" else 5)
    for feature in layer.getFeatures():
        values = feature.attributes()[own:]
        ends = np.array([[p.x(), p.y()] for p in feature.geometry().vertices()])
        if len(ends) == 0 and outcome.case.sink == "geojson":  # a Z that is no number
            ends = np.full((2, 2), np.nan)
        assert ends.shape == (2, 2), ends
        result[values[0]].append(Line(ends, *values[1:]))
    return result


class Line:
    """A row of CUTS or DIAGONALS."""

    def __init__(self, ends, length, detour, *more):
        self.length = length
        self.u, self.v = map(tuple, ends.tolist())
        self.detour = None if detour == NULL else detour
        self.more = more


def summary(own, cuts):
    """What does not depend on where rings start, nor on the order of features."""
    return (
        len(own),
        Counter(p.status for p in own),
        frozenset(frozenset((line.u, line.v)) for line in cuts),
        None if own[0].cost == NULL else own[0].cost,
        None if own[0].tau == NULL else own[0].tau,
    )


def check_numbers(case, outcome, parts, lines):
    """The printed numbers are those of the layers."""
    results = outcome.results
    cuts = [line for some in lines["CUTS"].values() for line in some]
    assert results["PART_COUNT"] == len(parts), "PART_COUNT"
    assert results["CUT_COUNT"] == len(cuts), "CUT_COUNT"
    if case.sink == "shp":  # its numbers have 15 digits at most
        return
    assert same(results["CUT_LENGTH"], math.fsum(line.length for line in cuts)), "CUT_LENGTH"
    first = [p for p in parts if p.part == 1]
    assert same(results["COST"], math.fsum(p.cost for p in first if p.cost != NULL)), "COST"
    assert results["LOWER_BOUND"] <= results["COST"] * (1 + CLOSE)
    bound = math.fsum(p.cost * (1 - p.gap / 100) for p in first if p.cost != NULL)
    assert same(results["LOWER_BOUND"], bound), "LOWER_BOUND"
    bad, start = 0, 0
    while start < len(parts):
        own = parts[start : start + parts[start].parts]
        bad += any(p.status for p in own)
        start += len(own)
    assert results["SKIPPED_COUNT"] == bad, (results["SKIPPED_COUNT"], bad)
    if lines["DIAGONALS"] is not None:
        rows = [line for some in lines["DIAGONALS"].values() for line in some]
        floor = case.parameters["MIN_LENGTH"]
        largest = max((d.more[0] for d in rows if d.length >= floor), default=1.0)
        if plain(case):  # else an edge that only connects a hole may be no candidate whatever its length
            assert same(results["MAX_DILATION"], max(largest, 1.0)), "MAX_DILATION"
        selected = Counter(_key(d) for d in rows if d.more[1] == "SELF")
        if not any(d.u[0] != d.u[0] for d in cuts):
            assert selected == Counter(map(_key, cuts)), "CUTS and DIAGONALS disagree"
    if case.sink == "memory":
        statuses = [p.status for p in parts if p.status]
        told = "\n".join(outcome.feedback.warnings)
        assert all(s in told for text in statuses for s in text.split("; ")), "a reason was not told"


def _key(line):
    return frozenset((line.u, line.v))


def same(a, b, tolerance=CLOSE):
    return a == b or abs(a - b) <= tolerance * max(abs(a), abs(b))


def check_attributes(case, outcome, feature, own):
    """All attributes on every part; a file format has its own idea of some."""
    if case.sink == "memory":
        for part in own:
            for a, b in zip(part.attributes, feature.attributes):
                assert type(a) is type(b) and (a == b or a != a), (a, b)
            assert len(part.attributes) == len(feature.attributes)
        return
    # a primary key may have come in front
    given, got = outcome.source.fields(), outcome.layers["OUTPUT"].fields().names()
    if case.sink == "gpkg":
        kept = [name for name in given.names() if name.lower() != "fid"]  # the key, made anew
        assert set(kept) <= set(got), (kept, got)
    for part in own:
        found = dict(zip(got, part.attributes))
        for name, kind, b in zip(given.names(), (f.typeName() for f in given), feature.attributes):
            if name.lower() in ("fid", "ogc_fid") or name not in found:  # keys are made anew
                continue
            a = found[name]
            if case.sink == "gpkg" and isinstance(b, (int, str)) and not isinstance(b, bool):
                assert str(a) == str(b).split("\0")[0], (name, kind, a, b)
            elif case.sink == "shp" and isinstance(b, str) and isinstance(a, str):
                assert b.startswith(a.rstrip("\ufffd")[:60]), (name, a, b)


# ---------------------------------------------------------------- one feature


def check_feature(case, feature, own, cuts, diagonals, counts, rng):
    """Whether a feature was solved; all that holds of its parts."""
    statuses = {p.status for p in own}
    if "" not in statuses:
        check_passed_through(case, feature, own, counts)
        assert not cuts and not diagonals
        return False
    solved = list(zip(feature.polygons, feature.usable))
    for part in own:
        if part.status:  # one polygon of several
            (polygon,) = polygons_of(part.geometry)
            places = [k for k, (p, _) in enumerate(solved) if _same_rings(p, polygon)]
            bad = [k for k in places if not solved[k][1]] or places
            assert bad, "a part that is no polygon of the feature"
            check_reason(case, solved[bad[0]][0], solved[bad[0]][1], part.status)
            del solved[bad[0]]
            counts["polygons passed through"] += 1
    assert all(ok for _, ok in solved), "an invalid polygon was solved"
    solved = [polygon for polygon, _ in solved]
    counts["polygons solved"] += len(solved)
    good = [polygons_of(p.geometry) for p in own if not p.status]
    assert all(len(p) == 1 for p in good), "a part of several polygons"
    good = [polygon for (polygon,) in good]
    counts["parts"] += len(good)
    counts["cuts"] += len(cuts)
    # a cut that only connects a hole is in no part's outline, and so is its end
    feet = new_ends(case, solved, [line for line in cuts if line.more[0] != line.more[1]])
    counts["new vertices"] += len(feet)
    check_rows(solved, good, feet)
    for polygon in good:
        assert shapely.is_valid(_shape([_distinct(r[:, :2]) for r in polygon])), "a part is invalid"
    extended = with_points(solved, feet)
    if extended is None:
        counts["features with polygons that share an edge with a new vertex"] += 1
        return True
    check_tiling(extended, own, cuts)
    check_order(case, feature, own, good)
    check_lengths(case, feature, cuts + (diagonals or []), rng)
    # in degrees an edge is as long as its pieces between all new vertices, and below the least length nobody
    # sees where these were
    unseen = measured(case, feature) and case.parameters.get("NEW_VERTICES") and case.parameters["MIN_LENGTH"]
    if diagonals is not None and plain(case) and not unseen:
        solved = with_points(solved, new_ends(case, solved, diagonals))
        if solved is not None:
            check_dilations(case, feature, solved, own, cuts, diagonals, counts, rng)
    return True


def new_ends(case, polygons, lines):
    """Ends of lines that are no vertices: only where they may be."""
    given = {_plus(row[:2]) for polygon in polygons for ring in polygon for row in ring.tolist()}
    new = sorted({_plus(p) for line in lines for p in (line.u, line.v)} - given)
    assert not new or case.parameters.get("NEW_VERTICES") and case.lines is None, "a new vertex"
    return new


def with_points(polygons, points):
    """Polygons with points inserted into the nearest edge, which must be theirs but for rounding.

    None where two edges are as near, of polygons side by side or of a neck that is as narrow as the rounding:
    nobody can tell whose it is.
    """
    if not points:
        return polygons
    power = _scale([ring[:, :2] for polygon in polygons for ring in polygon])
    places = defaultdict(list)
    for point in points:
        found, p = [], np.ldexp(point, power)
        for i, polygon in enumerate(polygons):
            for j, ring in enumerate(polygon):
                a = np.ldexp(ring[:, :2], power)
                way, to = np.roll(a, -1, axis=0) - a, p - a
                length = (way * way).sum(axis=1)
                share = np.divide(
                    (way * to).sum(axis=1), length, out=np.full(len(a), -1.0), where=length > 0.0
                )
                off = np.hypot(*(to - share[:, None] * way).T)
                off[(share <= 0.0) | (share >= 1.0)] = np.inf
                found += [(off[k], i, j, k, share[k]) for k in np.argsort(off)[:2].tolist()]
        found.sort()
        off, i, j, k, share = found[0]
        size = max(np.abs(np.ldexp(ring[:, :2], power)).max() for ring in polygons[i])
        assert off <= 1e-14 * size, f"a new vertex {point} is off its edge by {off}"
        if len(found) > 1 and found[1][0] <= 1e-14 * size:
            return None
        places[i, j].append((k, share, point))
    result = [[ring[:, :2] for ring in polygon] for polygon in polygons]
    for (i, j), own in places.items():
        own.sort()
        result[i][j] = np.insert(
            result[i][j], [k + 1 for k, _, _ in own], [point for _, _, point in own], axis=0
        )
    return result


def check_passed_through(case, feature, own, counts):
    """Bit for bit, with a reason that is true."""
    assert len(own) == 1
    (part,) = own
    data = bytes(part.geometry.asWkb()) if not part.geometry.isNull() else b""
    before = [b""] if feature.geometry.isNull() else [bytes(feature.geometry.asWkb())]
    if not feature.geometry.isNull():
        before.append(bytes(linear(feature.geometry).asWkb()))
    if case.sink != "memory":
        assert not all(np.isfinite(r[:, :2]).all() for p in feature.polygons for r in p) or sorted(
            map(_ring_bytes, polygons_of(part.geometry))
        ) == sorted(map(_ring_bytes, feature.polygons)), (
            f"passed through, but changed: {part.geometry.asWkt()}"
        )
    else:
        assert data in before, "passed through, but changed"
    counts["polygons passed through"] += len(feature.polygons)
    counts["features passed through"] += 1
    if not feature.polygons:
        assert part.status in ("it has no geometry", "it is empty"), part.status
    for polygon, ok in zip(feature.polygons, feature.usable):
        check_reason(case, polygon, ok, part.status)
    reason = part.status.split("[")[0].split(":")[0]
    counts["reason: " + reason[:40]] += 1


def _ring_bytes(polygon):
    return [ring[:, :2].tobytes() for ring in polygon]


def _same_rings(a, b):
    # OGR closes rings that end in infinity once more
    one, two = ({row[:2].tobytes() for ring in p for row in ring} for p in (a, b))
    return len(a) == len(b) and one == two


def check_reason(case, polygon, ok, reason):
    """A valid polygon is only left as it is where the case gives cause."""
    if ok:
        assert any(words in reason and cause(case, polygon) for words, cause in SOLVABLE_REASONS), (
            f"a valid polygon was not solved: {reason}"
        )


def check_rows(solved, parts, new):
    """Parts have the input's rows, Z and M included, and all of them."""
    size, got = (min(r.shape[1] for polygon in p for r in polygon) for p in (solved, parts))
    assert size <= got, "Z or M was lost"
    if size < got:
        size = 2  # a file has the same ordinates for all: m may have moved behind z
    given = {row[:size].tobytes() for polygon in solved for ring in polygon for row in ring}
    used = {row[:size].tobytes() for polygon in parts for ring in polygon for row in ring}
    if new:  # these are looked at by their places
        more = {np.array(p).tobytes() for p in new}
        added = {row for row in used - given if (np.frombuffer(row)[:2] + 0.0).tobytes() in more}
        assert {(np.frombuffer(row)[:2] + 0.0).tobytes() for row in added} == more, "a new vertex was lost"
        used -= added
    assert used <= given, "a coordinate was changed"
    assert given <= used, "a vertex was lost"


def turn(xy):
    """Sign of the area of a ring, exact."""
    x, y = (xy - xy[0]).T
    with np.errstate(all="ignore"):
        left, right = x * np.roll(y, -1), np.roll(x, -1) * y
        area, error = left.sum() - right.sum(), np.abs(left).sum() + np.abs(right).sum()
    if np.isfinite(error) and error > 1e-250 and abs(area) > 1e-12 * error:
        return 1 if area > 0 else -1
    x, y = ([Fraction(v) for v in column] for column in xy.T.tolist())
    area = sum(x[k - 1] * y[k] - x[k] * y[k - 1] for k in range(len(x)))
    return (area > 0) - (area < 0)


def half_edges(polygon):
    """Directed edges with the interior on the left."""
    edges = []
    for place, ring in enumerate(polygon):
        xy = _distinct(ring[:, :2])
        if turn(xy) != (1 if place == 0 else -1):
            xy = xy[::-1]
        points = list(map(tuple, (xy + 0.0).tolist()))
        edges += zip(points, points[1:] + points[:1])
    return edges


def check_tiling(solved, own, cuts):
    """See the top of this file; and the two parts that each cut names."""
    expected = Counter(edge for polygon in solved for edge in half_edges(polygon))
    sides, actual = defaultdict(set), Counter()
    for part in own:
        if not part.status:
            (polygon,) = polygons_of(part.geometry)
            for edge in half_edges(polygon):
                sides[edge].add(part.part)
                actual[edge] += 1
    between = []
    for line in cuts:
        a, b, _ = line.more
        u, v = (tuple(x + 0.0 for x in p) for p in (line.u, line.v))
        assert a <= b
        if a != b:
            between.append((u, v, a, b))
            expected[u, v] += 1
            expected[v, u] += 1
    if expected != actual:  # a vertex of one ring inside an edge of another
        points = np.unique(np.array([p for edge in expected | actual for p in edge]), axis=0)
        expected = split(expected, points)
        actual = split(actual, points)
        assert expected == actual, "the parts do not tile the polygon"
    for u, v, a, b in between:
        for edge in ((u, v), (v, u)):
            assert not sides[edge] or sides[edge] & {a, b}, "a cut names other parts"
        if len(solved) == 1 and sides[u, v] and sides[v, u]:
            assert {*sides[u, v], *sides[v, u]} == {a, b}, "a cut names other parts"


def split(edges, points):
    """Edges cut where another point lies on them, exactly."""
    result = Counter()
    for (a, b), count in edges.items():
        chain = [a, *on_segment(points, a, b), b]
        for step in zip(chain[:-1], chain[1:]):
            result[step] += count
    return +result


def on_segment(points, a, b):
    """Those of the points inside the segment a-b, in order."""
    low, high = np.minimum(a, b), np.maximum(a, b)
    near = points[((points >= low) & (points <= high)).all(axis=1)]
    found = []
    ax, ay, bx, by = map(Fraction, (*a, *b))
    for p in map(tuple, near.tolist()):
        if p in (a, b):
            continue
        x, y = map(Fraction, p)
        if (bx - ax) * (y - ay) == (by - ay) * (x - ax):
            found.append((abs(x - ax) + abs(y - ay), p))
    return [p for _, p in sorted(found)]


def check_order(case, feature, own, good):
    """Part 1 is the largest; areas add up, as far as doubles can tell."""
    if measured(case, feature) is not None:
        return
    if any(p.status for p in own):
        return
    power = _scale([ring[:, :2] for polygon in good for ring in polygon])
    if power and len(feature.polygons) > 1:  # no double holds the areas
        return
    good = [[np.ldexp(ring[:, :2], power) for ring in polygon] for polygon in good]
    area = [plain_area(polygon) for polygon in good]
    xy = np.concatenate([ring for polygon in good for ring in polygon])
    noise = 1e-13 * np.ptp(xy, axis=0).prod()
    assert all(b <= a * (1 + CLOSE) + noise for a, b in zip(area, area[1:])), "not the largest first"


def plain_area(polygon):
    """The area, from coordinates near the origin."""
    total = 0.0
    for place, ring in enumerate(polygon):
        with np.errstate(all="ignore"):
            x, y = (ring[:, :2] - polygon[0][0, :2]).T
            area = abs(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)) / 2
        total += area if place == 0 else -area
    return total


def measured(case, feature):
    """The metric of a layer in degrees, or None for a plane."""
    crs = feature.crs
    if not crs.isGeographic():
        return None
    if any(np.nanmax(np.abs(ring[:, 1])) > 90.0 + 1e-9 for p in feature.polygons for ring in p if len(ring)):
        return None
    return measure_of(crs)


def check_lengths(case, feature, lines, rng):
    """The field length, against QGIS's own measure."""
    if not lines:
        return
    line = lines[int(rng.integers(len(lines)))]
    if measured(case, feature) is None:
        assert same(line.length, math.hypot(line.u[0] - line.v[0], line.u[1] - line.v[1])), "length"
        return
    if max(abs(line.u[0]), abs(line.v[0])) > 180.0:
        return
    distance = QgsDistanceArea()
    distance.setEllipsoid(feature.crs.ellipsoidAcronym() or "EPSG:7030")
    from qgis.core import QgsPointXY

    expected = distance.measureLine(QgsPointXY(*line.u), QgsPointXY(*line.v))
    if 1.0 < expected < 1.5e7:
        assert same(line.length, expected, 0.004), (line.length, expected)


# ---------------------------------------------------------------- dilations and brute force


class Graph:
    """A solved polygon with numbered vertices, for the checker."""

    def __init__(self, polygon, measure):
        rings = [list(map(tuple, (_distinct(r[:, :2]) + 0.0).tolist())) for r in polygon]
        if len(rings) > 1:  # where a vertex of one ring lies inside an edge of another
            points = np.unique(np.concatenate(rings), axis=0)
            rings = [
                [p for a, b in zip(ring, ring[1:] + ring[:1]) for p in (a, *on_segment(points, a, b))]
                for ring in rings
            ]
        self.number = {}
        for ring in rings:
            for p in ring:
                self.number.setdefault(p, len(self.number))
        self.rings = [[self.number[p] for p in ring] for ring in rings]
        self.xy = np.array(list(self.number))
        self.simple = len(rings) == 1
        n = len(self.xy)
        u, v = (x.ravel() for x in np.meshgrid(np.arange(n), np.arange(n), indexing="ij"))
        measure, power = measure or metric.planar(), _scale([self.xy])
        position = measure.positions(np.ldexp(self.xy, power))
        self.distance = np.ldexp(measure.length(position, u, v), -power).reshape(n, n)
        self.table = self.distance.tolist()
        self.perimeter = sum(
            self.table[a][b] for ring in self.rings for a, b in zip(ring, ring[1:] + ring[:1])
        )

    def length(self, u, v):
        return self.table[u][v]

    def edges(self, lines):
        """(k, 2): the numbers of the ends of lines."""
        number = self.number
        return np.array([(number[_plus(d.u)], number[_plus(d.v)]) for d in lines], dtype=int).reshape(-1, 2)

    def dilations(self, cuts, edges):
        return checker.dilations(self.xy, self.rings, cuts, edges, self.length)


def _plus(p):
    return (p[0] + 0.0, p[1] + 0.0)


def check_dilations(case, feature, solved, own, cuts, diagonals, counts, rng):
    """Every candidate within tau; as few cuts as the brute force finds."""
    tau = bound(case, feature, own)
    graphs = [Graph(p, measured(case, feature)) for p in solved if sum(map(len, p)) <= 150]
    if len(graphs) < len(solved):
        return
    mine = []
    for graph in graphs:
        mine.append([d for d in diagonals if _plus(d.u) in graph.number and _plus(d.v) in graph.number])
    if sum(map(len, mine)) != len(diagonals):
        counts["features whose parts share vertices"] += 1
        return
    floor = case.parameters["MIN_LENGTH"]
    for graph, lines in zip(graphs, mine):
        edges = graph.edges(lines)
        selected = edges[[d.more[1] == "SELF" for d in lines]]
        some = np.arange(len(lines))
        if len(some) > 40:
            some = rng.permutation(some)[:40]
        after = graph.dilations(selected, edges[some])
        for k, d in zip(some.tolist(), np.maximum(after, 1.0).tolist()):
            if lines[k].length >= floor:
                assert d <= tau * (1 + CLOSE), f"dilation {d!r} beyond tau {tau!r}"
            room = CLOSE + 1e-13 * graph.perimeter / lines[k].length
            assert same(lines[k].more[0], d, room), f"dilation {lines[k].more[0]!r}, should be {d!r}"
        few = some[:5]
        before = graph.dilations(np.empty((0, 2), int), edges[few])
        for k, d in zip(few.tolist(), np.maximum(before, 1.0).tolist()):
            room = CLOSE + 1e-13 * graph.perimeter / lines[k].length
            told = math.inf if lines[k].detour is None else lines[k].detour
            assert same(told, d, room), f"detour {told!r}, should be {d!r}"
        if not graph.simple and case.parameters["MIN_HOLE"] == 0.0 and rng.random() < 0.3:
            check_needed(graph, lines, edges, tau, floor, counts, rng)
        counts["polygons whose dilations were checked"] += 1
        counts["dilations checked"] += len(some)
        if case.lines is None and floor == 0.0 and graph.simple:
            assert len(lines) == len(graph.xy) - 3, "not all diagonals of a triangulation"
    if len(graphs) == 1:
        check_optimal(case, feature, graphs[0], mine[0], own[0], counts)


def check_needed(graph, lines, edges, tau, floor, counts, rng):
    """Without one of the cuts a ring comes loose, or some candidate is beyond tau."""
    selected = np.array([d.more[1] == "SELF" for d in lines], dtype=bool)
    bounded = np.array([d.length >= floor for d in lines], dtype=bool)
    if not selected.any() or len(lines) > 60:
        return
    cut = int(rng.choice(np.flatnonzero(selected)))
    others = selected.copy()
    others[cut] = False
    connected = graph.dilations(edges[others], edges[[cut]])[0] < np.inf
    dilation = graph.dilations(edges[others], edges[bounded])
    room = CLOSE + 1e-13 * graph.perimeter / min(d.length for d in lines)
    assert not connected or dilation.max(initial=0.0) > tau * (1 - room), "a cut is needless"
    counts["cuts shown to be needed, with holes"] += 1


def bound(case, feature, own):
    """The tau that a feature must keep."""
    if case.tool == "partitionbudget":
        return own[0].tau
    tau = case.parameters["TAU"]
    return BY_FEATURE[tau["expression"]](feature.id) if isinstance(tau, dict) else tau


def weight_of(case, graph, edges, lines):
    """What each candidate costs."""
    objective = case.parameters["OBJECTIVE"]
    length = graph.distance[edges[:, 0], edges[:, 1]]
    if objective == "MinSize":
        return np.ones(len(edges))
    if objective == "MinLength":
        return length
    weigh = WEIGHTS[case.parameters["WEIGHT"]]
    plane = np.hypot(*(graph.xy[edges[:, 0]] - graph.xy[edges[:, 1]]).T)
    return np.array(
        [weigh(a, d.detour, p) for a, d, p in zip(length.tolist(), lines, plane.tolist())], dtype=float
    )


def feasible(graph, lines):
    """Whether all subsets of the candidates can be tried."""
    return graph.simple and len(lines) <= 8 and len(graph.xy) <= 14


def subsets(graph, edges):
    """All subsets and the dilation of each; distances of any metric."""
    if len(edges) == 0:
        return np.zeros((1, 0), dtype=bool), np.ones(1)
    order = graph.rings[0]
    distance = graph.distance[np.ix_(order, order)]
    place = np.empty(len(order), dtype=int)
    place[order] = np.arange(len(order))
    return brute_force.all_subsets(graph.xy[order], place[edges], distance)


def check_optimal(case, feature, graph, lines, first, counts):
    """Against all subsets of the candidates."""
    if not feasible(graph, lines):
        return
    edges = graph.edges(lines)
    subset, dilation = subsets(graph, edges)
    cost = subset @ weight_of(case, graph, edges, lines)
    counts["brute-force comparisons"] += 1
    counts[f"brute-force comparisons, {case.parameters['OBJECTIVE']}"] += 1
    slack = 1e-9 + 1e-14 * graph.perimeter / graph.distance[graph.distance > 0].min(initial=np.inf)
    if case.tool == "partition":
        tau = bound(case, feature, [first])
        most, least = (cost[dilation <= tau * (1 + s)].min(initial=np.inf) for s in (-slack, slack))
        gap = 0.0 if case.parameters["OBJECTIVE"] == "MinSize" else case.parameters["MAX_GAP"] / 100
        assert first.cost >= least * (1 - CLOSE), f"cost {first.cost!r} below the least, {least!r}"
        assert first.cost * (1 - gap) <= most * (1 + CLOSE), f"cost {first.cost!r}, best {most!r}"
        assert first.cost * (1 - first.gap / 100) <= most * (1 + CLOSE), "no lower bound"
        assert first.gap <= 100 * gap + 1e-6, "the gap is larger than asked for"
        return
    budget = case.parameters["BUDGET"]
    if isinstance(budget, dict):
        budget = BY_FEATURE[budget["expression"]](feature.id)
    most, least = (dilation[cost <= budget * (1 + s)].min() for s in (-CLOSE, CLOSE))
    assert least * (1 - slack) <= first.tau <= most * (1 + slack), (first.tau, least, most)


# ---------------------------------------------------------------- the hierarchy


def check_hierarchy(case, outcome, rows, counts, rng):
    """Every level is a partition: valid parts that tile, by the cuts that are needed there."""
    features = [Feature(row, outcome.source.crs()) for row in rows]
    counts["polygons"] += sum(len(f.polygons) for f in features)
    parts, cuts = defaultdict(list), defaultdict(list)
    for row in outcome.layers["OUTPUT"].getFeatures():
        *_, part, parent, level, low, high, source, status = row.attributes()
        parts[source].append(Level(row.geometry(), part, parent, level, low, high, status))
    fields = outcome.layers["CUTS"].fields()
    for row in outcome.layers["CUTS"].getFeatures():
        source, length, _, persistence, rank = row.attributes()[len(fields) - 5 :]
        ends = [(p.x(), p.y()) for p in row.geometry().vertices()]
        cuts[source].append((rank, persistence, *map(_plus, ends)))
    assert outcome.results["PART_COUNT"] == sum(map(len, parts.values()))
    assert outcome.results["CUT_COUNT"] == sum(map(len, cuts.values()))
    if case.sink not in ("memory", "gpkg") or len({f.id for f in features}) < len(features):
        return
    for feature in features:
        own, lines = parts[feature.id], sorted(cuts[feature.id])
        assert own, f"feature {feature.id} was lost"
        bad = [p for p in own if p.status not in ("", NULL)]
        if len(bad) == len(own):
            assert not lines
            for polygon, ok in zip(feature.polygons, feature.usable):
                check_reason(case, polygon, ok, bad[0].status)
            continue
        if bad or not all(feature.usable):
            continue  # which polygon is which is told by check_feature for the other tools
        assert [rank for rank, *_ in lines] == list(range(1, len(lines) + 1)), "ranks"
        assert all(a[1] >= b[1] for a, b in zip(lines, lines[1:])), "persistence falls with the rank"
        if "PARTS" in case.parameters:  # one level, which ties of persistence may leave no time
            check_level(case, feature.polygons, own, lines)
            counts["levels"] += 1
            continue
        assert all(p.low < p.high for p in own), "a part that lives for no time"
        tops = sorted({p.low for p in own})
        for tau in tops if len(tops) <= 4 else sorted(rng.choice(tops, 4, replace=False).tolist()):
            at = [p for p in own if p.low <= tau < p.high]
            check_level(case, feature.polygons, at, [line for line in lines if line[1] > tau])
            counts["levels"] += 1
        counts["polygons solved"] += len(feature.polygons)
        counts["cuts"] += len(lines)


class Level(NamedTuple):
    """A row of the hierarchy's OUTPUT."""

    geometry: object
    part: int
    parent: object
    level: int
    low: float
    high: float
    status: object


class Ends(NamedTuple):
    """The ends of a cut."""

    u: tuple
    v: tuple


def check_level(case, solved, own, cuts):
    """Half-edges of the parts of one level: those of the polygons, and both sides of the cuts."""
    actual = Counter()
    for part in own:
        (polygon,) = polygons_of(part.geometry)
        assert shapely.is_valid(_shape([_distinct(r[:, :2]) for r in polygon])), "a part is invalid"
        actual.update(half_edges(polygon))
    lines = [Ends(u, v) for _, _, u, v in cuts if actual[u, v] and actual[v, u]]  # else it joins a hole
    polygons = with_points(solved, new_ends(case, solved, lines))
    if polygons is None:
        return
    expected = Counter(edge for polygon in polygons for edge in half_edges(polygon))
    for u, v in lines:
        expected[u, v] += 1
        expected[v, u] += 1
    if expected != actual:
        points = np.unique(np.array([p for edge in expected | actual for p in edge]), axis=0)
        assert split(expected, points) == split(actual, points), "the parts of a level do not tile"


# ---------------------------------------------------------------- the trade-off curve


def check_tradeoff(case, outcome, rows, counts, rng):
    """Steps against a run of isthmus:partition at each, itself checked."""
    features = [Feature(row, outcome.source.crs()) for row in rows]
    counts["polygons"] += sum(len(f.polygons) for f in features)
    steps = defaultdict(list)
    layer = outcome.layers["OUTPUT"]
    for row in layer.getFeatures() if layer is not None else ():
        source, *values = row.attributes()[-6:]
        steps[int(source)].append([None if v in (NULL, "") else float(v) for v in values])
    assert outcome.results["STEP_COUNT"] == sum(map(len, steps.values()))
    p = case.parameters
    low, high = p["TAU_MIN"], p["TAU_MAX"] or math.inf
    assert set(steps) <= {f.id for f in features}
    told = "\n".join(outcome.feedback.warnings)
    for feature in features:
        own = steps.get(feature.id)
        if own is None:
            assert f"Feature {feature.id} has no curve" in told
            continue
        counts["polygons solved"] += len(feature.polygons)
        assert any(feature.usable)
        tau, cuts, length, cost, share = zip(*own)
        assert all(b < a for a, b in zip(tau, tau[1:])), "tau must fall"
        assert all(b > a for a, b in zip(cost, cost[1:])), "cost must rise"
        assert tau[0] <= high and len(own) <= p["STEPS"]
        assert all(s is None or 0 < s <= 1 + CLOSE for s in share), share
        counts["steps of curves"] += len(own)
    skipped = [f for f in features if f.id not in steps or not all(f.usable)]
    assert outcome.results["SKIPPED_COUNT"] >= len(skipped)
    text = (outcome.folder / "report.html").read_text(encoding="utf-8")
    Tags().feed(text)
    assert text.count("<svg") == len(steps)
    check_steps(case, features, steps, low, counts)


class Tags(HTMLParser):
    """Every tag that is opened is closed."""

    def __init__(self):
        super().__init__()
        self.open = []

    def handle_starttag(self, tag, attributes):
        if tag not in ("meta",):
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        pass

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def check_steps(case, features, steps, low, counts):
    """Small features against the brute force, with the candidates of a run of partition."""
    p = {k: v for k, v in case.parameters.items() if k not in ("TAU_MIN", "TAU_MAX", "STEPS")}
    p.update(TAU=1e18, MAX_GAP=100.0)
    other = run(case, tool="partition", parameters=p, sink="memory", diagonals=True, twin=False)
    if other.error or not plain(case):
        return
    diagonals = _lines_by_source(other, "DIAGONALS")
    for feature in features:
        own = steps.get(feature.id)
        if own is None or len(feature.polygons) != 1 or sum(map(len, feature.polygons[0])) > 14:
            continue
        lines = diagonals[feature.id]
        polygons = with_points(feature.polygons, new_ends(case, feature.polygons, lines))
        graph = Graph((polygons or feature.polygons)[0], measured(case, feature))
        if not feasible(graph, lines):
            continue
        edges = graph.edges(lines)
        subset, dilation = subsets(graph, edges)
        cost = subset @ weight_of(case, graph, edges, lines)
        slack = 1e-9 + 1e-14 * graph.perimeter / graph.distance[graph.distance > 0].min(initial=np.inf)
        for tau, _, _, told, _ in own:
            most, least = (cost[dilation <= tau * (1 + s)].min(initial=np.inf) for s in (-slack, slack))
            assert least * (1 - CLOSE) <= told <= most * (1 + CLOSE), (told, least, most)
            if tau > low * (1 + 1e-6) and case.parameters["OBJECTIVE"] == "MinSize":
                better = dilation[cost <= told * (1 + CLOSE)].min()
                assert better >= tau * (1 - slack), f"dilation {better} is possible, not {tau}"
        counts["brute-force comparisons"] += len(own)
        counts["brute-force comparisons, curves"] += len(own)


# ---------------------------------------------------------------- cancelled runs, and twins


def check_cancelled(case, outcome, features, counts):
    """What a cancelled run leaves must not look complete, nor be locked."""
    counts["cancelled runs"] += 1
    if case.sink == "memory":
        if case.tool in ("tradeoff", "hierarchy"):
            return
        parts = [Part(f, EXTRA[case.tool]) for f in outcome.layers["OUTPUT"].getFeatures()]
        start = 0
        while start < len(parts):  # whole features or nothing
            own = parts[start : start + parts[start].parts]
            assert len(own) == parts[start].parts, "half a feature"
            start += len(own)
        return
    counts["cancelled runs to files"] += 1


def check_twin(case, answer, features, counts, rng):
    """The same for rings started elsewhere and turned round, and for shuffled features."""
    order = rng.permutation(len(case.features)).tolist()
    turned = [(retold(case.features[k][0], rng), case.features[k][1]) for k in order]
    if any(isinstance(v, dict) for v in case.parameters.values()):
        return  # an expression of the id
    other = run(case, features=turned, sink="memory")
    assert other.error is None
    parts = [Part(f, EXTRA[case.tool]) for f in other.layers["OUTPUT"].getFeatures()]
    lines = _lines_by_source(other, "CUTS")
    place = 0
    for k, feature in zip(order, other.source.getFeatures()):
        own = parts[place : place + parts[place].parts]
        place += len(own)
        mine, again = answer[k], summary(own, lines[feature.id()])
        for a, b in zip(mine, again):
            if isinstance(a, float) and isinstance(b, float):
                assert same(a, b), (mine, again)
            elif isinstance(a, Counter):
                assert sum(a.values()) == sum(b.values())
                assert bool(a[""]) == bool(b[""]), (a, b)
            else:
                assert a == b, (mine, again)
        counts["features told otherwise"] += 1


def retold(text, rng):
    """A geometry with its rings started elsewhere and turned round."""
    if text is None or text[:2] != "01":
        return text
    geometry = QgsGeometry()
    geometry.fromWkb(bytes.fromhex(text))
    if geometry.isEmpty():
        return text
    polygons = hostile.read_wkb(bytes.fromhex(text))
    ordinates = ("Z" if QgsWkbTypes.hasZ(geometry.wkbType()) else "") + (
        "M" if QgsWkbTypes.hasM(geometry.wkbType()) else ""
    )
    if ordinates:
        return text
    polygons = [[_around(ring[:, :2], rng) for ring in polygon] for polygon in polygons]
    return hostile.write_wkb(polygons, multi=QgsWkbTypes.isMultiType(geometry.wkbType())).hex()


def _around(ring, rng):
    if len(ring) < 2 or ring[0].tobytes() != ring[-1].tobytes():
        return ring
    ring = np.roll(ring[:-1], int(rng.integers(len(ring))), axis=0)
    return ring[::-1] if rng.random() < 0.5 else ring
