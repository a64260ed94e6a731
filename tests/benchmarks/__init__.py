"""Benchmarks: what the library costs, beside what the machine can do. Run by ``run.py``."""
