"""Well-known binary of polygons and lines, from flat arrays: Z and M come and go bit for bit.

ISO WKB, little-endian. What reads it (QGIS, GEOS) makes the geometry; here are bytes only.
"""

from __future__ import annotations

import struct
from functools import cache, lru_cache
from typing import Iterator, Sequence

import numpy as np

from .rings import closed, offsets_of

__all__ = ["Runs", "header", "joined", "lines", "polygons", "width"]

_COUNT = struct.Struct("<I")


@cache
def width(extra: int) -> int:
    """Return the ordinates of a vertex, by what ISO WKB adds to a type number: 0, 1000 (Z), 2000 (M), 3000.

    Examples
    --------
    >>> [width(extra) for extra in (0, 1000, 2000, 3000)]
    [2, 3, 3, 4]
    """
    return 2 + (extra in (1000, 3000)) + (extra in (2000, 3000))


@lru_cache(1000)  # most polygons have few rings
def header(kind: int, count: int) -> bytes:
    """Return how a geometry begins: its type number, and how many parts or points follow.

    Examples
    --------
    Little-endian, a polygon (3), of two rings.

    >>> header(3, 2).hex()
    '010300000002000000'
    """
    return struct.pack("<BII", 1, kind, count)


def polygons(
    coords: np.ndarray,
    rows: np.ndarray,
    offsets: np.ndarray,
    ring_offsets: np.ndarray,
    extra: Sequence[int],
    multi: bool,
) -> Iterator[bytes]:
    """Yield polygons of rings of rows.

    Parameters
    ----------
    coords : (k, d) float
    rows : (m,) int
        Rows of all rings, none repeated at its end.
    offsets, ring_offsets : (r + 1,) int, (p + 1,) int
        Where each ring starts in ``rows``, and where the rings of each polygon start.
    extra : (p,) int
        What each polygon has beside x and y, see `width`.
    multi : bool
        Whether to wrap the polygons as multipolygons.

    Examples
    --------
    >>> (one,) = polygons(np.eye(3, 2), np.arange(3), np.array([0, 3]), np.array([0, 1]), [0], False)
    >>> len(one)
    77
    """
    place, closed_offsets = closed(offsets)
    data = coords.take(rows[place], axis=0)
    ordinates = coords.shape[1]
    at = (8 * ordinates * closed_offsets).tolist()
    counts = np.diff(closed_offsets).astype("<u4").tobytes()
    raw = memoryview(data).cast("B") if len(data) else b""
    bounds = ring_offsets.tolist()
    for lo, hi, more in zip(bounds[:-1], bounds[1:], extra):
        chunks: list[bytes | memoryview] = [header(6 + more, 1)] if multi else []
        chunks.append(header(3 + more, hi - lo))
        narrower = width(more) != ordinates
        for ring in range(lo, hi):
            part = raw[at[ring] : at[ring + 1]]
            if narrower:
                part = np.frombuffer(part).reshape(-1, ordinates)[:, : width(more)].tobytes()
            chunks += (counts[4 * ring : 4 * ring + 4], part)
        yield b"".join(chunks)


def lines(
    coords: np.ndarray, rows: np.ndarray, extra: Sequence[int], offsets: np.ndarray | None = None
) -> Iterator[bytes]:
    """Yield lines along rows.

    Parameters
    ----------
    coords : (k, d) float
    rows : (l, 2) int, or (r,) int
    extra : (l,) int
        What each line has beside x and y, see `width`.
    offsets : (l + 1,) int, optional
        Where the rows of each line begin, if not all have two.

    Examples
    --------
    >>> (one,) = lines(np.eye(2), np.array([[0, 1]]), [0])
    >>> len(one)
    41
    """
    ordinates = coords.shape[1]
    raw, step = coords[rows].tobytes(), 8 * ordinates
    bounds = range(0, 2 * len(extra) + 1, 2) if offsets is None else offsets.tolist()
    for lo, hi, more in zip(bounds[:-1], bounds[1:], extra):
        part, own = raw[lo * step : hi * step], width(more)
        if own != ordinates:
            part = np.frombuffer(part).reshape(-1, ordinates)[:, :own].tobytes()
        yield header(2 + more, hi - lo) + part


