"""`python -m cyclosweep_challenge.record`."""

from cyclosweep_challenge.record.command import main

main()
