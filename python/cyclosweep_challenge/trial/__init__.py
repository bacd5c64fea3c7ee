"""One concealed recording: what is hidden how, how visible it is, and its answer."""
