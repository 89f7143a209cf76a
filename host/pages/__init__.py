"""Pages of HTML, and the look of their figures."""
