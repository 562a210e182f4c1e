"""Features of a layer, each with several polygons: from their rings and settings to pieces and cuts.

What the QGIS tools and the Python package share: a chunk of features goes through `prepare`, one of the
three ways to choose (`for_tau`, `within_budget`, `curves`), ``solve.finish``, and comes out as `pieces` and
`cuts`, in rows of the input and plain arrays with an entry for each.
"""

from __future__ import annotations

import math
from typing import Any, Callable, NamedTuple, Sequence

import numpy as np

from ..errors import Sentence, number_or_none
from ..metric import Metric
from ..progress import ignore
from ..rings import Rings, groups, offsets_of, signed_areas, take
from . import solve
from .candidates import ACCEPTED, CROSSES, LEAVES, OFF_VERTICES, REPEATED, TOUCHES, Lines
from .min_size import SELF
from .parts import Parts
from .solve import Partition, Prepared, Selection
from .tradeoff import OverBudget, joint_solver, smallest_dilation, together, trade_off

__all__ = [
    "Chunk",
    "GivenLines",
    "Pieces",
    "Problem",
    "by_feature",
    "curves",
    "cuts",
    "for_tau",
    "pieces",
    "prepare",
    "within_budget",
    "without_vertex",
]

# Features at once: more take memory, and longer until a cancelled run stops, but hardly less time
CHUNK_FEATURES, CHUNK_VERTICES = 4096, 200_000
# Seconds that a polygon may take to close the gap of MinLength and MinWeight, and each trial of a search
TIME_LIMIT, TRIAL_LIMIT = 540.0, 60.0

LEFT_OUT = {
    OFF_VERTICES: Sentence("an end is not a vertex of a polygon"),
    LEAVES: Sentence("it leaves its polygon"),
    TOUCHES: Sentence("it touches the boundary between its ends"),
    REPEATED: Sentence("it repeats line {}"),
    CROSSES: Sentence("it crosses the shorter line {}"),
}


class Chunk(NamedTuple):
    """Features as flat arrays.

    Attributes
    ----------
    features : sequence
        The features themselves, as the caller has them.
    rings : Rings
        All their polygons. Behind the rows of the rings, ``coords`` may have new ones for the results.
    owner : (q,) int
        The feature of each polygon, as a place in ``features``.
    extra : sequence
        Of each feature, which ordinates it has, as the caller writes them.
    measure : Metric
    """

    features: Sequence
    rings: Rings
    owner: np.ndarray
    extra: Sequence
    measure: Metric


class Problem(NamedTuple):
    """A chunk, ready to be solved.

    Attributes
    ----------
    chunk : Chunk
    prepared : Prepared
    weight : (k,) float or None
        Weights of the candidates; None for MinSize.
    verdict : (q,) object
        For each polygon of the chunk '', or why it is not solved.
    shell_share : (p,) float
        Area of the shell of each prepared polygon, as a share of its feature's area.
    """

    chunk: Chunk
    prepared: Prepared
    weight: np.ndarray | None
    verdict: np.ndarray
    shell_share: np.ndarray

    @property
    def owner(self) -> np.ndarray:
        """(p,) int: the feature of each prepared polygon."""
        return self.chunk.owner[self.prepared.polygons.number]

    @property
    def solved(self) -> np.ndarray:
        """(p,) bool: the prepared polygons that nothing forbids to solve."""
        return self.verdict[self.prepared.polygons.number] == ""

    def refuse(self, features: Any, reason: str) -> None:
        """Note, for features, why none of their polygons is solved; those with a reason keep it."""
        own = np.isin(self.chunk.owner, features) & (self.verdict == "")
        self.verdict[own] = reason


class Pieces(NamedTuple):
    """What became of the polygons of a chunk: parts, and whole polygons that could not be solved.

    They come by feature, the largest first; a polygon in one piece has its rings as they were.

    Attributes
    ----------
    feature_offsets : (f + 1,) int
        Where the pieces of each feature start.
    polygon : (m,) int
        The polygon of each, as a place in the chunk.
    area : (m,) float
    rows, offsets, ring_offsets : (k,) int, (r + 1,) int, (m + 1,) int
        Rows of all rings, where each ring starts, and where the rings of each piece start.
    number : (m',) int
        The number within its feature, from 1, of each part of the solution.
    """

    feature_offsets: np.ndarray
    polygon: np.ndarray
    area: np.ndarray
    rows: np.ndarray
    offsets: np.ndarray
    ring_offsets: np.ndarray
    number: np.ndarray


