"""Entry of ``python -m cyclosweep_challenge.component_rig``."""

from cyclosweep_challenge.component_rig.command import main

if __name__ == "__main__":
    main()
