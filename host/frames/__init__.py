"""Tables of pandas, polars and others as recordings: `Recording.from_frame`."""