class GivenLines:
    """A user's own lines as candidates, and what became of them over all polygons.

    Parameters
    ----------
    ends : (l, 2, 2) float
    ids : sequence
        What names each line in messages.
    """

    def __init__(self, ends: np.ndarray, ids: Sequence) -> None:
        self.ends = np.asarray(ends, dtype=float).reshape(-1, 2, 2)
        self.ids = ids
        self.verdict = np.full(len(ids), OFF_VERTICES)
        self.used = np.zeros(len(ids), dtype=bool)
        self.other: dict = {}

    def near(self, coords: np.ndarray) -> np.ndarray:
        """Return the lines whose bounding box meets that of a polygon's vertices."""
        margin = 1e-9 * np.abs(coords[:, :2]).max()
        low, high = coords[:, :2].min(axis=0) - margin, coords[:, :2].max(axis=0) + margin
        meets = (self.ends.max(axis=1) >= low) & (self.ends.min(axis=1) <= high)
        return np.flatnonzero(meets.all(axis=1))

    def note(self, which: np.ndarray, lines: Lines) -> None:
        """Remember what a polygon said of its lines; the best verdict counts."""
        self.used[which[lines.verdict == ACCEPTED]] = True
        for k, verdict, other in zip(which.tolist(), lines.verdict.tolist(), lines.other.tolist()):
            if verdict > self.verdict[k]:
                self.verdict[k] = verdict
                if other >= 0:
                    self.other[k] = self.ids[which[other]]

    def left_out(self) -> list[tuple]:
        """Return the ids of the lines that are no diagonals, each with the reason."""
        return [
            (self.ids[k], Sentence(LEFT_OUT[self.verdict[k]], self.other.get(k)))
            for k in range(len(self.ids))
            if not self.used[k]
        ]


def beyond_the_poles(rings: Rings, owner: np.ndarray, count: int, measure: Metric) -> np.ndarray:
    """Return which features have a latitude beyond 90 degrees, so that their CRS cannot be right.

    Parameters
    ----------
    rings : Rings
    owner : (q,) int
    count : int
        The number of features.
    measure : Metric
        Of angles.

    Returns
    -------
    (count,) bool
    """
    strange = np.zeros(count, dtype=bool)
    beyond = np.abs(rings.coords[:, 1] * measure.degrees) > 90.0 + 1e-9
    strange[np.repeat(owner, np.diff(rings.offsets[rings.polygon_offsets]))[beyond]] = True
    return strange


def weigh_by_length(chunk: Chunk, near: list | None, prepared: Prepared) -> tuple[np.ndarray, dict]:
    """Return the weights of MinLength, and no reasons against any polygon."""
    return prepared.chord, {}


