"""One concealed recording with its answer."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
from numpy.typing import NDArray

from cyclosweep_challenge.rig.aliens import ALIASES, ALIENS
from cyclosweep_challenge.rig.dial import divided
from cyclosweep_challenge.rig.noise import Noise
from cyclosweep_challenge.rig.programme import Programme, make_programme
from cyclosweep_challenge.rig.rig import measure
from cyclosweep_challenge.rig.specimen import EITHER_SIGN, Specimen
from cyclosweep_challenge.trial.concealment import (
    Concealed,
    alias_amplitude,
    conceal,
    opposed_signs,
    rival_overlaps,
)
from cyclosweep_challenge.trial.oracle import oracle_statistic
from cyclosweep_challenge.trial.prediction import fitting_error

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Case:
    """A recording, a second programme on the same specimen, and the answer.

    Attributes
    ----------
    recording : polars.DataFrame
        What the diagnosis sees, in the canonical columns.
    program : polars.DataFrame
        The held-out programme: the same columns without the angle.
    held_out_clean_deg, held_out_read_deg : array
        True and read angle of the held-out programme [deg].
    resolution_deg : float
        Division of the dial [deg].
    truth : dict
        The answer: causes with amplitude, d and size, noise, calibration, oracle's statistics.
    """

    recording: pl.DataFrame
    program: pl.DataFrame
    held_out_clean_deg: Array
    held_out_read_deg: Array
    resolution_deg: float
    truth: dict[str, Any]

    def write(self, folder: str | Path, *, program: bool = True) -> Path:
        """Write ``recording.csv``, ``recording.toml`` and ``program.csv``; no answer among them.

        Without ``program`` the held-out programme is left out.
        """
        target = Path(folder)
        target.mkdir(parents=True, exist_ok=True)
        self.recording.write_csv(target / "recording.csv")
        if program:
            self.program.write_csv(target / "program.csv")
        (target / "recording.toml").write_text(
            'side = "input"\n'
            'drive = "reference-87"\n'
            f"angle_resolution_deg = {self.resolution_deg:g}\n"
        )
        return target


def _frame(programme: Programme, torque_nm: Array, angle_deg: Array | None) -> pl.DataFrame:
    """Canonical table of a programme, with an angle if one was read."""
    columns: dict[str, Any] = {
        "time_s": programme.time_s.round(3),
        "torque_nm": torque_nm.round(5),
    }
    if angle_deg is not None:
        columns["angle_deg"] = angle_deg.round(5)
    columns["run"] = programme.run
    columns["crank_deg"] = programme.crank_deg.round(3)
    columns["temperature_c"] = programme.temperature_c.round(3)
    return pl.DataFrame(columns)


def _causes(found: Concealed, aliases: set[str]) -> list[dict[str, Any]]:
    """Answer's entry of every cause."""
    view = found.visibility
    return [
        {
            "name": name,
            "kind": "alias" if name in aliases else "alien" if name in ALIENS else "effect",
            "amplitude": amplitude,
            "d": float(view.d[k]),
            "d_alone": float(view.d_alone[k]),
            "absorbed": float(view.absorbed[k]),
            "rms_deg": float(view.rms_deg[k]),
            "peak_deg": float(view.peak_deg[k]),
            "raw_rms_deg": float(view.raw_rms_deg[k]),
            "raw_peak_deg": float(view.raw_peak_deg[k]),
            "largest_overlap": float(np.abs(np.delete(view.cosine[k], k)).max(initial=0.0)),
        }
        for k, (name, amplitude) in enumerate(found.amplitudes.items())
    ]


