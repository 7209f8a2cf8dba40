"""Types of the compiled part."""

__version__: str
