"""What the commands `benchmarks/bench`, `growth` and `roof` share, one idea a file."""