def prepare(
    chunk: Chunk,
    *,
    natural: bool,
    smallest_part: np.ndarray,
    min_length: np.ndarray,
    min_hole: np.ndarray,
    lines: GivenLines | None = None,
    new_vertices: bool = False,
    weigh: Callable | None = None,
    check: Callable = ignore,
) -> Problem:
    """Prepare the polygons of a chunk.

    Parameters
    ----------
    chunk : Chunk
    natural : bool
        Whether cuts may only lie where people would cut.
    smallest_part : (f,) float
        The smallest part of each feature, in per cent of its area.
    min_length, min_hole : (f,) float
        See ``solve.prepare``. A feature with a number that is none, negative, or beyond 100 per cent is
        refused.
    lines : GivenLines, optional
        Candidates instead of the diagonals of a triangulation.
    new_vertices : bool
        See ``solve.prepare``; the chunk of the problem has their rows then.
    weigh : callable, optional
        ``(chunk, near, prepared)`` to the weights of the candidates, and {polygon of the chunk: why it has
        none}. ``near`` has, for each polygon, the numbers of the lines given for it, or is None. Without,
        MinSize.
    check : callable, optional
        Called now and then; may raise `Cancelled`.

    Returns
    -------
    Problem

    Examples
    --------
    An hourglass is ready to be solved, and is refused where a number that goes with it cannot be.

    >>> from isthmus.core import metric, rings
    >>> xy = np.array([[0, 0], [5, 4], [15, 0], [15, 10], [5, 6], [0, 10.0]])
    >>> chunk = Chunk(["land"], rings.one_polygon(xy, [0, 6]), np.array([0]), [None], metric.planar())
    >>> no, wrong = np.zeros(1), np.array([-1.0])
    >>> problem = prepare(chunk, natural=False, smallest_part=no, min_length=no, min_hole=no)
    >>> problem.solved.tolist()
    [True]
    >>> problem = prepare(chunk, natural=False, smallest_part=wrong, min_length=no, min_hole=no)
    >>> print(problem.verdict[0])
    SMALLEST_PART must be a number from 0 to 100, and is -1
    """
    owner, count = chunk.owner, len(chunk.features)
    floors, reasons = _floors(smallest_part, min_length, min_hole)
    area = shell = np.zeros(len(owner))
    if natural or floors[0].any():  # else nobody asks
        area, shell = _areas(chunk.rings, np.arange(len(owner)), chunk.measure)
    feature_area = np.bincount(owner, weights=area, minlength=count)
    near = None
    if lines is not None:
        bounds = chunk.rings.offsets[chunk.rings.polygon_offsets].tolist()
        near = [lines.near(chunk.rings.coords[lo:hi]) for lo, hi in zip(bounds[:-1], bounds[1:])]
    prepared = solve.prepare(
        chunk.rings,
        natural=natural,
        smallest=floors[0][owner] / 100.0 * feature_area[owner],
        min_length=floors[1][owner],
        min_hole=floors[2][owner],
        lines=None if lines is None or near is None else [lines.ends[own] for own in near],
        new_vertices=new_vertices,
        measure=chunk.measure,
        check=check,
    )
    if len(prepared.new_rows):
        coords = np.concatenate((chunk.rings.coords, prepared.new_rows))
        chunk = chunk._replace(rings=chunk.rings._replace(coords=coords))
    verdict = prepared.verdict.copy()
    if lines is not None and near is not None and prepared.lines is not None:
        for own, found in zip(near, prepared.lines):
            if found is not None:
                lines.note(own, found)
    weight = None
    if weigh:
        weight, more = weigh(chunk, near, prepared)
        for polygon, reason in more.items():
            verdict[polygon] = reason
    number = prepared.polygons.number
    with np.errstate(invalid="ignore", divide="ignore"):
        shell_share = shell[number] / feature_area[owner[number]]
    problem = Problem(chunk, prepared, weight, verdict, shell_share)
    for feature, reason in reasons.items():
        problem.refuse(feature, reason)
    return problem


def _floors(smallest_part, min_length, min_hole):
    """What is too small, for each feature, and {feature: why its number is none}."""
    reasons, floors = {}, []
    for name, values, most in (
        ("SMALLEST_PART", smallest_part, 100.0),
        ("MIN_LENGTH", min_length, math.inf),
        ("MIN_HOLE", min_hole, math.inf),
    ):
        bad = ~((values >= 0.0) & (values <= most))
        for f in np.flatnonzero(bad).tolist():
            reasons[f] = (
                Sentence(
                    "{} must be a number from 0 to {:g}, and is {}", name, most, number_or_none(values[f])
                )
                if most < math.inf
                else Sentence("{} must be a number from 0 on, and is {}", name, number_or_none(values[f]))
            )
        floors.append(np.where(bad, 0.0, values))
    return floors, reasons


