"""Pages of HTML, a local server of one, and the look of figures."""