class Runs:
    """The coordinates of a geometry of any type, to be moved in place: Z, M and the rest stay.

    Parameters
    ----------
    data : bytes
        Little-endian, without curves; empty for no geometry.

    Attributes
    ----------
    counts : list of int
        The number of points of each run: a line, a ring with its closing point, or a point.
    polygons : list of list of int
        The runs that are rings of each polygon, its shell first.

    Examples
    --------
    A line moves by (5, 0).

    >>> (line,) = lines(np.array([[0, 0], [1, 2.0]]), np.array([[0, 1]]), [0])
    >>> runs = Runs(line)
    >>> runs.counts, Runs(runs.moved(runs.xy + [5, 0])).xy.tolist()
    ([2], [[5.0, 0.0], [6.0, 2.0]])
    """

    def __init__(self, data: bytes) -> None:
        self.counts: list[int] = []
        self.polygons: list[list[int]] = []
        self._places: list[tuple[int, int]] = []
        self._data = bytearray(data)
        if data:
            self._read(0)

    @property
    def xy(self) -> np.ndarray:
        """(k, 2) float: the points of all runs."""
        views = [self._view(k)[:, :2] for k in range(len(self.counts))]
        return np.concatenate(views) if views else np.empty((0, 2))

    def moved(self, xy: np.ndarray, splits: Sequence[tuple[int, tuple[float, float], float]] = ()) -> bytes:
        """Return the geometry with its points elsewhere, and points put in after some.

        Parameters
        ----------
        xy : (k, 2) float
        splits : sequence of (point, (x, y), share)
            After which point each is put in, ascending, where it is, and the share of the way to the next
            point, by which its Z and M are between theirs.
        """
        start, lo, pieces, done = 0, 0, [], 0
        for k, count in enumerate(self.counts):
            view = self._view(k)
            view[:, :2] = xy[start : start + count]
            hi = lo
            while hi < len(splits) and splits[hi][0] < start + count:
                hi += 1
            if lo < hi:
                own, lo = splits[lo:hi], hi
                place, size = self._places[k]
                after = np.array([one[0] - start for one in own])
                share = np.array([one[2] for one in own])[:, None]
                more = view[after] + share * (view[after + 1] - view[after])
                more[:, :2] = [one[1] for one in own]
                longer = np.insert(view, after + 1, more, axis=0)
                pieces += [bytes(self._data[done : place - 4]), _COUNT.pack(len(longer)), longer.tobytes()]
                done = place + 8 * count * size
            start += count
        return b"".join(pieces + [bytes(self._data[done:])])

    def _view(self, k: int) -> np.ndarray:
        place, size = self._places[k]
        count = self.counts[k]
        return np.frombuffer(self._data, "<f8", count * size, place).reshape(count, size)

    def _read(self, place: int) -> int:
        """Find the runs of the WKB geometry that starts here; return where it ends."""
        (code,) = struct.unpack_from("<I", self._data, place + 1)
        kind = code % 1000
        if code >= 2**29:  # the old way to tell of Z
            kind = code & 0xFF
        size = 2 + (code // 1000 % 4 in (1, 3)) + (code // 1000 % 4 in (2, 3))
        if code >= 2**29:
            size = 2 + bool(code & 2**31) + bool(code & 2**30)
        place += 5
        if kind == 1:
            return self._run(place, 1, size)
        (count,) = struct.unpack_from("<I", self._data, place)
        place += 4
        if kind == 2:
            return self._run(place, count, size)
        if kind in (3, 17):  # a triangle is a polygon
            rings = []
            for _ in range(count):
                (points,) = struct.unpack_from("<I", self._data, place)
                rings.append(len(self.counts))
                place = self._run(place + 4, points, size)
            if rings:
                self.polygons.append(rings)
            return place
        for _ in range(count):
            place = self._read(place)
        return place

    def _run(self, place: int, count: int, size: int) -> int:
        self.counts.append(count)
        self._places.append((place, size))
        return place + 8 * count * size


def joined(runs: Sequence[Runs]) -> tuple[np.ndarray, np.ndarray, list[list[int]]]:
    """Join the runs of several geometries.

    Returns
    -------
    xy : (k, 2) float
        The points of all runs.
    offsets : (r + 1,) int
        Where each run starts.
    polygons : list of list of int
        The runs that are rings of each polygon, its shell first.

    Examples
    --------
    Two squares, each a ring with its closing point.

    >>> xy, four = np.array([[0, 0], [1, 0], [1, 1], [0, 1.0]]), np.array([0, 4])
    >>> (square,) = polygons(xy, np.arange(4), four, np.array([0, 1]), [0], False)
    >>> xy, offsets, rings = joined([Runs(square), Runs(square)])
    >>> len(xy), offsets.tolist(), rings
    (10, [0, 5, 10], [[0], [1]])
    """
    rings: list[list[int]] = []
    first = 0
    for one in runs:
        rings += [[first + ring for ring in its] for its in one.polygons]
        first += len(one.counts)
    xy = np.concatenate([np.empty((0, 2)), *(one.xy for one in runs)])
    return xy, offsets_of([count for one in runs for count in one.counts]), rings
