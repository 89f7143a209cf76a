"""CSV files: their text, layout, numbers and table."""
