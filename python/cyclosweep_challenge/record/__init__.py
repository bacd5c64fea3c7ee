"""The run of record: every part in slices, published before it is diagnosed; and its page."""
