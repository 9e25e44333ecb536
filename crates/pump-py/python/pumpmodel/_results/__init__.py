"""Results in other shapes: records of the command's JSON, and tables of pandas and xarray."""
