"""The rig: a contact-level simulation of the torsion test, which knows nothing of the diagnosis."""