def for_tau(
    problem: Problem, tau: np.ndarray, *, max_gap: float = 0.001, check: Callable = ignore
) -> tuple[Selection, dict[int, float]]:
    """Choose the cuts for a largest detour (MinSize or MinWeight, section 2 of the paper).

    Parameters
    ----------
    problem : Problem
        Features whose tau is no number of at least 1 are refused.
    tau : (f,) float
        Of each feature.
    max_gap : float
        See ``solve.select``.
    check : callable, optional
        Called now and then; may raise `Cancelled`.

    Returns
    -------
    selection : Selection
    open_gaps : dict
        For each feature whose search ended early, the gap to the lower bound as a share of the cost.

    Examples
    --------
    An hourglass: the way around its neck is longer than 4 times the way across, so there is a cut.

    >>> from isthmus.core import metric, rings
    >>> xy = np.array([[0, 0], [5, 4], [15, 0], [15, 10], [5, 6], [0, 10.0]])
    >>> chunk = Chunk(["land"], rings.one_polygon(xy, [0, 6]), np.array([0]), [None], metric.planar())
    >>> no = np.zeros(1)
    >>> problem = prepare(chunk, natural=False, smallest_part=no, min_length=no, min_hole=no)
    >>> selection, open_gaps = for_tau(problem, np.array([4.0]))
    >>> problem.prepared.edge_rows[selection.selected].tolist(), open_gaps
    ([[1, 4]], {})
    """
    bad = ~((tau >= 1.0) & (tau < np.inf))
    for f in np.flatnonzero(bad).tolist():
        problem.refuse(f, Sentence("tau must be a number of at least 1, and is {}", number_or_none(tau[f])))
    selection = solve.select(
        problem.prepared,
        np.where(bad, 1.0, tau)[problem.owner],
        weight=problem.weight,
        max_gap=max_gap,
        time_limit=TIME_LIMIT * max(len(problem.owner), 1),
        check=check,
        with_dilation=False,
    )
    cost = by_feature(problem, selection.cost)
    gap = cost - by_feature(problem, selection.lower_bound)
    # the search ends at exactly the gap allowed, give or take a rounding error
    beyond = np.flatnonzero(gap > (max_gap + 1e-9) * cost)
    return selection, dict(zip(beyond.tolist(), (gap[beyond] / cost[beyond]).tolist()))


def within_budget(
    problem: Problem, budget: Sequence[float], check: Callable = ignore
) -> tuple[Selection, dict[int, float]]:
    """Choose the cuts with the smallest largest detour that a budget allows.

    The dual of the problems with a given tau (section 2 of the paper).

    Parameters
    ----------
    problem : Problem
        Features whose budget is no number of at least 0, or too small, are refused.
    budget : sequence of float
        Of each feature: the number, length or weight of its cuts.
    check : callable, optional
        Called now and then; may raise `Cancelled`.

    Returns
    -------
    selection : Selection
    unproven : dict
        For each feature for which a smaller detour could be neither shown nor ruled out, the one achieved.

    Examples
    --------
    An hourglass and a budget of one cut, which is best spent at its neck.

    >>> from isthmus.core import metric, rings
    >>> xy = np.array([[0, 0], [5, 4], [15, 0], [15, 10], [5, 6], [0, 10.0]])
    >>> chunk = Chunk(["land"], rings.one_polygon(xy, [0, 6]), np.array([0]), [None], metric.planar())
    >>> no = np.zeros(1)
    >>> problem = prepare(chunk, natural=False, smallest_part=no, min_length=no, min_hole=no)
    >>> selection, unproven = within_budget(problem, [1.0])
    >>> problem.prepared.edge_rows[selection.selected].tolist(), unproven
    ([[1, 4]], {})
    >>> selection.dilation.round(1).tolist()
    [1.1]
    """
    count, tau, unproven = len(problem.chunk.features), [], {}
    for f, own in enumerate(budget):
        if not 0.0 <= own < math.inf:
            problem.refuse(
                f, Sentence("the budget must be a number of at least 0, and is {}", number_or_none(own))
            )
    options = _trial(problem, check)
    answers = together(
        [smallest_dilation(own) for own in budget],
        joint_solver(problem.prepared, np.where(problem.solved, problem.owner, -1), count, **options),
    )
    for f, (answer, proven) in enumerate(answers):
        if isinstance(answer, OverBudget):
            unmet = Sentence(
                "the budget of {:g} cannot be met: the least possible cost is {:.12g}, for the cuts that "
                "connect holes",
                budget[f], answer.least,
            )  # fmt: skip
            problem.refuse(f, unmet)
        elif not proven:
            unproven[f] = answer.dilation
        tau.append(math.inf if isinstance(answer, OverBudget) else answer.tau)
    return solve.select(problem.prepared, np.array(tau)[problem.owner], **options), unproven


