"""What the torque reads without load."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class TorqueZero:
    """Torque that the sensor reads without load.

    Attributes
    ----------
    value_nm, std_error_nm : float
        Estimate and its standard error [N m].
    """

    value_nm: float
    std_error_nm: float

    @property
    def in_words(self) -> str:
        """Sentence on an error of the zero that was found and taken off."""
        return (
            f"the torque reads {self.value_nm:.3g} N m without load, with a standard error of "
            f"{self.std_error_nm:.2g} N m, as the curve of the torque shows: this was taken off, "
            "and a reading of the sensor without load should confirm it"
        )
