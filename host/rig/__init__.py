"""What a rig adds to samples: found (hum, drift), and taken out on import (--tare, --align)."""
