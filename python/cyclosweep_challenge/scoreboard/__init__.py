"""The scoreboard: recordings of real devices and small made ones, each with its right answer."""
