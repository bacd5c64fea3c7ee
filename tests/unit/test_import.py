"""What importing the package loads, and what it loads later."""

import subprocess
import sys

import pytest

import cyclosweep as cs

LOADED = """
import sys
import cyclosweep as cs
assert cs.Space.grid(cs.Drive.reference_87(), output_pin_count=[6, 8])
print(*(name for name in sys.modules if name.split(".")[0] in ("scipy", "matplotlib", "rich")))
"""


def test_a_worker_of_a_sweep_loads_no_scipy() -> None:
    done = subprocess.run(
        [sys.executable, "-c", LOADED], capture_output=True, text=True, check=True
    )
    assert done.stdout.split() == []


@pytest.mark.parametrize("name", cs.__all__)
def test_every_public_name_is_there_and_listed(name: str) -> None:
    assert getattr(cs, name) is not None
    assert name in dir(cs)


def test_another_name_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match=r"cyclosweep.*nothing_of_this_name"):
        getattr(cs, "nothing_of_this_name")  # noqa: B009
