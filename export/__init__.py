"""Export of trained models; onnx and onnxscript live here and nowhere else."""
