from math import atan, atan2, cos, radians, sin, sqrt, tan

import numpy as np
import pytest

from isthmus.core.metric import ellipsoidal, planar

A, B = 6378137.0, 6356752.314245179
METRIC = ellipsoidal(a=A, b=B)


def vincenty(p, q):
    """Geodesic length on WGS 84 (Vincenty 1975, inverse problem); p and q not antipodal."""
    f = 1 - B / A
    reduced = [atan((1 - f) * tan(radians(lat))) for _, lat in (p, q)]
    (s1, c1), (s2, c2) = [(sin(u), cos(u)) for u in reduced]
    apart = lam = radians(q[0] - p[0])
    for _ in range(200):
        sin_s = sqrt((c2 * sin(lam)) ** 2 + (c1 * s2 - s1 * c2 * cos(lam)) ** 2)
        cos_s = s1 * s2 + c1 * c2 * cos(lam)
        sigma = atan2(sin_s, cos_s)
        sin_a = c1 * c2 * sin(lam) / sin_s
        cos2_a = 1 - sin_a**2
        mid = cos_s - 2 * s1 * s2 / cos2_a if cos2_a > 1e-15 else 0.0
        c = f / 16 * cos2_a * (4 + f * (4 - 3 * cos2_a))
        before, lam = (
            lam,
            apart + (1 - c) * f * sin_a * (sigma + c * sin_s * (mid + c * cos_s * (2 * mid**2 - 1))),
        )
        if abs(lam - before) < 1e-13:
            break
    u2 = cos2_a * (A**2 - B**2) / B**2
    big_a = 1 + u2 / 16384 * (4096 + u2 * (u2 * (320 - 175 * u2) - 768))
    big_b = u2 / 1024 * (256 + u2 * (u2 * (74 - 47 * u2) - 128))
    correction = (
        big_b
        * sin_s
        * (
            mid
            + big_b / 4 * (cos_s * (2 * mid**2 - 1) - big_b / 6 * mid * (4 * sin_s**2 - 3) * (4 * mid**2 - 3))
        )
    )
    return B * big_a * (sigma - correction)


def lengths(*pairs):
    points = np.array(pairs, dtype=float).reshape(-1, 2)
    u = np.arange(0, len(points), 2)
    return METRIC.length(METRIC.positions(points), u, u + 1)


@pytest.mark.parametrize(
    "p, q, metres",
    [
        ((0, 0), (1, 0), 111319.490793),  # a degree of the equator: 2 pi a / 360
        ((0, 0), (0, 1), 110574.388558),  # the first degree of a meridian
        ((7, 89), (7, 90), 111693.864915),  # and the last
    ],
)
def test_degrees(p, q, metres):
    assert lengths((p, q)) == pytest.approx(metres, rel=1e-5)
    assert vincenty(p, q) == pytest.approx(metres, rel=1e-9), "the test's own formula"


@pytest.mark.parametrize("longest, error", [(1e3, 1e-7), (1e6, 1.2e-5), (5e6, 3e-4), (1e7, 1.3e-3)])
def test_against_vincenty(longest, error):
    rng = np.random.default_rng(1)
    p = np.column_stack((rng.uniform(-180, 180, 500), rng.uniform(-85, 85, 500)))
    reach = longest / 111e3 / 2
    q = p + rng.uniform(-reach, reach, p.shape)
    q[:, 1] = np.clip(q[:, 1], -89, 89)
    expected = np.array([vincenty(a, b) for a, b in zip(p, q)])
    noise = 1e-8  # of 6,378 km in double precision
    difference = np.abs(lengths(*zip(p, q)) - expected)
    near = expected <= longest
    assert (difference <= error * expected + noise)[near].all()
    assert near.sum() > 100


def test_across_the_antimeridian_and_around_it():
    same = lengths(((179, 10), (181, 12)), ((179, 10), (-179, 12)), ((-1, 10), (1, 12)))
    assert same == pytest.approx(same[0], rel=1e-12)


