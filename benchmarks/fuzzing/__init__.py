"""Damaged and hostile inputs of every kind that skinnet reads, made from seeds.

A class of inputs is a module with a function `make`, which makes a `Case` from a `random.Random`.
`Runner` runs cases in a process of their own, and measures each.
"""

CLASSES = {
    "pictures": "benchmarks.fuzzing.pictures",
    "onnx": "benchmarks.fuzzing.onnx_models",
    "safetensors": "benchmarks.fuzzing.weights",
    "checkpoints": "benchmarks.fuzzing.checkpoints",
    "npz": "benchmarks.fuzzing.archives",
    "shape_models": "benchmarks.fuzzing.shape_models",
    "meshes": "benchmarks.fuzzing.meshes",
    "landmarks": "benchmarks.fuzzing.landmarks",
    "tables": "benchmarks.fuzzing.tables",
    "settings": "benchmarks.fuzzing.settings",
    "command_lines": "benchmarks.fuzzing.command_lines",
}
"""Modules that make the cases of each class."""
