"""What engineers call things, and what these are here: for messages, ``symflex elements`` and a page.

Input: a word, as somebody writes it where a type is expected.
Output: the :class:`Thing` it names, with the element, block or command for it and a line of how.

    "belt"   ->   transformer, ratio = "r_1/r_2"
"""

from __future__ import annotations

import re
from collections.abc import Container, Iterable
from dataclasses import dataclass

from symflex.errors import nearest

MISSPELT = 0.85  # likeness of a word with a slip in it


@dataclass(frozen=True, slots=True)
class Thing:
    """Something a model may have, by all its names."""

    words: tuple[str, ...]  # the first one is how the page calls it
    use: str  # element or block, or several; empty where there is none
    how: str = ""  # what to write, where that is not plain

    def hint(self, word: str) -> str:
        """Return what to say to somebody who wrote one of the words as a type."""
        if not self.use:
            return f"there is no {word}: {self.how}"
        return f"for {word} write {self.use.replace(', ', ' or ')}" + (f": {self.how}" if self.how else "")


# Words, the element or block, and what to write; indented lines continue one.
_TABLE = """
# What moves
mass body block cart payload load weight | mass
wheel disc disk flywheel rotor pulley_inertia | inertia
bar link rigid_bar rigid_beam rigid_arm | rigid_link | with rigid_body for its mass
pendulum inverted_pendulum pole | rigid_body | at a pin; gravity is a torsion_spring of m*g*l, negative
  if it is inverted
damper dashpot shock_absorber friction viscous_friction | damper, rotary_damper
tyre tire mount isolator bearing contact | spring | with a damper beside it
torsion_damper torsional_damper rotational_damper angular_damper | rotary_damper
coupling joint_stiffness harmonic_drive flexspline | torsion_spring
torsional_spring rotational_spring rotary_spring angular_spring | torsion_spring
inerter | transformer | to an inertia of its own: J = b*r^2, ratio = 1/r
dry_friction coulomb_friction stiction backlash |  | it is not linear; linearise it
force actuator_force | force_source | or give it as an input, { force = "x" }
torque moment | torque_source | or give it as an input, { torque = "theta" }
imposed_motion displacement velocity acceleration base_excitation ground_motion | [inputs] | z = {
  displacement = "base" }, or velocity or acceleration
# Transmissions
gear gearbox gears reducer | transformer | ratio = speed of the output over speed of the input
planetary epicyclic differential power_split | planetary_gear
rack rack_and_pinion pinion drum winch | transformer | ratio = "r" [m/rad]
screw ball_screw ballscrew lead_screw leadscrew spindle | transformer | ratio = "10 mm/rev"
belt timing_belt chain pulley | transformer | ratio = "r_1/r_2", with a spring for its stretch
lever rocker bell_crank | transformer, rigid_link
# Structures
cantilever flexible_arm arm flexible_link blade boom | beam | fixed at one end
flexure leaf_spring massless_arm | massless_beam
truss truss_member portal frame_member | frame | at an angle; pins join without moments
axial_bar strut tie_rod drill_string | rod
rope cable wire thread | string | in transverse motion; a rope that pulls is a rod
torsion_bar drive_shaft driveshaft drill_pipe | shaft
clamp clamped wall encastre built_in | fixed
hinge hinged pinned simply_supported simple_support revolute | pin
roller guide guided sliding prismatic | slider
membrane plate shell solid |  | fields have one coordinate, x; take modes as resonances
# Circuits
motor dc dcmotor servo_motor servomotor brushless bldc pmsm | dc_motor
generator tachogenerator | dc_motor | with a resistor at its terminals
linear_motor solenoid shaker coil lorentz_actuator moving_coil vca | voice_coil
loudspeaker speaker driver woofer microphone | voice_coil | with a piston to its box
piezo_actuator pzt stack piezoelectric | piezo
electrical_transformer transformer_windings mutual_inductance | coupled_inductors, transformer
opamp operational_amplifier amp amplifier | op_amp | a gain alone is a factor in a signal
choke winding solenoid_coil | inductor
battery supply inverter | voltage_source | or an input { voltage = ... }
controlled_source dependent_source transconductance ota | vccs, vcvs, ccvs, cccs
transmission_line rlgc_line telegraph_line | [fields] | two unknowns, v and i, along x
# Sound, liquids, heat
box enclosure cavity volume accumulator | acoustic_compliance
port vent tube neck inertance | acoustic_mass
orifice valve leak restrictor mesh | acoustic_resistance
cylinder diaphragm hydraulic_cylinder cone | piston
pump | flow_source | or an input { flow = ... }
insulation thermal_resistor thermal_conductance heat_sink | thermal_resistance | R = "l/(lambda*A)", or
  "1/(h*A)"
thermal_capacitance thermal_capacitor thermal_mass heat_capacity | thermal_capacity
heater heat heat_flow heating | heat_source | or an input { heat = "air" }
ambient thermostat | temperature_source | or an input { temperature = "outside" }
# Control
notch notch_filter antiresonance | notch
low_pass lowpass first_order pt1 rc_filter time_constant | lag, low_pass
lead compensator lead_compensator lag_compensator | lead_lag
pi pd controller regulator | pid
dead_time transport_delay pure_delay latency zoh sampling | delay
gain summer sum sensor encoder accelerometer tachometer | [signals] | e = "r - k*x"
transfer_function zpk filter high_pass washout butterworth pt2 plant | tf
derivative differentiator d_term | [signals] | v = "s*x", or "s/(1 + T*s)*x"
pade | delay | it is exact; `symflex rational` approximates
saturation limiter relay deadzone quantizer |  | it is not linear
"""
_ROWS = (row.split("|") for row in re.split(r"\n(?! )", _TABLE.strip()) if not row.startswith("#"))
THINGS = tuple(
    Thing(tuple(words.split()), use.strip(), " ".join("".join(how).split())) for words, use, *how in _ROWS
)


