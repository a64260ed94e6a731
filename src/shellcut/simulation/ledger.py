"""The energy balance: where the work has gone.

    tool + loads + supports  =  kinetic + strain + material + cohesive + joints + adhesion
                                + contact + friction + self contact + damping

Each entry is computed from its own forces and increments, none by difference: works are sums of
½ (f_{n-1} + f_n) · Δx, the tool's with its wrench and the twist of its motion; kinetic, strain and
the stored and dissipated parts of the cohesive law are functions of the state. What the two sides
differ by, relative to the energy put in, is the imbalance: the first figure of trust.
"""

from __future__ import annotations

from dataclasses import dataclass

from shellcut.results.energy_account import PUT_IN, TAKEN_UP, put_through, total


@dataclass
class Ledger:
    """Energies and works at t_n, all in N·mm (= mJ)."""

    tool_work: float = 0.0
    """Work of the tool on the film."""
    load_work: float = 0.0
    """Work of gravity, pressure and nodal forces, and of force terms that book nothing."""
    support_work: float = 0.0
    """Work of the reactions where motion is prescribed."""
    initial: float = 0.0
    """Kinetic and strain energy at t = 0: of an initial velocity, of a pretension."""
    kinetic_translation: float = 0.0
    kinetic_rotation: float = 0.0
    """Of the scaled rotary inertia."""
    strain: float = 0.0
    """Stored in the film, by its law."""
    material_dissipated: float = 0.0
    """Dissipated in the film, by its law: by yielding, by damage."""
    cohesive_work: float = 0.0
    """Work done on all cables."""
    cohesive_start_work: float = 0.0
    """Work done on the equilibrium-start forces."""
    cohesive_stored: float = 0.0
    """Recoverable energy of the cables, by the law."""
    cohesive_dissipated: float = 0.0
    """Dissipated by the cables, by the law; stored and dissipated make up the work."""
    joint_friction: float = 0.0
    """Work against friction between the cables and the cutting edge."""
    adhesion_work: float = 0.0
    """Work that went into the glue between film and base."""
    adhesion_stored: float = 0.0
    """What glue and base would give back of it."""
    adhesion_dissipated: float = 0.0
    """Dissipated by the glue as it lets go; stored and dissipated make up the work."""
    contact_work: float = 0.0
    """Work that went into the contact from both sides, nodes and tool."""
    contact_stored: float = 0.0
    """Penalty energy, the recoverable part of it."""
    self_contact_work: float = 0.0
    """Work that went into the contact of the film with itself."""
    self_contact_stored: float = 0.0
    """Penalty energy, the recoverable part of it."""
    friction_work: float = 0.0
    """Work that went into the friction from both sides, nodes and tool."""
    friction_stored: float = 0.0
    """Energy of its springs, the recoverable part of it."""
    friction_dissipated: float = 0.0
    """What slip has dissipated of it; stored and dissipated make up the work."""
    damping_stiffness: float = 0.0
    damping_mass: float = 0.0
    damping_kinetic: float = 0.0
    """Kinetic energy of the film where a quasi-static run has stopped it."""

    @property
    def kinetic(self) -> float:
        """Kinetic energy of translation and rotation."""
        return self.kinetic_translation + self.kinetic_rotation

    @property
    def damping(self) -> float:
        """Dissipated by all dampings."""
        return self.damping_stiffness + self.damping_mass + self.damping_kinetic

    @property
    def put_in(self) -> float:
        """Work of tool, loads and supports, and the energy at t = 0."""
        return float(total(PUT_IN, vars(self)))

    @property
    def taken_up(self) -> float:
        """Sum of all that the work has become."""
        return float(total(TAKEN_UP, vars(self)))

    def entries(self) -> dict[str, float]:
        """Return works and energies that make up the balance, by the words for them."""
        return {part.words: part.of(vars(self)) for part in (*PUT_IN, *TAKEN_UP)}

    @property
    def imbalance(self) -> float:
        """Work put in minus energy taken up."""
        return self.put_in - self.taken_up

    @property
    def put_through(self) -> float:
        """Magnitudes of what has been put into the film so far, or taken out, together."""
        return float(put_through(vars(self)))

    def relative(self, energy: float) -> float:
        """Return an energy relative to :attr:`put_through`."""
        scale = self.put_through
        return energy / scale if scale > 0 else 0.0
