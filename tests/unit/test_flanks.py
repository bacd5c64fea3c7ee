"""The flank in contact: readings taken while the play is crossed are in contact with none."""

import numpy as np

from cyclosweep.design.nominal_line import NominalLine
from cyclosweep.diagnosis.prepare.flank_lines import find_flanks
from cyclosweep.diagnosis.prepare.play_jumps import sides_by_jumps
from cyclosweep.simulation.effects.history import Flags
from tests.support.arrays import Floats

PLAY = 28.0
COMPLIANCE = 2.7


LINE = NominalLine(PLAY, COMPLIANCE)


def crossings(size: int = 41, loops: int = 4) -> Floats:
    """Torque up and down between -20 and 20 N m."""
    up = np.linspace(-20.0, 20.0, size)
    return np.tile(np.r_[up, up[-2:0:-1]], loops)


def twist(torque: Floats, noise: Floats) -> Floats:
    return np.asarray(PLAY * np.sign(torque) + COMPLIANCE * torque + noise)


def contact(torque: Floats, angle: Floats) -> Flags:
    return find_flanks(torque, angle, LINE).at(torque, angle)[1]


def test_a_reading_on_its_way_to_the_flank_is_not_in_contact() -> None:
    torque = crossings()
    angle = twist(torque, 0.05 * np.random.default_rng(1).normal(size=len(torque)))
    # Readings at zero torque are within the play; beside some of them the flank is nearly reached.
    lightest = np.flatnonzero(torque == 1.0)[[1, 4]]
    angle[lightest] -= (1.2, 2.5)
    found = contact(torque, angle)
    assert not found[lightest].any()
    expected = torque != 0.0
    expected[lightest] = False
    np.testing.assert_array_equal(found, expected)


def test_readings_within_the_width_of_a_loop_are_in_contact() -> None:
    # Friction: unloading readings lie further within the play than the noise is large.
    torque = crossings()
    sense = np.sign(np.diff(torque, prepend=torque[0] - 1.0))
    angle = twist(torque, 0.6 * sense + 0.02 * np.random.default_rng(2).normal(size=len(torque)))
    angle[torque == 0.0] = 0.0
    np.testing.assert_array_equal(contact(torque, angle), torque != 0.0)


def test_readings_are_not_taken_by_their_noise_where_the_drive_has_no_play() -> None:
    torque = np.repeat(crossings(9), 40)
    for seed in range(20):
        noise = 0.3 * np.random.default_rng(seed).normal(size=len(torque))
        for step in (0.0, 0.5):
            angle = COMPLIANCE * torque + noise
            angle = step * np.rint(angle / step) if step else angle
            flanks = find_flanks(torque, angle, LINE, resolution_deg=step)
            assert flanks.free_play_deg < flanks.scatter_deg
            assert flanks.at(torque, angle)[1].all()


def test_without_readings_within_the_play_none_is_on_its_way() -> None:
    torque = crossings(40)
    angle = twist(torque, 0.05 * np.random.default_rng(3).normal(size=len(torque)))
    angle[np.flatnonzero(np.abs(torque) < 1.0)[2]] *= 0.95
    assert contact(torque, angle).all()


def test_a_steep_curve_at_small_torque_sampled_closely_is_in_contact() -> None:
    torque = crossings(801)
    curve = -2.0 * np.sign(torque) * np.exp(-np.abs(torque) / 0.8)
    angle = twist(torque, curve + 0.05 * np.random.default_rng(4).normal(size=len(torque)))
    angle[torque == 0.0] = 0.0
    np.testing.assert_array_equal(contact(torque, angle), torque != 0.0)


def test_a_held_load_is_on_its_own_flank_where_a_loop_wider_than_the_play_hides_it() -> None:
    # Creep widens the loop beyond a small play: readings at a quarter of the load lie anywhere.
    play = 0.4
    level = [3.0, 6.0, 9.0, 12.0, 9.0, 6.0, 3.0, 0.0, -3.0, -6.0, -9.0, -12.0, -6.0, -3.0, 0.0]
    torque = np.repeat(level, 120)
    late = np.zeros(len(torque))
    for k in range(1, len(torque)):
        late[k] = late[k - 1] + 0.05 * (0.08 * torque[k - 1] - late[k - 1])
    late += 2e-4 * np.cumsum(torque)
    flank = np.sign(torque)
    flank[7 * 120 : 8 * 120], flank[-120:] = 1.0, -1.0
    angle = 1.8 * torque + play * flank + late
    side, _ = find_flanks(torque, angle, NominalLine(play, 1.8)).at(torque, angle)
    np.testing.assert_array_equal(side, flank)


def test_the_flank_changes_where_the_angle_jumps() -> None:
    # Friction of 1.5 N m holds the shaft on its flank beyond zero torque, and the play is small.
    torque = crossings(80)
    elastic, held = np.empty_like(torque), 0.0
    for row, applied in enumerate(torque):
        held = min(max(held, applied - 1.5), applied + 1.5)
        elastic[row] = held
    rng = np.random.default_rng(4)
    angle = 0.8 * np.sign(elastic) + COMPLIANCE * elastic + 0.05 * rng.normal(size=len(torque))
    side, known = find_flanks(torque, angle, NominalLine(0.5, COMPLIANCE)).at(torque, angle)
    clear = known & (np.abs(elastic) > 1e-9)
    np.testing.assert_array_equal(side[clear], np.sign(elastic[clear]))
    assert np.sum(clear & (np.sign(torque) != side)) > 10


