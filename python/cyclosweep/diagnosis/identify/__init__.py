"""Which hypotheses a recording supports: joint fits, their evidence, the verdict.

`fitting` fits one structure, `structures` searches for those that suffice, `laws` asks whether the
law of a fitted effect holds, and `stages` takes large effects out one after the other. Each imports
from those before it.

Words that these files use in one meaning each:

baseline
    The published model with stiffness, free play and datum calibrated, without effects.
hypothesis
    A named effect or an unnamed shape of which something may be in the recording.
signature
    Twist of a hypothesis for one value of its shape parameters: a few columns of the library.
term
    An effect or unnamed shape as part of a structure.
structure
    The baseline with a set of terms, fitted jointly (`FittedStructure`).
candidate
    A fitted structure with its evidence over the baseline and the scan of its residual.
evidence
    Log of how much likelier the recording is with a hypothesis than without, averaged over the
    sizes that it may have beforehand [nat].
excess
    Evidence beyond what a hypothesis reaches by chance where nothing is missing [nat].
penalty, charge
    What is taken off the evidence: for a hypothesis that is less likely beforehand, and for what
    was chosen among many.
"""
