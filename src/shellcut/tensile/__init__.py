"""From tensile tests to a model: figures of specimens, their scatter, hardening, a cohesive law.

May import ``results`` (measured tables), ``view``, ``cables`` and rows below. ``specimen`` reads,
``figures`` evaluates one specimen, ``direction`` averages and proposes the law, ``evaluation``
joins them and writes.
"""

from .evaluation import TensileTest, evaluate_tensile

__all__ = ["TensileTest", "evaluate_tensile"]
