"""CSV files, and the sheets of workbooks: their text, layout, numbers and table."""
