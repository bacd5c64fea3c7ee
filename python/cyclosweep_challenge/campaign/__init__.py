"""The record across both generators: loud, faint and foreign recordings beside their targets."""