def curves(problem: Problem, low: float, high: float, most: int, check: Callable = ignore) -> list[tuple]:
    """Follow the trade-off of each feature of a chunk.

    Parameters
    ----------
    problem : Problem
    low, high : float
        Bounds of tau; high may be infinite.
    most : int
        The largest number of steps.
    check : callable, optional
        Called now and then; may raise `Cancelled`.

    Returns
    -------
    list of (TradeOff, list)
        For each feature its curve, and a row for each step: tau, number of cuts, their length, cost, and the
        share of the largest part (NaN where areas are beyond what doubles hold).

    Examples
    --------
    An hourglass: with no cut the largest detour is 11.4; one that is 2 long makes it 1.1, and the larger part
    is two thirds then.

    >>> from isthmus.core import metric, rings
    >>> xy = np.array([[0, 0], [5, 4], [15, 0], [15, 10], [5, 6], [0, 10.0]])
    >>> chunk = Chunk(["land"], rings.one_polygon(xy, [0, 6]), np.array([0]), [None], metric.planar())
    >>> no = np.zeros(1)
    >>> problem = prepare(chunk, natural=False, smallest_part=no, min_length=no, min_hole=no)
    >>> [(curve, steps)] = curves(problem, 1.5, math.inf, 9)
    >>> [[round(x, 2) for x in step] for step in steps]
    [[11.4, 0, 0.0, 0.0, 1.0], [1.1, 1, 2.0, 1.0, 0.67]]
    """
    count, prepared, solved = len(problem.chunk.features), problem.prepared, problem.solved
    options = _trial(problem, check)
    solver = joint_solver(prepared, np.where(solved, problem.owner, -1), count, **options)
    found = together([trade_off(low, high, most) for _ in range(count)], solver)
    rows: list[list] = [[] for _ in range(count)]
    for step in range(max((len(curve.solutions) for curve in found), default=0)):
        own = [curve.solutions[step] if step < len(curve.solutions) else None for curve in found]
        tau = np.array([math.inf if joint is None else joint.tau for joint in own])
        selection = solve.select(prepared, tau[problem.owner], **options)
        result = solve.finish(prepared, selection, check=check)
        of_cut = problem.owner[prepared.owner[selection.selected]]
        mine = solved[prepared.owner[selection.selected]]
        number = np.bincount(of_cut[mine], minlength=count)
        length = np.bincount(of_cut[mine], weights=prepared.chord[selection.selected[mine]], minlength=count)
        part_polygon = groups(result.parts.part_offsets)
        mine = solved[part_polygon]
        of_part, area = problem.owner[part_polygon[mine]], result.parts.area[mine]
        total, largest = np.bincount(of_part, weights=area, minlength=count), np.zeros(count)
        np.maximum.at(largest, of_part, area)
        for f, joint in enumerate(own):
            if joint is not None:
                share = float(largest[f] / total[f]) if 0.0 < total[f] < math.inf else math.nan
                rows[f].append([joint.dilation, int(number[f]), float(length[f]), joint.cost, share])
    return list(zip(found, rows))


def _trial(problem: Problem, check: Callable) -> dict[str, Any]:
    """How each trial of a search is solved."""
    return {
        "weight": problem.weight,
        "max_gap": 0.0,
        "check": check,
        "time_limit": TRIAL_LIMIT * max(len(problem.owner), 1),
    }


def without_vertex(problem: Problem, selection: Selection, tau: np.ndarray) -> int:
    """Count the places where a cut is missing for want of a vertex (`solve.without_vertex`).

    ``tau`` is that of each feature; one that is none counts nothing.

    Examples
    --------
    A notch in the upper side comes near the lower side, where there is no vertex to cut to.

    >>> from isthmus.core import metric, rings
    >>> xy = np.array([[0, 0], [20, 0], [20, 10], [11, 10], [10, 1], [9, 10], [0, 10.0]])
    >>> chunk = Chunk(["land"], rings.one_polygon(xy, [0, 7]), np.array([0]), [None], metric.planar())
    >>> no = np.zeros(1)
    >>> problem = prepare(chunk, natural=False, smallest_part=no, min_length=no, min_hole=no)
    >>> tau = np.array([4.0])
    >>> without_vertex(problem, for_tau(problem, tau)[0], tau)
    1
    """
    tau = np.where(tau >= 1.0, tau, np.inf)
    found = solve.without_vertex(problem.prepared, selection, tau[problem.owner])
    return int(by_feature(problem, found).sum())


