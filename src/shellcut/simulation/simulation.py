"""Simulation: owns the order of a step and of a run. Read :meth:`Simulation.step` first."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Annotated, Any, NoReturn

import numpy as np
import numpy.typing as npt

from shellcut.arguments import Option, checked
from shellcut.arrays import Floats, node_rows
from shellcut.cables.cohesive_law import CohesiveLaw, CohesiveTable
from shellcut.cables.directional_cable import CableSet
from shellcut.card import FILM, TOOL, Figures, card, drawing
from shellcut.central_difference import CentralDifference
from shellcut.contact.settings import Contact
from shellcut.contact.sheet_contact import PointContact, SelfContact
from shellcut.contact.start_check import check_tool_outside
from shellcut.fracture.cracks import Cracks
from shellcut.fracture.flank_points import FlankPoints
from shellcut.fracture.notch import cut_notch
from shellcut.fracture.options import Fracture
from shellcut.loads.adhesion import Adhesion
from shellcut.loads.film_motion import FilmMotion, in_film
from shellcut.loads.loads import Load, LoadSet
from shellcut.loads.supports import Support, SupportSet
from shellcut.loads.symmetry_plane import put_directors_into_planes
from shellcut.material.shell_material import ShellMaterial
from shellcut.mesh.mesh import Mesh
from shellcut.mitc4.initial_state import director_spins, initial_state
from shellcut.mitc4.shell import DAMPING_SHARE, MITC4Shell
from shellcut.numerics.threads import Threads, Workers
from shellcut.results.verdict import verdict
from shellcut.state import State
from shellcut.tool.force_term import ForceTerm
from shellcut.tool.motion import Motion
from shellcut.tool.pose import Pose
from shellcut.tool.pose_of_motion import pose_at
from shellcut.tool.tool import Tool

from .contact_terms import contact_terms, polygons_of, self_contact_terms
from .force_terms import ForceTerms
from .hooks import Hook, serve
from .imperfection import Imperfection, ImperfectionNumber
from .input_checks import check_damping, check_parts, check_quasi_static, points_of_notch
from .instability import StabilityGuard
from .ledger import Ledger
from .pace import KineticShare, Pace
from .relaxation import find_rest
from .stable_step import StableStep, Stepping

_OF_MASS = "mass-proportional Rayleigh damping"
_OF_STIFFNESS = "stiffness-proportional Rayleigh damping"
_OF_CRITICAL = "stiffness-proportional damping, share of critical at the film's highest frequency"


class Simulation:
    """A film, its supports and loads, and the tool that cuts it.

    Parameters
    ----------
    mesh : Mesh
        Reference mid-surface.
    material : ShellMaterial
        Layers through the thickness.
    supports : sequence of Support
        Supported and moved nodes.
    loads : sequence of Load
        Gravity, pressures, forces.
    tool, motion : Tool and Motion, optional
        The rigid tool and how it moves; both or none.
    law : CohesiveTable, optional
        Without one nothing splits.
    contact, fracture, stepping : Contact, Fracture, Stepping
        Parameters of contact, of the cracks and of the time step.
    directional, damping_alpha, damping_beta, damping_share, quasi_static, imperfection, threads
        See their annotations; damping by [Frangi2010] 5.2, :mod:`.pace`, :mod:`.imperfection`.
    velocity : array_like, shape (n_node, 3), optional
        Initial velocity [mm/s]; the directors turn with the film.
    terms : sequence of ForceTerm or Adhesion
        Glue, and forces of your own, evaluated after all others.

    Raises
    ------
    ValueError
        If anything given is impossible: every check is made here, before the first step.

    Examples
    --------
    >>> import shellcut as sc
    >>> from shellcut.mesh.structured import rectangle
    >>> mesh = rectangle(4.0, 2.0, size=1.0)
    >>> film = sc.ShellMaterial.homogeneous(
    ...     young=1678.0, poisson=0.3, density=1e-9, thickness=0.074
    ... )
    >>> sim = sc.Simulation(mesh, film, loads=[sc.Gravity((0.0, 0.0, -9810.0))], damping_alpha=0.0)
    >>> sim.run(until=1e-5)
    >>> bool((sim.state.node.x[: mesh.n_node, 2] < 0.0).all())  # it falls
    True
    """

    @checked
    def __init__(
        self,
        mesh: Mesh,
        material: ShellMaterial,
        *,
        supports: Sequence[Support] = (),
        loads: Sequence[Load] = (),
        tool: Tool | None = None,
        motion: Motion | None = None,
        law: CohesiveTable | None = None,
        contact: Contact | None = None,
        fracture: Fracture | None = None,
        stepping: Stepping | None = None,
        directional: Annotated[
            bool,
            Option("", "whether cables meet the blade; false: classical cohesive elements"),
        ] = True,
        damping_alpha: Annotated[float, Option("1/s", _OF_MASS, least=0)] = 0.1,
        damping_beta: Annotated[
            float | None, Option("s", _OF_STIFFNESS, least=0, unset="that of the share")
        ] = None,
        damping_share: Annotated[
            float | None, Option("", _OF_CRITICAL, least=0, unset=f"{DAMPING_SHARE:g}")
        ] = None,
        velocity: Floats | None = None,
        terms: Sequence[ForceTerm | Adhesion] = (),
        quasi_static: KineticShare = None,
        imperfection: ImperfectionNumber = None,
        threads: Threads = None,
    ) -> None:
        check_parts(tool, motion, law, contact, fracture)
        check_damping(damping_beta, damping_share)
        if quasi_static is not None:
            check_quasi_static(material, velocity)
        if imperfection is None:
            imperfection = int(tool is not None and law is not None)
        contact, fracture = contact or Contact(), (fracture or Fracture()).decided()
        self.mesh = put_directors_into_planes(mesh, supports)
        workers = Workers(mesh.n_quad, threads)
        share = DAMPING_SHARE if damping_share is None else damping_share
        self.shell = MITC4Shell(
            self.mesh, material, damping_beta=damping_beta, damping_share=share, workers=workers
        )
        self.inputs = {
            "mesh": mesh,
            "material": material,
            "supports": tuple(supports),
            "loads": tuple(loads),
            "tool": tool,
            "motion": motion,
            "law": law,
            "contact": contact,
            "fracture": fracture,
            "directional": directional,
            "damping_alpha": damping_alpha,
            "damping_beta": self.shell.damping_beta,
            "velocity": None if velocity is None else np.asarray(velocity, float),
            "terms": tuple(terms),
            "quasi_static": quasi_static,
            "imperfection": imperfection,
        }
        """What it was built from, by the names of the arguments: all that makes the run what it is
        and does not change in time. Not the threads, nor the stepping, which only paces it."""
        self.material, self.tool, self.motion = material, tool, motion
        self.law, self.fracture = law, fracture
        self.supports = SupportSet(self.mesh, supports)
        self.loads = LoadSet(self.mesh, loads, workers)
        self.integrator = CentralDifference(damping_alpha=damping_alpha, workers=workers)
        self.state = self._state_at_start(velocity)
        self.film_motion: FilmMotion | None = None
        """Of a film with a tool that its supports move."""
        if tool is not None:
            self.film_motion = FilmMotion.of(self.supports, self.state)
        self._add_terms(contact, directional, terms)
        self._let_crack()
        self.time_step = StableStep(stepping, self.shell, [*self.terms])
        self._guard = StabilityGuard(self.mesh, self.shell, law, self.time_step)
        self.pace = Pace(quasi_static)
        self._begin(imperfection)

    def _add_terms(
        self, contact: Contact, directional: bool, others: Sequence[ForceTerm | Adhesion]
    ) -> None:
        """Build all that pulls and presses on the film, in the order of evaluation."""
        tool, film, part_of = self.tool, (self.mesh, self.material), polygons_of(self)
        self.cables = CableSet(self.law or CohesiveLaw(), tool, directional=directional)
        # Contact is first: it uses the forces of the shells, without those of the cables.
        self.contact, touching = contact_terms(tool, contact, *film, self.fracture, part_of)
        own = self_contact_terms(contact, *film, part_of)
        self._given = [term.for_film(*film, part_of) for term in others]
        self.self_contact = next((term for term in own if isinstance(term, SelfContact)), None)
        """Of the film with itself, if it is switched on."""
        self.terms = ForceTerms(
            [*touching, self.cables, *own, *self._given], self.motion, self.film_motion
        )
        """All that puts forces on the nodes but shells and loads."""
        self.pose = Pose.at_origin()
        """Of the tool at t_n."""

    def _let_crack(self) -> None:
        """Build the cracks, and the points on their flanks."""
        self._flanks = FlankPoints()
        self.cracks: Cracks | None = None
        if self.law is not None:
            self.cracks = Cracks(
                self.state,
                self.fracture,
                self.law,
                self.shell,
                self.loads,
                self.tool,
                self.motion,
                next((term for term in self.terms if isinstance(term, PointContact)), None),
                self.film_motion,
                self._given,
            )

    def _begin(self, imperfection: int) -> None:
        """Place the tool, which must not overlap the film, and take the first half kick."""
        self.ledger = Ledger()
        self._mass_damping, self._dt, self._between_steps = 0.0, 0.0, True
        self._place_tool()
        if (touching := self.contact) is not None:
            check_tool_outside(self.mesh, touching.tool, touching.grid, self.pose, self.motion)
        shape = Imperfection(imperfection, self.mesh, self.material, self.tool, self.pose)
        shape.displace(self.state)
        self.imperfection = shape
        """With which the film begins."""
        for term in self._given:
            term.begin(self.state)
        self._start()

    def _state_at_start(self, velocity: Floats | None) -> State:
        """Return the film at rest in its supports, or with the given velocity [mm/s]."""
        mesh, state = self.mesh, initial_state(self.mesh)
        self.shell.initialise(state)
        self.supports.initialise(state)
        if velocity is not None:
            given = node_rows("velocity", velocity, mesh.n_node)
            state.node.velocity_half[: mesh.n_node] = given
            state.node.spin_half[: mesh.n_node] = director_spins(mesh, given)
        return state

    def _repr_html_(self) -> str:
        s, ledger, tool = self.state, self.ledger, self.tool
        figures: Figures = [
            ("time", 1e3 * s.time, "ms"),
            ("steps", s.step, ""),
            ("quads", len(s.quad.nodes), ""),
            ("crack", s.crack_length, "mm"),
            ("work of the tool", ledger.tool_work, "N*mm"),
        ]
        share = {} if self.imbalance is None else {"imbalance_rel": self.imbalance}
        said = [(line.kind, str(line)) for line in verdict(share)[:1]]
        film = (s.node.x, s.quad.nodes, FILM)
        if tool is None:
            return card("Simulation", figures, said, drawing([film]))
        places = self.pose.to_space(tool.vertices)
        picture = drawing([film, (places, tool.triangles, TOOL)], places[tool.edges])
        return card("Simulation", figures, said, picture)

    @property
    def dt(self) -> float:
        """Length of the next step [s]."""
        return self._dt

    @property
    def between_steps(self) -> bool:
        """Whether the last step is complete; what is raised within one leaves it half done."""
        return self._between_steps

    @property
    def imbalance(self) -> float | None:
        """What the energy balance misses over the energy put in [-].

        None while that is too little to compare with, and after a step that is not complete.
        """
        return self._guard.imbalance(self.ledger) if self._between_steps else None

    # ---------------------------------------------------------------- the order of a step

    def step(self) -> None:
        """Take the state from t_n to t_{n+1}.

        Raises
        ------
        UnstableStep
            If the solution blows up, or (BalanceLost) the energy balance is lost.
        """
        s = self.state
        self._between_steps = False
        self.integrator.drift(s, self._dt)  # 1 positions, directors
        if s.flank.count:
            self._flanks.follow(s)
        s.step += 1  # 2 clock
        s.dt, s.pace = self._dt, self.pace.now
        s.time += s.tick
        self._place_tool()
        if self.cracks is not None:
            self.cracks.cut_due(s, self.pose, self.work_in_film)  # 3 topology
        self._forces()  # 4 forces at t_{n+1}
        dt_next = self.time_step.next(s)
        self._kick(s.dt, dt_next)  # 5 velocities at t_{n+3/2}
        self._guard.check_balance(s, self.ledger)
        self._dt = dt_next
        self._between_steps = True

    def _forces(self) -> None:
        s, book = self.state, self.ledger
        book.load_work += self.loads.begin_forces(s)
        book.strain, damping, dissipated = self.shell.add_forces(s)
        book.damping_stiffness += damping
        book.material_dissipated += dissipated
        self.terms.add_forces(s, self.pose, book)
        if s.flank.count:
            self._flanks.hand_on_forces(s)
        self._guard.check_strain(s, book)

    def _kick(self, dt_last: float, dt_next: float) -> None:
        s, book, pace = self.state, self.ledger, self.pace
        if is_slowed := pace.share is not None:
            pace.adapt(book.kinetic, self._guard.scale)
        self.supports.prescribe(s, dt_next, pace.now)
        kick = self.integrator.kick(s, dt_last, dt_next)
        book.support_work += kick.support_work
        if is_slowed and pace.stops(kick.kinetic, book.kinetic, self._guard.scale):
            moved, kick = kick.kinetic, self.integrator.restart(s, dt_next)
            book.damping_kinetic += moved - kick.kinetic
        book.kinetic_translation = kick.kinetic_translation
        book.kinetic_rotation = kick.kinetic_rotation
        # The mass damping of a kick belongs half to the step before and half to the step after.
        book.damping_mass += 0.5 * (self._mass_damping + kick.mass_damping)
        self._mass_damping = kick.mass_damping

    def _start(self) -> None:
        """Take the first, half kick from t_0."""
        self._forces()
        with np.errstate(all="ignore"):  # of nonsense numbers, which the next line refuses
            self._dt = self.time_step.next(self.state)
        self.time_step.check(self._dt)
        if self.film_motion is not None:
            self.film_motion.begin(self.state, self._dt)
        self._kick(0.0, self._dt)
        self.ledger.initial = self.ledger.kinetic + self.ledger.strain

    # ---------------------------------------------------------------- a run

    def relax(
        self,
        displacement: Floats | None = None,
        *,
        tolerance: float = 1e-5,
        most_steps: int = 200_000,
    ) -> int:
        """Bring the film to rest before the run: a pretension, a state under dead loads.

        Parameters
        ----------
        displacement : ndarray, shape (n_node, 3), optional
            Moves all nodes first, also those that a notch has added [mm]; supports then keep them
            where they are, so a stretched film is given by the displacement of its border (and any
            guess inside). Glue is begun there: it holds the film where this puts it.
        tolerance : float
            Largest free nodal force over the largest reaction or load.
        most_steps : int
            Steps after which to give up.

        Returns
        -------
        int
            Steps taken; time and energy balance start afresh, with the strain energy as initial
            energy. A material with history remembers the strains it has met on that path.

        Raises
        ------
        NotAtRest
            If rest is not reached; the film rests where it is then, or, where it flew
            apart, as it was.
        """
        if self.state.step:
            raise ValueError(f"relax before the run, not after {self.state.step} steps of it")
        try:
            return find_rest(
                self.state,
                self.shell,
                self.loads,
                self._given,
                self.time_step,
                displacement,
                tolerance=tolerance,
                most_steps=most_steps,
                most_strain=self._guard.most_strain,
            )
        finally:  # also where rest was not reached: a run may begin from there
            self.ledger = Ledger()
            self.time_step.forget()
            self._start()

    def notch(self, *points: npt.ArrayLike) -> None:
        """Cut the film before the run along a line through points, without cables.

        For ``path="free"``; for cracks along edges :meth:`Mesh.cut` cuts the mesh. A line of two
        points runs in their plane with the film's normal at the border, others follow their points.

        Parameters
        ----------
        *points : array_like, shape (3,)
            From outside the film, or from within, to where the notch ends [mm]. A first point that
            is outside must be nearer to a side of the border than that side is long: there the
            notch begins. It ends at the first side or node at or beyond the last point, or at a
            border or cut before that.

        Raises
        ------
        ValueError
            If cracks run along edges, it is too late, or the line begins outside the film.
        """
        if self.cracks is None or self.fracture.path != "free":
            raise ValueError(
                'cracks must run through quads, fracture.path = "free"; else cut the mesh, Mesh.cut'
            )
        if self.state.step or self.state.is_moved(self.imperfection.amplitude):
            raise ValueError("notch the film before the run, and before it is stretched")
        cut_notch(self.cracks.growth, self.state, points_of_notch(points))

    @checked
    def run(self, until: float, hooks: Sequence[Hook] = ()) -> None:
        """Step until the time ``until`` [s] is reached or a hook raises StopRun.

        The last step is not shortened, so that run(a); run(b) is run(b), bit for bit.
        """
        if not until >= self.state.time - self.state.dt:
            raise ValueError(f"until must not lie before now, {self.state.time} s, got {until!r}")
        try:
            going = serve(self, hooks)
            while going and self.state.time < until:
                self.step()
                going = serve(self, hooks)
        finally:
            for hook in hooks:
                hook.close()

    @property
    def tooth_wrenches(self) -> Floats:
        """Wrench on each tooth of the tool, contact and joints together, shape (n_tooth, 6).

        Force [N] and moment [N·mm] about the origin of the body frame.
        """
        return self.terms.wrench

    @property
    def motion_in_film(self) -> Motion | None:
        """The motion of the tool as seen from the film.

        It is ``motion`` itself where no support moves the film; None without a tool.
        """
        return None if self.motion is None else in_film(self.film_motion, self.motion)

    @property
    def work_in_film(self) -> float:
        """Work of the tool up to t_n, as seen from the film [N·mm]."""
        return self.ledger.tool_work if self.film_motion is None else self.terms.work_in_film

    @property
    def kinetic_in_film(self) -> float:
        """Kinetic energy at t_n, as seen from the film [N·mm]."""
        film, kinetic = self.film_motion, self.ledger.kinetic
        return kinetic if film is None else film.kinetic(self.state, kinetic)

    def close_ledger(self) -> Ledger:
        """Return the energy balance, its entries that are functions of the state at t_n."""
        vars(self.ledger).update(self.terms.stored(self.state))
        return self.ledger

    # ---------------------------------------------------------------- restart

    def saved(self) -> dict[str, Any]:
        """Return all that has changed since it was built: arrays and numbers, nested by name.

        The arrays are those of the simulation, not copies. What follows from the state or from
        ``inputs`` is left out. :mod:`shellcut.recording.checkpoint` puts it into a file.
        """
        saved = {
            "state": self.state.saved(),
            "ledger": asdict(self.ledger),
            "shell": self.shell.saved(),
            "frequencies": self.shell.frequencies.saved(),
            "time_step": self.time_step.saved(),
            "pose": self.pose._asdict(),
            "terms": self.terms.saved(),
            "mass_damping": self._mass_damping,
            "dt": self._dt,
            "balance": self._guard.balance.saved(),
            "pace": self.pace.saved(),
        }
        if self.cracks is not None:
            saved["cracks"] = self.cracks.saved()
        if self.film_motion is not None:
            saved["film_motion"] = self.film_motion.saved()
        return saved

    def __reduce_ex__(self, protocol: object) -> NoReturn:
        raise TypeError(
            "a Simulation cannot be copied or pickled, its parts share their arrays: build another "
            "from the same inputs; save_checkpoint and load_checkpoint put it into the same state"
        )

    def restore(self, saved: dict[str, Any]) -> None:
        """Take over :meth:`saved` of another simulation of the same inputs, in place of t_0."""
        s = self.state
        s.restore(saved["state"])
        self.ledger = Ledger(**saved["ledger"])
        self.shell.restore(s, saved["shell"])
        self.shell.frequencies.restore(saved["frequencies"])
        self.time_step.restore(saved["time_step"])
        self._mass_damping, self._dt = saved["mass_damping"], saved["dt"]
        self._guard.balance.restore(saved["balance"])
        self.pace.restore(saved["pace"])
        self.pose = Pose(**saved["pose"]).copied()
        if self.film_motion is not None:
            self.film_motion.restore(saved["film_motion"])
        if self.cracks is not None:
            self.cracks.restore(s, saved["cracks"])
        self.terms.restore(
            s, self.pose, saved["terms"]
        )  # they need the film that the cracks have left

    def _place_tool(self) -> None:
        if self.motion is not None:
            self.pose = pose_at(self.motion, self.state.time)
