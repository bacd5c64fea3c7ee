"""Laws of the literature for every effect of the vocabulary, and causes outside it."""
