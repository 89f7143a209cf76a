"""What a study found: results, tables, figures, one page."""
