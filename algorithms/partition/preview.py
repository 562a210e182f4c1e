"""Cuts for every tau and every number of parts, at once: what the panel shows while its slider moves.

All that takes long is done once (`preview`): reading, triangulating, the choice of candidates, and the
hierarchy. What `isthmus:partition` does for one tau then takes a hundredth of a second, so the panel shows
the very cuts that the tool makes; the levels by number of parts are those of `isthmus:hierarchy`.
"""

from __future__ import annotations

from typing import Callable, NamedTuple

import numpy as np
from qgis.core import QgsCoordinateReferenceSystem, QgsFeature, QgsProcessingFeedback

from ...core.partition.hierarchy import hierarchy
from ...core.partition.nesting import NO_END, ranked
from ...core.partition.solve import select
from ...core.progress import ignore, stretch
from .cutting import NATURAL
from .solving import Settings, measure_of, prepare, read


class Shown(NamedTuple):
    """Cuts, as they are drawn.

    Attributes
    ----------
    wkb : bytes
        A MultiLineString in the coordinates of the layer.
    cuts, parts : int
    """

    wkb: bytes
    cuts: int
    parts: int


class Preview(NamedTuple):
    """Features that are ready to be cut.

    Attributes
    ----------
    problems : list of Problem
    nested : list
        Of each problem the selected edges at the smallest tau, their persistence, whether they connect
        holes, and their place among the others of their feature (0 for the most persistent).
    tau : float
        The smallest.
    """

    problems: list
    nested: list
    tau: float

    def largest_tau(self) -> float:
        """Return the tau from which on nothing is cut, but for what connects holes."""
        most = self.tau
        for _, persistence, _, _ in self.nested:
            most = max(most, float(persistence[persistence < NO_END].max(initial=self.tau)))
        return float(np.nextafter(most, np.inf))

    def most_parts(self) -> int:
        """Return the number of parts of the feature with the most."""
        most = 1
        for problem, (selected, _, _, place) in zip(self.problems, self.nested):
            polygons = np.bincount(problem.chunk.owner, minlength=len(problem.chunk.features))
            feature, parts = self._features(problem, selected), polygons.copy()
            np.maximum.at(parts, feature, polygons[feature] + place + 1)
            most = max(most, int(parts.max(initial=1)))
        return most

    def unsolved(self) -> list[str]:
        """Return why polygons cannot be cut, each reason once."""
        return list(dict.fromkeys(
            reason for problem in self.problems for reason in problem.verdict.tolist() if reason
        ))  # fmt: skip

    def at_tau(self, tau: float) -> Shown:
        """Return the cuts that `isthmus:partition` makes for a tau.

        Returns
        -------
        Shown
        """
        chosen = []
        for problem in self.problems:
            selection = select(problem.prepared, tau, with_dilation=False)
            chosen.append((selection.selected, selection.carved.tree))
        return self._shown(chosen)

    def at_parts(self, count: int) -> Shown:
        """Return the cuts of the level in which each feature has so many parts, or the next best.

        Returns
        -------
        Shown
        """
        chosen = []
        for problem, (selected, _, in_tree, place) in zip(self.problems, self.nested):
            polygons = np.bincount(problem.chunk.owner, minlength=len(problem.chunk.features))
            kept = in_tree | (place < count - polygons[self._features(problem, selected)])
            chosen.append((selected[kept], selected[in_tree]))
        return self._shown(chosen)

    @staticmethod
    def _features(problem, edges):
        return problem.owner[problem.prepared.owner[edges]]

    def _shown(self, chosen):
        """Draw edges, from (selected, those that connect holes) of each problem."""
        ends, cuts, parts = [np.empty((0, 2, 2))], 0, 0
        for problem, (selected, tree) in zip(self.problems, chosen):
            prepared = problem.prepared
            solved = problem.verdict[prepared.polygons.number[prepared.owner[selected]]] == ""
            selected = selected[solved]
            cuts += len(selected)
            rows, offsets = prepared.way_rows(selected)
            if offsets is not None:  # each stretch by itself
                inner = np.delete(np.arange(len(rows) - 1), offsets[1:-1] - 1)
                rows = rows[np.column_stack((inner, inner + 1))]
            ends.append(problem.chunk.rings.coords[:, :2][rows])
            parts += len(problem.chunk.owner) + int((~np.isin(selected, tree)).sum())
        ends = np.concatenate(ends)
        line = np.dtype([("order", "u1"), ("kind", "<u4"), ("count", "<u4"), ("xy", "<f8", (2, 2))])
        lines = np.zeros(len(ends), line)
        lines["order"], lines["kind"], lines["count"], lines["xy"] = 1, 2, 2, ends
        head = np.array([5, len(ends)], "<u4").tobytes()
        return Shown(b"\x01" + head + lines.tobytes(), cuts, parts)


def preview(
    features: list[QgsFeature],
    crs: QgsCoordinateReferenceSystem,
    *,
    tau: float = 1.5,
    places: str = NATURAL,
    smallest_part: float = 1.0,
    check: Callable = ignore,
    feedback: QgsProcessingFeedback | None = None,
) -> Preview:
    """Do what takes long.

    Parameters
    ----------
    features : list of QgsFeature
    crs : QgsCoordinateReferenceSystem
    tau : float
        The smallest that will be asked for.
    places : {'Natural', 'Any'}
    smallest_part : float
        Per cent of the feature.
    check : callable
        Called now and then with the share done; may raise `Cancelled`.
    feedback : QgsProcessingFeedback
        For warnings.

    Returns
    -------
    Preview
    """
    settings = Settings(
        measure=measure_of(crs), natural=places == NATURAL,
        floors={
            "SMALLEST_PART": lambda feature: smallest_part, "MIN_LENGTH": lambda feature: 0.0,
            "MIN_HOLE": lambda feature: 0.0,
        },
        lines=None, new_vertices=False, weigh=None, all_dilations=False,
    )  # fmt: skip
    problems, nested = [], []
    for chunk in read(features, settings, feedback or QgsProcessingFeedback(False)):
        problem = prepare(chunk, settings, stretch(check, 0.0, 0.5))
        prepared = problem.prepared
        selection = select(prepared, tau, check=stretch(check, 0.5, 0.6), with_dilation=False)
        found = hierarchy(prepared, selection, stretch(check, 0.6, 1.0))
        selected, in_tree = selection.selected, np.isin(selection.selected, selection.carved.tree)
        persistence, rank, _ = ranked(
            problem,
            selected,
            found,
            np.full(len(chunk.features), tau),
            problem.solved[prepared.owner[selected]] & ~in_tree,
        )
        problems.append(problem)
        nested.append((selected, persistence, in_tree, rank - 1))
    return Preview(problems, nested, tau)
