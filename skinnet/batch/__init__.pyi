from .columns import describe_columns as describe_columns
from .columns import flatten_summary as flatten_summary

__all__ = ["describe_columns", "flatten_summary"]
