"""Charts of the score's pages."""

import re

from cyclosweep_challenge.board.curves import power_chart, power_series


def curve(scale: float) -> list[tuple[float, float, float, float]]:
    return [(d, scale * d / 20.0, 0.0, 1.0) for d in (3.0, 6.0, 12.0)]


def test_power_is_drawn_over_the_logarithm_of_d_and_marked_where_there_are_recordings() -> None:
    drawn = power_chart("rich", power_series([("a", curve(1.0)), ("b", [])]))
    marks = re.findall(r'<text x="([\d.]+)" y="[\d.]+" text-anchor="middle">(\d+)</text>', drawn)
    assert [name for _, name in marks] == ["3", "6", "12"]
    at = [float(x) for x, _ in marks]
    assert abs((at[1] - at[0]) - (at[2] - at[1])) < 0.2
    circles = [float(x) for x in re.findall(r'<circle cx="([\d.]+)"', drawn)]
    assert circles == at


def test_points_of_one_d_stand_side_by_side_in_colours_of_their_own() -> None:
    series = power_series([(f"who {k}", curve(1.0)) for k in range(13)], apart=1.01)
    assert len({one.colour for one in series}) == 13
    assert [one.x[0] for one in series] == sorted({one.x[0] for one in series})
    assert series[0].x[0] == 3.0


def test_a_chart_without_a_curve_is_an_empty_one() -> None:
    assert "<circle" not in power_chart("poor", power_series([]))