def make_case(
    seed: int,
    effects: Sequence[str] = (),
    d: float | Sequence[float] = 20.0,
    programme: str = "rich",
    noise: str = "white",
    *,
    samples: int = 3000,
    sigma_deg: float = 0.2,
    resolution_deg: float = 0.0,
    signs: Sequence[float] | None = None,
    pulling_apart: bool = False,
    fixed_amplitudes: dict[str, float] | None = None,
    rivals: bool = False,
    tier: str = "",
) -> Case:
    """Make a concealed recording.

    Parameters
    ----------
    seed : int
        Determines specimen, programme, noise and signs; records use seeds from 100,000 on.
    effects : sequence of str
        Causes at work: names of the vocabulary, of ``ALIENS`` or of ``ALIASES``; empty for none.
    d : float or sequence of float
        Wanted projected signal-to-noise of each cause [-]; aliases have none and are skipped.
    programme : {"oneway", "poor", "middle", "rich"}
        Richness of the load programme.
    noise : str
        Family of ``noise.NOISES``.
    samples : int
        Readings wanted.
    sigma_deg, resolution_deg : float
        Noise of one reading and division of the dial [deg]; the family ``resolution`` draws both.
    signs : sequence of float, optional
        Signs of the causes that may have either; drawn if absent.
    pulling_apart : bool
        Turn signs so that the causes' projected signatures cancel where physics lets them.
    fixed_amplitudes : dict, optional
        Further causes at amplitudes given outright, whatever their visibility; they count as
        exact aliases in the answer.
    rivals : bool
        Add to the answer how much each other effect resembles the first cause.
    tier : str
        Label of the concealment, kept in the answer.

    Raises
    ------
    ConcealmentError
        If a cause cannot have the wanted d here.
    ValueError
        If a name is unknown.

    Examples
    --------
    >>> case = make_case(7, effects=("creep",), d=12, programme="rich", samples=600)
    >>> [(c["name"], round(c["d"])) for c in case.truth["causes"]]
    [('creep', 12)]
    """
    streams = np.random.default_rng(seed).spawn(6)
    specimen = Specimen.draw(streams[0], far=noise == "start")
    first = make_programme(programme, streams[1], samples)
    second = make_programme(programme, streams[2], samples, second=True)
    law = Noise.draw(noise, streams[3], sigma_deg, resolution_deg)
    lost = law.lost(len(first), streams[3])
    visible = [name for name in effects if name not in ALIASES]
    wanted = [float(d)] * len(visible) if isinstance(d, (int, float)) else [float(v) for v in d]
    drawn = streams[4].choice([-1.0, 1.0], len(visible))
    if signs is not None:
        drawn = np.asarray(signs, dtype=float)
    either = [s if n in EITHER_SIGN else 1.0 for n, s in zip(visible, drawn, strict=True)]
    aliases = {n: alias_amplitude(n, streams[4]) for n in effects if n in ALIASES}
    aliases |= fixed_amplitudes or {}
    found = conceal(specimen, first, law, visible, wanted, either, lost, aliases)
    if pulling_apart:
        turned = opposed_signs(found, visible, either)
        if turned != either:
            found = conceal(specimen, first, law, visible, wanted, turned, lost, aliases)

    recorded = first.take(found.seen)
    clean = found.response.angle_deg[found.seen]
    slope = specimen.compliance_deg_per_nm
    read = divided(clean + law.errors(recorded, slope, streams[5]), law.resolution_deg)
    later = measure(specimen, second, found.amplitudes)
    later_seen = second.take(later.recorded)
    later_clean = later.angle_deg[later.recorded]
    later_read = divided(
        later_clean + law.errors(later_seen, slope, streams[5]), law.resolution_deg
    )
    causes = _causes(found, set(aliases))
    for k, cause in enumerate(causes):
        if cause["kind"] == "alias":
            continue
        cause["oracle_z"] = oracle_statistic(
            found.visibility.direction[:, k],
            clean - found.signatures_deg[:, k],
            read,
            recorded,
            law,
            slope,
        )
    excess = fitting_error(found, first, later, second, specimen, law)
    truth: dict[str, Any] = {
        "seed": seed,
        "tier": tier,
        "programme": programme,
        "noise": {key: value for key, value in vars(law).items() if value not in (np.inf,)},
        "readings": int(found.seen.sum()),
        "effects": [c["name"] for c in causes if c["kind"] == "effect"],
        "aliens": [c["name"] for c in causes if c["kind"] == "alien"],
        "aliases": [c["name"] for c in causes if c["kind"] == "alias"],
        "causes": causes,
        "calibration": {
            "compliance_deg_per_nm": slope,
            "free_play_deg": specimen.free_play_deg,
            "datum_deg": specimen.datum_deg,
        },
        "noise_rms_deg": float(np.sqrt(np.mean((read - clean) ** 2))),
        "held_out_fitting_rms_deg": excess,
        "held_out_noise_rms_deg": float(np.sqrt(np.mean((later_read - later_clean) ** 2))),
    }
    if rivals and visible:
        truth["rivals"] = rival_overlaps(specimen, first, law, found)
    return Case(
        recording=_frame(recorded, found.response.shown_torque_nm[found.seen], read),
        program=_frame(later_seen, later.shown_torque_nm[later.recorded], None),
        held_out_clean_deg=later_clean,
        held_out_read_deg=later_read,
        resolution_deg=law.resolution_deg,
        truth=truth,
    )
