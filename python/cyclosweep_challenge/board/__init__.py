"""How a challenge's figures are shown."""
