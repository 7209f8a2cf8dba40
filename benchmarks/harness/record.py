"""The raw results of a run: one JSON file, complete after every measurement.

    { "head": machine, versions, options; "notes": what was left out; "measurements": [ one object each ] }

It is written beside itself and renamed, so that an interrupted run leaves all that was measured, and never half a file.
"""

import json
import os
from pathlib import Path


class Record:
    """A run that is being measured."""

    def __init__(self, folder, name, head):
        """`folder`/`name`.json, or with the first number that is free: earlier runs are not overwritten."""
        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        stems = (name if n == 1 else f"{name}-{n}" for n in range(1, 10_000))
        self.stem = next(folder / stem for stem in stems if not (folder / f"{stem}.json").exists())
        self.head, self.notes, self.measurements = head, [], []
        self.write()

    @property
    def path(self):
        """The file."""
        return self.stem.with_name(self.stem.name + ".json")

    def beside(self, ending):
        """A file of the same run with another ending, such as `.svg`."""
        return self.stem.with_name(self.stem.name + ending)

    def add(self, measurement):
        """Adds a measurement, on disk as well."""
        self.measurements.append(measurement)
        self.write()

    def note(self, text):
        """Says something, here and in the file."""
        print(f"note: {text}", flush=True)
        self.notes.append(text)
        self.write()

    def write(self):
        """Replaces the file by what is known now."""
        lines = [json.dumps(measurement) for measurement in self.measurements]
        text = '{\n"head": %s,\n"notes": %s,\n"measurements": [\n%s\n]\n}\n' % (
            json.dumps(self.head, indent=2),
            json.dumps(self.notes, indent=2),
            ",\n".join(lines),
        )
        temporary = self.path.with_name(self.path.name + ".part")
        temporary.write_text(text)
        os.replace(temporary, self.path)
