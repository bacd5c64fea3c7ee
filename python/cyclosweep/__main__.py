"""Run the command line: ``python -m cyclosweep``."""

from cyclosweep.cli import main

main()
