"""`python -m cyclosweep_challenge.scoreboard`."""

from cyclosweep_challenge.scoreboard.command import main

main()
