"""Write the README's picture from an emitted and validated folder: FOLDER PICTURE.svg."""

import sys
from pathlib import Path

from springpot.host.validation.figures import prediction_figure, typical_series
from springpot.host.validation.store import read_validation

folder, picture = map(Path, sys.argv[1:])
picture.write_text(prediction_figure(typical_series(read_validation(folder).series)))
