"""One recording of the challenge: concealed causes, their visibility, and the answer."""
