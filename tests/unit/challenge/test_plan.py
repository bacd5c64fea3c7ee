"""The plan: balanced, extendable, and with nothing in a name that tells."""

from collections import Counter

import pytest

from cyclosweep_challenge.rig.noise import NOISES
from cyclosweep_challenge.trial.plan import MIXES, make_entry, make_plan
from cyclosweep_challenge.trial.tiers import TIERS


def test_a_longer_plan_begins_with_the_shorter_one() -> None:
    assert make_plan(300, 4)[:120] == make_plan(120, 4)


def test_every_tier_and_every_noise_family_takes_part() -> None:
    plan = make_plan(sum(s.weight for s in MIXES["all"]()), 1)
    assert {entry.stratum.tier for entry in plan} == set(TIERS)
    families = Counter(entry.stratum.noise for entry in plan if entry.stratum.tier == "C6")
    assert set(families) == set(NOISES)
    assert len(set(families.values())) == 1


def test_case_seeds_are_far_from_development_seeds_and_all_different() -> None:
    seeds = [entry.case_seed(0) for entry in make_plan(2000, 100_000)]
    assert min(seeds) > 100_000
    assert len(set(seeds)) == len(seeds)


def test_keys_tell_nothing() -> None:
    assert all(entry.key == f"case-{entry.number:06d}" for entry in make_plan(50, 2))


def test_strata_keep_their_promises() -> None:
    seen = set()
    for entry in make_plan(400, 3, "concealed", 2000):
        tier = entry.stratum.tier
        if tier in seen:
            continue
        seen.add(tier)
        truth = make_entry(entry).truth
        causes = truth["causes"]
        if tier == "C1":
            assert causes[0]["absorbed"] >= 0.7
        if tier == "C2":
            assert causes[0]["rms_deg"] < truth["noise"]["sigma_deg"] / 3
            assert causes[0]["rms_deg"] < truth["noise"]["resolution_deg"]
        if tier == "C3":
            assert causes[0]["d"] == pytest.approx(10 * causes[1]["d"], rel=0.02)
        if tier == "C4":
            assert len(causes) >= 2
        if tier == "C5-alien":
            assert truth["effects"] == []
            assert len(truth["aliens"]) == 1
        if tier == "C5-removed":
            assert truth["removed"] in truth["effects"]
        if tier == "C7":
            assert all(c["absorbed"] > 0.999999 for c in causes)
    assert seen == {"C1", "C2", "C3", "C4", "C5-alien", "C5-removed", "C7"}


def test_unknown_mix_is_refused() -> None:
    with pytest.raises(ValueError, match="mix"):
        make_plan(3, 1, "everything")
