"""Well-known binary of polygons and lines, from flat arrays: Z and M come and go bit for bit.

ISO WKB, little-endian. What reads it (QGIS, GEOS) makes the geometry; here are bytes only.
"""

from __future__ import annotations

import struct
from typing import Iterator, Sequence

import numpy as np

from .rings import closed

__all__ = ["lines", "polygons", "width"]

_COUNT = struct.Struct("<I")


def width(extra: int) -> int:
    """Return the ordinates of a vertex, by what ISO WKB adds to a type number: 0, 1000 (Z), 2000 (M), 3000.

    Examples
    --------
    >>> [width(extra) for extra in (0, 1000, 2000, 3000)]
    [2, 3, 3, 4]
    """
    return 2 + (extra in (1000, 3000)) + (extra in (2000, 3000))


def header(kind: int, count: int) -> bytes:
    """Return how a geometry begins: its type number, and how many parts or points follow."""
    return struct.pack("<BII", 1, kind, count)


def polygons(
    coords: np.ndarray, rows: np.ndarray, offsets: np.ndarray, ring_offsets: np.ndarray,
    extra: Sequence[int], multi: bool,
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
    data = coords[rows[place]]
    ordinates = coords.shape[1]
    at = (8 * ordinates * closed_offsets).tolist()
    counts = [_COUNT.pack(count) for count in np.diff(closed_offsets).tolist()]
    raw = data.tobytes()
    bounds = ring_offsets.tolist()
    for lo, hi, more in zip(bounds[:-1], bounds[1:], extra):
        chunks = [header(6 + more, 1)] if multi else []
        chunks.append(header(3 + more, hi - lo))
        own = width(more)
        for ring in range(lo, hi):
            part = raw[at[ring]:at[ring + 1]]
            if own != ordinates:
                part = np.frombuffer(part).reshape(-1, ordinates)[:, :own].tobytes()
            chunks += (counts[ring], part)
        yield b"".join(chunks)


def lines(coords: np.ndarray, rows: np.ndarray, extra: Sequence[int]) -> Iterator[bytes]:
    """Yield straight lines between rows.

    Parameters
    ----------
    coords : (k, d) float
    rows : (l, 2) int
    extra : (l,) int
        What each line has beside x and y, see `width`.

    Examples
    --------
    >>> (one,) = lines(np.eye(2), np.array([[0, 1]]), [0])
    >>> len(one)
    41
    """
    ordinates = coords.shape[1]
    raw, step = coords[rows].tobytes(), 16 * ordinates
    for k, more in enumerate(extra):
        part, own = raw[k * step:(k + 1) * step], width(more)
        if own != ordinates:
            part = np.frombuffer(part).reshape(2, ordinates)[:, :own].tobytes()
        yield header(2 + more, 2) + part