def test_no_jump_is_looked_for_across_runs_or_where_the_play_is_crossed_slowly() -> None:
    torque = crossings(80)
    angle = twist(torque, 0.05 * np.random.default_rng(5).normal(size=len(torque)))
    loaded, side = np.abs(torque) > 5.0, np.where(torque >= -2.0, 1.0, -1.0)
    line = (COMPLIANCE, PLAY)
    one_run = np.zeros(len(torque), dtype=np.int64)
    moved = sides_by_jumps(torque, angle, side, loaded, one_run, line)
    assert np.array_equal(moved[torque != 0.0], np.sign(torque)[torque != 0.0])
    apart = np.cumsum(np.diff(np.sign(torque), prepend=np.sign(torque[0])) != 0)
    np.testing.assert_array_equal(sides_by_jumps(torque, angle, side, loaded, apart, line), side)
    slow = np.clip(20.0 * torque, -PLAY, PLAY) + COMPLIANCE * torque
    np.testing.assert_array_equal(sides_by_jumps(torque, slow, side, loaded, one_run, line), side)


def test_the_play_is_crossed_about_the_middle_of_each_run() -> None:
    # A zero that drifts by a fifth of the play and a loop narrower than it: readings at rest in the
    # middle of the play are in contact with no flank, in the first run and in the last.
    play, drift = 0.03, np.array([-0.009, -0.003, 0.003, 0.009])
    torque = np.r_[0.0, crossings(121, 1), 0.0]
    sense = np.sign(np.diff(torque, prepend=-1.0))
    one = play * np.sign(torque) + 0.0015 * (torque - 2.0 * sense)
    one[torque == 0.0] = 0.0
    run = np.repeat(np.arange(4), len(torque))
    noise = 0.0005 * np.random.default_rng(6).normal(size=len(run))
    angle = np.tile(one, 4) + np.repeat(drift, len(torque)) + noise
    torques = np.tile(torque, 4)
    flanks = find_flanks(torques, angle, NominalLine(play, 0.0015))
    _, in_contact = flanks.at(torques, angle, run=run)
    assert not in_contact[torques == 0.0].any()
    assert in_contact[np.abs(torques) > 4.0].all()


def test_flanks_of_runs_that_begin_elsewhere_are_told_about_their_own_middle() -> None:
    """Runs at positions of the mesh whose error is larger than the play."""
    torque = np.tile(crossings(40, 1), 6)
    run = np.repeat(np.arange(6), len(torque) // 6)
    offset = 2.0 * np.cos(2.0 * np.pi * run / 6.0)
    noise = 0.02 * np.random.default_rng(5).normal(size=len(torque))
    angle = 0.5 * np.sign(torque) + COMPLIANCE * torque + offset + noise
    flanks = find_flanks(torque, angle, LINE, run=run)
    side, found = flanks.at(torque, angle, run=run)
    np.testing.assert_array_equal(side, np.sign(torque))
    assert found.all()
    assert abs(flanks.free_play_deg - 0.5) < 0.02


def test_the_play_of_a_drive_that_gives_way_is_seen_by_its_light_readings() -> None:
    """The line through loaded readings showed none, so that the torque's sign told the flank."""
    torque = crossings(289, 1)
    torque = torque + 0.013
    sign = np.sign(torque)
    softer = 7.5 * np.maximum(np.abs(torque) - 10.0, 0.0)
    noise = 0.08 * np.random.default_rng(3).normal(size=len(torque))
    angle = twist(torque, sign * softer + noise)
    # A reading that has just passed zero is still on the flank that the shaft comes from.
    still_there = np.flatnonzero(np.abs(torque) < 0.02)[:1]
    angle[still_there] -= 2.0 * PLAY
    found = find_flanks(torque, angle, LINE)
    assert abs(found.free_play_deg - PLAY) < 0.2
    side, _ = found.at(torque, angle)
    expected = np.where(torque >= 0.0, 1.0, -1.0)
    expected[still_there] = -1.0
    np.testing.assert_array_equal(side, expected)


def test_readings_at_the_beginning_of_a_slow_crossing_are_not_in_contact() -> None:
    # Turned at a constant speed: the torque stands still while the play is crossed.
    rng = np.random.default_rng(6)
    loaded = np.linspace(0.0, 20.0, 150)
    half = np.r_[loaded, loaded[::-1][1:]]
    within = np.linspace(PLAY, -PLAY, 75)[1:-1]
    hold = np.full(len(within), -0.4)
    torque = np.r_[half, hold, -half, -hold, half]
    angle = np.r_[PLAY + COMPLIANCE * half, within, -PLAY - COMPLIANCE * half, -within]
    angle = np.r_[angle, PLAY + COMPLIANCE * half]
    sense = np.sign(np.diff(torque, prepend=-1.0))
    angle += np.where(np.abs(torque) > 0.4, 2.0 * sense, 0.0) + 0.15 * rng.normal(size=len(angle))
    found = contact(torque, angle)
    crossing = np.zeros(len(torque), dtype=bool)
    crossing[len(half) : len(half) + len(within)] = True
    crossing[2 * len(half) + len(within) :][: len(within)] = True
    far = crossing & (np.abs(np.abs(angle) - PLAY) > 2.0)
    assert not found[far].any()
    assert found[~crossing & (np.abs(torque) > 2.0)].all()
