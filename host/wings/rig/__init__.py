"""What a rig adds to samples, taken out on import: --align, --mass-kg, --tare and their like."""
