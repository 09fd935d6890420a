"""Settings: frozen dataclasses, YAML reading, and errors that say what to do."""
