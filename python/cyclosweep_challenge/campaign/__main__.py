"""`python -m cyclosweep_challenge.campaign`."""

from cyclosweep_challenge.campaign.command import main

main()
