"""Install the wheel of a folder where no compiler can be found, and use it."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import venv
from pathlib import Path

TAG = "cp311-abi3"
"""One wheel for Python 3.11 and every later one."""

STUDY = """
[axes]
eccentricity_mm = { from = 0.3, to = 0.8, steps = 100 }
output_pin_count = { values = [6, 8, 9] }
"""

USE = """
import pathlib, sys, cyclosweep as cs
assert pathlib.Path(cs.__file__).is_relative_to(sys.prefix), cs.__file__
assert (pathlib.Path(cs.__file__).parent / "py.typed").exists()
assert round(cs.Drive.reference_87().evaluate()["twist_1tn_deg"], 1) == 47.8
assert cs.scan_dataset("out").collect().height == 300
"""


def without_compilers(own: Path) -> dict[str, str]:
    """Environment whose path holds the programs of one folder, and none that Rust comes with."""
    kept = [
        folder
        for folder in os.environ["PATH"].split(os.pathsep)
        if not any((Path(folder) / f"{name}{end}").exists() for name in ("cargo", "rustc")
                   for end in ("", ".exe"))
    ]  # fmt: skip
    hidden = ("PYTHONPATH", "CARGO_HOME", "RUSTUP_HOME", "VIRTUAL_ENV")
    rest = {key: value for key, value in os.environ.items() if key not in hidden}
    return {**rest, "PATH": os.pathsep.join([str(own), *kept])}


def main() -> None:
    """Install the only wheel of the folder given for this Python, sweep and validate with it."""
    [wheel] = Path(sys.argv[1]).glob("*.whl")
    assert TAG in wheel.name, f"{wheel.name}: expected {TAG}"
    print(f"{wheel.name}: {wheel.stat().st_size / 1e6:.2f} MB")
    with tempfile.TemporaryDirectory() as folder:
        home = Path(folder) / "venv"
        venv.create(home, with_pip=True)
        own = home / ("Scripts" if os.name == "nt" else "bin")
        python, environment = str(own / "python"), without_compilers(own)
        (Path(folder) / "study.toml").write_text(STUDY)
        for command in (
            ["pip", "install", "--quiet", "--only-binary", ":all:", str(wheel.resolve())],
            ["cyclosweep", "validate"],
            ["cyclosweep", "sweep", "study.toml", "--out", "out"],
        ):
            subprocess.run([python, "-m", *command], cwd=folder, env=environment, check=True)
        subprocess.run([python, "-c", USE], cwd=folder, env=environment, check=True)
    print(f"{wheel.name}: installed and used without a compiler")


if __name__ == "__main__":
    main()
