"""Write the lists of the reference into the pages."""

from reference_pages.in_clone import write_pages

write_pages()
