"""How tests are run: which have time, and which the machine held up."""
