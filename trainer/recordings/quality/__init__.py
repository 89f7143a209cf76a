"""What is wrong with a recording, and what that means for a model."""
