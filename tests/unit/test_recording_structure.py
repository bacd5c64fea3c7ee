"""Structure of a load history: branches, reversals, holds, dead zone."""

import numpy as np

import cyclosweep as cs

UP = np.linspace(0.05, 10, 200)
LOOP = np.r_[UP, np.full(30, 10.0), UP[::-1], -UP, -UP[::-1]]


def test_branches_of_a_loop_with_a_hold() -> None:
    structure = cs.Recording.from_arrays(LOOP).structure
    assert [branch.direction for branch in structure.branches] == [
        "loading", "unloading", "loading", "unloading",
    ]  # fmt: skip
    assert structure.branches[0].torque_to_nm == 10.0
    assert structure.branches[2].torque_to_nm == -10.0
    (hold,) = structure.holds
    assert (hold.torque_nm, hold.stop - hold.start) == (10.0, 32)
    assert len(structure.reversals) == 2
    np.testing.assert_array_equal(LOOP[structure.reversals], [10.0, -10.0])


def test_noise_makes_no_branches() -> None:
    noisy = LOOP + np.random.default_rng(1).normal(scale=0.05, size=len(LOOP))
    structure = cs.Recording.from_arrays(noisy).structure
    long = [branch for branch in structure.branches if branch.stop - branch.start > 3]
    assert [branch.direction for branch in long] == [
        "loading", "unloading", "loading", "unloading",
    ]  # fmt: skip
    assert len(structure.branches) <= 6


def test_every_sample_belongs_to_one_branch_of_its_run() -> None:
    run = np.repeat([1, 2], [430, len(LOOP) - 430])
    recording = cs.Recording.from_arrays(LOOP, run=run)
    counted = np.zeros(len(LOOP), dtype=int)
    for branch in recording.structure.branches:
        counted[branch.start : branch.stop] += 1
        assert set(run[branch.start : branch.stop]) == {branch.run}
    assert (counted == 1).all()


def test_nested_loops_show_as_reversals() -> None:
    nested = np.r_[np.linspace(1, 10, 50), np.linspace(10, 5, 50), np.linspace(5, 10, 50)]
    structure = cs.Recording.from_arrays(nested).structure
    np.testing.assert_allclose(nested[structure.reversals], [10, 5])
    assert [branch.direction for branch in structure.branches] == [
        "loading", "unloading", "loading",
    ]  # fmt: skip


def test_dead_zone_is_where_torque_vanishes() -> None:
    torque = np.r_[LOOP, np.zeros(7)]
    dead = cs.Recording.from_arrays(torque).structure.dead_zone
    assert dead[-7:].all()
    assert not dead[np.abs(torque) > 0.1].any()


def test_constant_and_empty_histories_have_a_structure() -> None:
    assert len(cs.Recording.from_arrays(np.ones(9)).structure.branches) == 1
    assert cs.Recording.from_arrays(np.zeros(0)).structure.branches == ()
