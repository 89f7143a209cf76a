"""Places: the protocol of an object that is pressed at several of them."""
