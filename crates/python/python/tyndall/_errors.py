"""What goes wrong, as exceptions whose message is the one line that the command would print."""


class Error(ValueError):
    """Something given is wrong: the message names the file or key, and the mend."""


class FileError(Error, OSError):
    """A file cannot be read or written."""
