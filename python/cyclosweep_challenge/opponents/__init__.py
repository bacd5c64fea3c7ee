"""What people use today to see whether a model leaves something out, on the same files."""
