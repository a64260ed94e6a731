"""A model in other units: every length, time and stress times a factor of its own."""

import dataclasses
from typing import NamedTuple

from shellcut import Elastic, Layer, Mesh, ShellMaterial


class Factors(NamedTuple):
    """By which lengths, times and stresses grow; everything else follows."""

    length: float = 1.0
    time: float = 1.0
    stress: float = 1.0

    @property
    def density(self):
        return self.stress * (self.time / self.length) ** 2

    @property
    def force(self):
        return self.stress * self.length**2

    @property
    def energy(self):
        return self.stress * self.length**3

    def mesh(self, mesh):
        return Mesh.from_arrays(
            mesh.nodes * self.length,
            mesh.quads,
            directors=mesh.directors,
            node_sets=mesh.node_sets,
            quad_sets=mesh.quad_sets,
        )

    def material(self, material):
        layers = [
            Layer(
                Elastic(
                    young=layer.material.young * self.stress,
                    poisson=layer.material.poisson,
                    density=layer.material.density * self.density,
                ),
                layer.thickness * self.length,
            )
            for layer in material.layers
        ]
        return ShellMaterial(layers, shear_factor=material.shear_factor)

    def law(self, law):
        return dataclasses.replace(
            law,
            strength=law.strength * self.stress,
            plateau=law.plateau * self.stress,
            opening_a=law.opening_a * self.length,
            opening_p=law.opening_p * self.length,
            opening_u=law.opening_u * self.length,
            onset=law.onset * self.length,
        )

    def tool(self, tool):
        return dataclasses.replace(tool, vertices=tool.vertices * self.length)
