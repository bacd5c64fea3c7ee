"""What a diagnosis starts from: the drive of a recording, and the effects that are considered."""

from collections.abc import Collection
from pathlib import Path

from cyclosweep.design.drive import Drive
from cyclosweep.design.numbers import finite_number, whole_number
from cyclosweep.errors import DesignError, InputError, instance_of, one_of
from cyclosweep.recording import Recording
from cyclosweep.simulation.effects import Effect
from cyclosweep.simulation.effects import effects as all_effects


def check_measured(recording: Recording) -> None:
    """Raise `InputError` for a load programme without a measured angle, or for no recording."""
    instance_of("recording", recording, Recording)
    if recording.angle_deg is None:
        raise InputError(
            f"{recording.path or recording.name}: column angle_deg: missing or without numbers, "
            "expected in a recording"
        )


def check_options(tolerance_deg: float | None, seed: int, full: bool) -> None:
    """Refuse a tolerance or a seed that is none, and what does not say whether all is wanted.

    Parameters
    ----------
    tolerance_deg : float or None
        Size below which an effect does not matter [deg].
    seed : int
        Seed of the random draws.
    full : bool
        Whether held-out proof, self-check and next experiment are wanted.

    Raises
    ------
    InputError
        The tolerance is not above zero, the seed no whole number from zero, or `full` no bool.
    """
    instance_of("full", full, bool)
    whole_number("seed", seed)
    if tolerance_deg is not None and finite_number("tolerance_deg", tolerance_deg) <= 0:
        raise InputError(f"tolerance_deg: found {tolerance_deg:g}, expected degrees above zero")


def drive_for(recording: Recording, drive: Drive | None) -> Drive:
    """Return the drive that is given, or the one that the metadata name; it can be built.

    Parameters
    ----------
    recording : Recording
        The recording.
    drive : Drive or None
        What the caller gives.

    Returns
    -------
    Drive

    Raises
    ------
    InputError
        None is known, or what is given is something else.
    DesignError
        It cannot be built, though a stiffness of its own may give it a line.
    """
    drive = drive if drive is not None else drive_of(recording)
    instance_of("drive", drive, Drive)
    why = drive.explain()
    if why is not None:
        raise DesignError(f"{drive.name}: {why}")
    return drive


def drive_of(recording: Recording) -> Drive:
    """Load the drive that the metadata of a recording name.

    Parameters
    ----------
    recording : Recording
        Its ``drive`` is a built-in name, or a drive file beside it.

    Returns
    -------
    Drive

    Raises
    ------
    InputError
        No drive is named, or it cannot be loaded.
    """
    if recording.drive is None:
        where = recording.path or recording.name
        raise InputError(
            f"{where}: drive: missing, expected as --drive (drive=) or in {recording.name}.toml"
        )
    beside = None if recording.path is None else Path(recording.path).parent
    return Drive.load(recording.drive, beside)


def considered_effects(without: Collection[str]) -> tuple[Effect, ...]:
    """Return all known effects but those that are left out.

    Parameters
    ----------
    without : collection of str
        Names to leave out.

    Returns
    -------
    tuple of Effect

    Raises
    ------
    InputError
        A name is of no effect.
    """
    if isinstance(without, (str, bytes)) or not isinstance(without, Collection):
        raise InputError(f"without: found {without!r}, expected a list of names of effects")
    known = all_effects()
    names = {effect.name for effect in known}
    for name in without:
        one_of("without", name, sorted(names))
    return tuple(effect for effect in known if effect.name not in without)