KEYS: dict[str, tuple[str, ...]] = {
    "node": ("at", "between"),
    "nodes": ("between", "at"),
    "ends": ("between",),
    "c": ("b",),
    "d": ("b",),
    "damping": ("b", "eta_s"),
    "stiffness": ("k",),
    "mass": ("m",),
    "inertia": ("J",),
    "length": ("l",),
    "density": ("rho",),
    "f": ("omega", "omega_p", "tau"),
    "f_0": ("omega", "omega_p"),
    "w": ("omega", "omega_p"),
    "frequency": ("omega", "omega_p"),
    "tau": ("T",),
    "T_d": ("T",),
    "K": ("k_p",),
    "M": ("tau",),
    "position": ("displacement",),
    "speed": ("velocity",),
    "F": ("f",),
    "value": ("f", "tau", "v", "i"),
}
"""Keys of an element or a block as others call them, and as they are called here."""
FORMULAS = {("T_i", "k_i"): 'k_i = "k_p/T_i"', ("T_n", "k_i"): 'k_i = "k_p/T_n"'} | {
    (word, "k_d"): f'k_d = "k_p*{word}"' for word in ("T_d", "T_v")
}
"""What to write for a word, where a key is known that follows from what the word means."""


def key_meant(word: str, known: Iterable[str]) -> str | None:
    """Return which of the known keys an unknown one means, None if that is not plain.

    >>> key_meant("c", ("between", "b")), key_meant("Kp", ("k_p", "k_i")), key_meant("x", ("k",))
    ('b', 'k_p', None)
    """
    known = list(known)
    alike = [k for k in known if k.replace("_", "").lower() == word.replace("_", "").lower()]
    return next((k for k in (*alike, *KEYS.get(word, ())) if k in known), None)


def thing(word: str) -> Thing | None:
    """Return what a word names, in any case, with blanks or hyphens; None if nothing is known of it.

    >>> thing("Op-Amp").use, thing("ball screw").how
    ('op_amp', 'ratio = "10 mm/rev"')
    >>> thing("x") is None
    True
    """
    plain = word.strip().lower().replace("-", "_").replace(" ", "_")
    wanted = {plain, plain.replace("_", "")}
    return next((t for t in THINGS if any({w, w.replace("_", "")} & wanted for w in t.words)), None)


def hint_of_type(
    word: str, known: Iterable[str], others: Container[str] = (), elsewhere: str = ""
) -> str | None:
    """Return what somebody may have meant by an unknown type; ``others`` are the types of ``elsewhere``."""
    if word in others:
        return f"'{word}' is {elsewhere}"
    known = list(known)
    meant = thing(word)
    if meant:
        return meant.hint(word)
    if misspelt := nearest(word, known, MISSPELT):
        return misspelt
    # What comes last says what it is: a coil_spring is a spring, a brushless motor a motor.
    last = word.strip().lower().replace("-", "_").replace(" ", "_").rpartition("_")[2]
    if last in known and last != word:
        return f"did you mean '{last}'?"
    meant = thing(last)
    return meant.hint(last) if meant else nearest(word, known)
