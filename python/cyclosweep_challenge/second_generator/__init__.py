"""A second generator of recordings, whose laws come from the literature and not from the library.

`python -m cyclosweep_challenge.second_generator --tier C8 --cases 8 --seed 1 --out DIR` writes
recordings with their answers apart. Nothing here knows the effects of ``cyclosweep.simulation``,
the diagnosis or the first generator (``rig``); tests hold that.
"""
