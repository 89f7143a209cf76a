"""Emitted folders: scene files, writing aside and renaming, budgets."""
