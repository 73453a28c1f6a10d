"""SPICE netlists as specifications, as a person would have written them.

Input: the text of a netlist (.cir, .net, .sp), and how files beside it are read. Output: the text of a
specification, each line with the statement it comes from: component values with units, nodes by name, sources
of small signals as inputs, what is printed or probed as outputs.

    RC low-pass                         title      = "RC low-pass"
    V1 in 0 AC 1                        parameters = { R1 = "10 kOhm", C1 = "4.7 nF" }
    R1 in out 10k                       inputs     = { V1 = { voltage = "in" } }
    C1 out 0 4.7n                       outputs    = { V_out = "out" }
    .print ac V(out)                    ...

The conventions are those of Berkeley SPICE 3 (Quarles et al. 1993, User's Manual) and of ngspice: the first
line is the title, M is milli and MEG is mega, letters after a suffix are ignored, upper and lower case are
alike, and a positive current flows into the first node of a source. A source without an AC value rests: a
voltage is a short circuit, a current is open. What ngspice reads otherwise than other simulators is refused.
"""

from symflex.model.spec.netlist.reader import specification_of