def by_feature(problem: Problem, values: np.ndarray) -> np.ndarray:
    """Sum up numbers of the prepared polygons that are solved, for each feature.

    Examples
    --------
    Three triangles; the first two are one feature.

    >>> from isthmus.core import metric
    >>> xy = np.tile([[0, 0], [1, 0], [0, 1.0]], (3, 1))
    >>> rings = Rings(xy, np.array([0, 3, 6, 9]), np.arange(4))
    >>> chunk = Chunk(["a", "b"], rings, np.array([0, 0, 1]), [None, None], metric.planar())
    >>> no = np.zeros(2)
    >>> problem = prepare(chunk, natural=False, smallest_part=no, min_length=no, min_hole=no)
    >>> by_feature(problem, np.array([1.0, 2.0, 4.0])).tolist()
    [3.0, 4.0]
    """
    solved = problem.solved
    return np.bincount(problem.owner[solved], weights=values[solved], minlength=len(problem.chunk.features))


def costs(problem: Problem, solution: Selection | Partition) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the cost of each feature, its lower bound, and the gap between them in per cent of the cost."""
    cost, bound = by_feature(problem, solution.cost), by_feature(problem, solution.lower_bound)
    gap = np.divide(100.0 * (cost - bound), cost, out=np.zeros(len(cost)), where=cost > 0.0)
    return cost, bound, gap


def largest_dilations(problem: Problem, solution: Partition) -> np.ndarray:
    """Return the largest dilation left in each feature; 1 where nothing of it is solved."""
    solved, largest = problem.solved, np.ones(len(problem.chunk.features))
    np.maximum.at(largest, problem.owner[solved], np.asarray(solution.largest_dilation)[solved])
    return largest


def pieces(problem: Problem, parts: Parts) -> Pieces:
    """Arrange what became of the polygons of a chunk.

    Parameters
    ----------
    problem : Problem
    parts : Parts
        Of the prepared polygons.

    Returns
    -------
    Pieces

    Examples
    --------
    An hourglass is cut at its neck into two pieces.

    >>> from isthmus.core import metric, rings
    >>> xy = np.array([[0, 0], [5, 4], [15, 0], [15, 10], [5, 6], [0, 10.0]])
    >>> chunk = Chunk(["land"], rings.one_polygon(xy, [0, 6]), np.array([0]), [None], metric.planar())
    >>> no = np.zeros(1)
    >>> problem = prepare(chunk, natural=False, smallest_part=no, min_length=no, min_hole=no)
    >>> solution = solve.finish(problem.prepared, for_tau(problem, np.array([4.0]))[0])
    >>> found = pieces(problem, solution.parts)
    >>> offsets = found.offsets.tolist()
    >>> found.area.tolist(), [found.rows[lo:hi].tolist() for lo, hi in zip(offsets[:-1], offsets[1:])]
    ([60.0, 30.0], [[1, 2, 3, 4], [0, 1, 4, 5]])
    """
    rings, owner = problem.chunk.rings, problem.chunk.owner
    number = problem.prepared.polygons.number
    count, part_count = len(owner), len(parts.area)
    part_polygon = np.repeat(number, np.diff(parts.part_offsets))
    solved = np.flatnonzero(problem.verdict[part_polygon] == "")
    whole = np.flatnonzero(problem.verdict != "")
    # the parts, and behind them the polygons as they came
    polygon = np.concatenate((part_polygon[solved], whole))
    piece = np.concatenate((solved, part_count + whole))
    area = np.concatenate((parts.area[solved], _areas(rings, whole, problem.chunk.measure)[0]))
    order = np.lexsort((piece, polygon, -area, owner[polygon]))
    rank = np.empty(part_count, dtype=np.int64)
    feature_offsets = offsets_of(np.bincount(owner[polygon], minlength=len(problem.chunk.features)))
    place = np.empty(len(order), dtype=np.int64)
    place[order] = np.arange(len(order)) - feature_offsets[owner[polygon[order]]] + 1
    rank[solved] = place[: len(solved)]
    polygon, piece, area = polygon[order], piece[order], area[order]

    single = np.bincount(part_polygon, minlength=count)[polygon] == 1
    piece = np.where(single, part_count + polygon, piece)
    rows = np.concatenate((parts.rows, np.arange(len(rings.coords))))
    offsets = np.append(parts.offsets[:-1], parts.offsets[-1] + rings.offsets)
    ring_offsets = np.append(parts.ring_offsets[:-1], parts.ring_offsets[-1] + rings.polygon_offsets)
    ring, ring_offsets = take(ring_offsets, piece)
    row, offsets = take(offsets, ring)
    return Pieces(feature_offsets, polygon, area, rows[row], offsets, ring_offsets, rank)


def cuts(problem: Problem, solution: Partition, found: Pieces) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Return the cuts of a chunk: candidates, by feature, and what is told of them.

    Parameters
    ----------
    problem : Problem
    solution : Partition
    found : Pieces

    Returns
    -------
    chosen : (c,) int
        Candidates of the solution, as `solve.Partition` numbers them.
    fields : dict of (c,) arrays
        length, detour (infinite where only a cut connects the ends), part_a, part_b (numbers of the parts
        on both sides, the smaller one first) and share (the smaller side in per cent of the feature; NaN
        where it was not measured).

    Examples
    --------
    An hourglass is cut at its neck, between part 1 and part 2.

    >>> from isthmus.core import metric, rings
    >>> xy = np.array([[0, 0], [5, 4], [15, 0], [15, 10], [5, 6], [0, 10.0]])
    >>> chunk = Chunk(["land"], rings.one_polygon(xy, [0, 6]), np.array([0]), [None], metric.planar())
    >>> no = np.zeros(1)
    >>> problem = prepare(chunk, natural=False, smallest_part=no, min_length=no, min_hole=no)
    >>> solution = solve.finish(problem.prepared, for_tau(problem, np.array([4.0]))[0])
    >>> chosen, fields = cuts(problem, solution, pieces(problem, solution.parts))
    >>> solution.edge_rows[chosen].tolist()
    [[1, 4]]
    >>> [(name, fields[name].round(1).tolist()) for name in ("length", "detour", "part_a", "part_b")]
    [('length', [2.0]), ('detour', [11.4]), ('part_a', [1]), ('part_b', [2])]
    """
    chosen = np.flatnonzero(solution.role == SELF)
    own = problem.solved[solution.owner[chosen]]
    sides = np.sort(found.number[solution.parts.sides], axis=1)[own]
    chosen = chosen[own]
    return chosen, {
        "length": solution.length[chosen],
        "detour": solution.detour[chosen],
        "part_a": sides[:, 0],
        "part_b": sides[:, 1],
        "share": 100.0 * solution.share[chosen] * problem.shell_share[solution.owner[chosen]],
    }


def _areas(rings: Rings, which: np.ndarray, measure: Metric) -> tuple[np.ndarray, np.ndarray]:
    """Areas of some polygons, and of their shells; 0 where they have none."""
    area, shell = np.zeros(len(which)), np.zeros(len(which))
    ring, polygon_offsets = take(rings.polygon_offsets, which)
    size = np.diff(rings.offsets)[ring]
    if not len(ring):
        return area, shell
    hollow = np.minimum.reduceat(size, polygon_offsets[:-1]) == 0
    if hollow.any():
        area[~hollow], shell[~hollow] = _areas(rings, which[~hollow], measure)
        return area, shell
    row, offsets = take(rings.offsets, ring)
    with np.errstate(all="ignore"):
        own = np.abs(signed_areas(measure.equal_area(rings.coords[row, :2]), offsets))
        shell = own[polygon_offsets[:-1]]
        area = np.nan_to_num(shell - (np.add.reduceat(own, polygon_offsets[:-1]) - shell))
        return np.minimum(np.maximum(area, 0.0), 1e300), np.minimum(np.nan_to_num(shell), 1e300)
