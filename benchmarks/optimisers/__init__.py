"""Our strategies against other packages' on known problems and on the valve: `python -m benchmarks.optimisers`."""
