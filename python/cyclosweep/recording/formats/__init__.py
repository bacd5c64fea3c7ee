"""Files of other programs, each as a table of named columns."""
