"""A fitted model as plain arrays: what the trainer hands on, its file, its stiffness scaled."""
