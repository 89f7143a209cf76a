"""Floor 3: recordings -> features -> fitted models. The only floor that loads scikit-learn."""
