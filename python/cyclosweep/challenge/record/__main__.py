"""`python -m cyclosweep.challenge.record`."""

from cyclosweep.challenge.record.command import main

main()
