"""Answers and diagnoses made by hand, for tests of the scoring."""

from typing import Any

from cyclosweep_challenge.scoring.outcome import HeldOut, Outcome, make_outcome


def truth(*names: str, tier: str = "C0", kind: str = "effect", **more: object) -> dict[str, Any]:
    causes = [
        {"name": n, "kind": kind, "d": 10.0, "peak_deg": 0.5, "rms_deg": 0.3, "oracle_z": 9.0}
        for n in names
    ]
    return {
        "key": "case-1",
        "stratum": "s",
        "tier": tier,
        "programme": "rich",
        "noise": {"family": "white"},
        "effects": [c["name"] for c in causes if kind == "effect"],
        "aliens": [c["name"] for c in causes if kind == "alien"],
        "aliases": [c["name"] for c in causes if kind == "alias"],
        "causes": causes,
        "calibration": {"compliance_deg_per_nm": 2.8, "free_play_deg": 27.0},
        **more,
    }


def diagnosis(verdict: str, *names: str, **more: object) -> dict[str, Any]:
    effects = [
        {"name": n, "rms_deg": 0.33, "size_deg": {"estimate": 0.55, "ci95": [0.45, 0.65]}}
        for n in names
    ]
    return {"verdict": verdict, "effects": effects, **more}


def outcome(t: dict[str, Any], s: dict[str, Any]) -> Outcome:
    return make_outcome(t, s, HeldOut())
