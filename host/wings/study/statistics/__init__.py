"""Statistics of people's answers: numbers in, frozen results out."""