def test_grads():
    xy, measure = np.array([[10, 50], [12, 51.0], [-3, 90]]), ellipsoidal(a=A, b=B, degrees=0.9)
    for one, other in ((measure.positions, METRIC.positions), (measure.equal_area, METRIC.equal_area)):
        assert one(xy / 0.9) == pytest.approx(other(xy), rel=1e-12)
    assert 0.9 * measure.conformal(xy[:2] / 0.9) == pytest.approx(METRIC.conformal(xy[:2]), rel=1e-12)


def test_distinct_points_are_apart():
    nearly = np.nextafter(12.0, 13.0)
    assert (lengths(((12, 50), (nearly, 50)), ((3, 90), (99, 90))) > 0).all()


@pytest.mark.parametrize("reach, slack", [(0.01, 1e-9), (4.0, 1e-5), (60.0, 2e-4)])
def test_triangle_inequality(reach, slack):
    rng = np.random.default_rng(2)
    a, b, c = np.clip(rng.uniform(-80, 80, (1000, 2)) + rng.uniform(-reach, reach, (3, 1000, 2)), -89, 89)
    ab, bc, ac = (lengths(*zip(p, q)) for p, q in ((a, b), (b, c), (a, c)))
    assert (ac <= (ab + bc) * (1 + slack) + 1e-8).all()


def area(ring):
    x, y = METRIC.equal_area(np.array(ring, dtype=float)).T
    return abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) / 2


def test_area_of_the_earth():
    world = area([(-180, -90), (180, -90), (180, 90), (-180, 90)])
    assert world == pytest.approx(510065621724088, rel=1e-12)


@pytest.mark.parametrize("south", [0, 30, 60, 88])
def test_area_of_a_cell(south):
    """Against the integral of M N cos(lat), by Gauss and Legendre."""
    x, w = np.polynomial.legendre.leggauss(20)
    lat = np.radians(south + (x + 1) / 2)
    e2 = 1 - (B / A) ** 2
    band = A**2 * (1 - e2) * np.cos(lat) / (1 - e2 * np.sin(lat) ** 2) ** 2
    expected = np.radians(1) ** 2 / 2 * (band @ w)
    cell = [(5, south), (6, south), (6, south + 1), (5, south + 1)]
    assert area(cell) == pytest.approx(expected, rel=1e-9)


def test_mercator_is_conformal_and_keeps_the_graticule():
    """Steps of the same length north and east stay alike, at any latitude."""
    for lat in (-70.0, -20.0, 0.0, 45.0, 80.0):
        north, east = 1e-4, 1e-4
        scale = lengths(((0, lat), (0, lat + north)), ((0, lat), (east, lat)))
        plane = METRIC.conformal(np.array([(0, lat), (0, lat + north), (east, lat)]))
        stretched = plane[1, 1] - plane[0, 1], plane[2, 0] - plane[0, 0]
        assert stretched[0] / stretched[1] == pytest.approx(scale[0] / scale[1], rel=1e-4)
        assert plane[2, 1] == plane[0, 1] and plane[1, 0] == plane[0, 0]


def test_sphere():
    sphere = ellipsoidal(a=1.0, b=1.0)
    quarter = np.array([(0.0, 0.0), (90.0, 0.0)])
    assert sphere.length(sphere.positions(quarter), [0], [1]) == pytest.approx(np.pi / 2)
    assert sphere.equal_area(np.array([(0.0, 30.0)]))[0, 1] == pytest.approx(0.5)
    assert np.isfinite(sphere.conformal(quarter)).all()


def test_plane():
    xy = np.array([(0.0, 0.0), (3.0, 4.0)])
    metric = planar()
    assert metric.length(metric.positions(xy), np.array([0]), np.array([1])) == [5.0]
    assert metric.equal_area(xy) is xy and metric.conformal is None
