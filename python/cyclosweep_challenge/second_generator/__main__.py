"""Entry of ``python -m cyclosweep_challenge.second_generator``."""

from cyclosweep_challenge.second_generator.command import main

if __name__ == "__main__":
    main()
