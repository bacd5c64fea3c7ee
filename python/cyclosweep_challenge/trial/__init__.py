"""One concealed recording: what is hidden how, how visible it is, and the sealed answer."""
