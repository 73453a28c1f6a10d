# ruff: noqa: E501 - lines of files are kept whole
"""Files as instruments and programs save them, all of one resonance, made here and kept nowhere.

The shapes (preamble, header, delimiter, decimal sign, encoding, order, units) are those of public pages and
repositories; names and numbers are made up. ``h`` has one resonance at 62.8 rad/s with damping 0.02.
"""

from __future__ import annotations

import io
from dataclasses import dataclass

import numpy as np
import scipy.io

OMEGA, ZETA = 62.8, 0.02
F = np.linspace(1.0, 50.0, 99)
S = 2j * np.pi * F
H = 25 / (S * S + 2 * ZETA * OMEGA * S + OMEGA**2)
H2 = 0.5 * H + 0.001
SIZE, DB, TURN = abs(H), 20 * np.log10(abs(H)), np.unwrap(np.angle(H))
DEG = np.degrees(TURN)
COH = 1 - 0.001 * np.arange(F.size) / F.size


@dataclass(frozen=True)
class Saved:
    """A file, what is to be read from it, and the option that a person has to add, if any."""

    name: str
    content: bytes
    values: tuple[np.ndarray, ...] = (H,)
    columns: str = ""
    tolerance: float = 2e-4
    frequency: tuple[np.ndarray, ...] = (F, F)


def rows(*columns, sep=",", decimal=".", form="{:.9E}"):
    """Return rows of numbers; columns of text are taken as they are."""
    lines = []
    for i in range(F.size):
        cells = [c[i] if isinstance(c[i], str) else form.format(c[i]).replace(".", decimal) for c in columns]
        lines.append(sep.join(cells))
    return "\n".join(lines) + "\n"


RE, IM = H.real, H.imag
POINT = [str(i) for i in range(F.size)]
TEN = ["10.0"] * F.size
POLAR = [f"({d:.14e}dB,{p:.14e}°)" for d, p in zip(DB, DEG, strict=True)]


def text_files():  # noqa: PLR0915 - one statement a file
    """Return files of text."""
    for said, first, second in (("no", DB - 6, H), ("yes", DB, H)):
        yield Saved(  # WaveForms: the phase is always that of channel 2 against channel 1
            f"relative_{said}.csv",
            (
                f"#Digilent WaveForms Network Analyzer - Bode\n#Channel: Channel 2\n#Relative: {said}\n\n"
                "Frequency (Hz),Channel 1 Magnitude (dB),Channel 2 Magnitude (dB),Channel 2 Phase (deg)\n"
                + rows(F, 0 * F - 6, first, DEG)
            ).encode(),
            (second,),
        )
    yield Saved("power.csv", ("f (Hz),Power ratio (10log10 dB),Phase (deg)\n" + rows(F, DB, DEG)).encode())
    yield Saved(
        "power_itself.csv", ("f,Power ratio (10log10 dB),Phase (deg)\n" + rows(F, DB / 2, DEG)).encode()
    )
    yield Saved("power_plain.csv", ("f (Hz),Power,Phase (deg)\n" + rows(F, SIZE**2, DEG)).encode())
    yield Saved(
        "shift.dat",
        ("Frequency Shift (Hz)\tCenter Frequency (Hz)\tAmplitude (m)\tPhase (deg)\n"
        + rows(F - 25, 0 * F + 25, SIZE, DEG, sep="\t")).encode(),
    )  # fmt: skip
    yield Saved(  # VersaStudio: an impedance beside the voltage and the current whose ratio it is
        "potentiostat.par",
        ("#,E(V),Frequency(Hz),E Real,E Imag,I Real,I Imag,Z Real,Z Imag\n"
        + rows(POINT, 0 * F, F, 2 * RE, 2 * IM, 0 * F + 2, 0 * F, RE, IM)).encode(),
    )  # fmt: skip
    for name in ("log f", "log10(f/Hz)", "lg f [Hz]"):
        yield Saved(f"{len(name)}.csv", (f"{name},re,im\n" + rows(np.log10(F), RE, IM)).encode())
    yield Saved(
        "log_ohm.csv", ("f/Hz;log(|Z|/Ohm);phase/deg\n" + rows(F, np.log10(SIZE), DEG, sep=";")).encode()
    )
    yield Saved(
        "oros.csv",
        (
            "CSVFormatType;Spectrum2DComplex\nFirst;0,000000E+00\nAxisUnit;Hz\nSignals;2\n\n"
            "Name;Signal 2;Signal 3\nFunctionType;SpectrumFrfH1;SpectrumFrfH1\n\n"
            "';Signal 2 (Real);Signal 2 (Imag.);Signal 3 (Real);Signal 3 (Imag.)\n"
            "';(m/s^2)/N;(m/s^2)/N;(m/s^2)/N;(m/s^2)/N\n"
            + rows(F, RE, IM, H2.real, H2.imag, sep=";", decimal=",")
        ).encode(),
        (H, H2),
    )
    yield Saved(
        "bode_analyzer.csv",
        (
            'Frequency (Hz);"Trace 1: Gain: Magnitude (dB)";"Trace 2: Gain: Phase (°)"\n'
            + rows(F, DB, DEG, sep=";")
        ).encode(),
    )
    yield Saved(
        "bode_analyzer_complex.csv",
        (
            '\ufeffFrequency (Hz);"Trace 1: Gain: Real ";"Trace 1: Gain: Imaginary ";Trace 1: Gain: Magnitude (dB);'
            '"Trace 2: Gain: Real ";"Trace 2: Gain: Imaginary ";Trace 2: Gain: Phase (°)\n'
            + rows(F, RE, IM, DB, RE, IM, DEG, sep=";", decimal=",")
        ).encode(),
    )
    yield Saved(
        "room_wizard.txt",
        (
            "* Measurement data measured by V5.20\n* Source: USB, microphone\n* Format: 48000 Hz, float, mono\n"
            "* Dated: 01-Jan-2020\n*\n* Freq(Hz) SPL(dB) Phase(degrees)\n"
            + rows(F, DB, DEG, sep=" ", form="{:.5f}")
        ).encode(),
    )
    yield Saved("loudspeaker.frd", rows(F, DB, DEG, sep="  ", form="{:.5f}").encode())
    yield Saved(
        "wrapped.frd", ("* exported\n" + rows(F, DB, np.degrees(np.angle(-H)), sep="\t")).encode(), (-H,)
    )
    yield Saved(
        "box.zma",
        (
            "*******\n* FILE: x\n* Data: Impedance (ohms), Phase (degrees)\n" + rows(F, SIZE, DEG, sep=" ")
        ).encode(),
    )
    yield Saved(
        "tester.zma", ("* Freq(Hz)\tImpedance(Ohms)\tPhase(Deg)\n" + rows(F, SIZE, DEG, sep="\t")).encode()
    )
    yield Saved("bare.zma", rows(F, SIZE, DEG, sep=" ").encode())
    yield Saved("acoustics.txt", ("Freq [Hz]  dBSPL  Phase [Deg]\n" + rows(F, DB, DEG, sep="   ")).encode())
    yield Saved(
        "usb_scope.csv",
        (
            "#WaveForms Network Analyzer - Bode\n#Device Name: x\n#Start: 1 Hz\n#Stop: 50 Hz\n#Steps: 99\n\n"
            "Frequency (Hz),Channel 1 Magnitude (dB),Channel 2 Magnitude (dB),Channel 2 Phase (*)\n"
            + rows(F, np.ones(99), DB, DEG)
        ).encode(),
    )
    yield Saved(
        "scope_bode.csv",
        (
            "#,Frequency (Hz),Amplitude (Vpp),Gain (dB),Phase (°)\n" + rows(POINT, F, np.ones(99), DB, DEG)
        ).encode("cp1252"),
    )
    yield Saved(
        "scope_log.csv",
        ("Frequency Log(Hz), Gain (dB), Phase (deg)\n" + rows(np.log10(F), DB, DEG, sep=", ")).encode(),
    )
    yield Saved("scope_comma.csv", ('"Frequency","Gain","Phase"\n' + rows(F, DB, DEG)).encode())
    yield Saved(
        "network.csv",
        (
            "!CSV A.01.01\r\n!Maker,Model,Serial,Firmware\r\n!Date: today\r\n!Source: Standard\r\n\r\nBEGIN CH1_DATA\r\n"
            "Freq(Hz),S21(REAL),S21(IMAG),S11(REAL),S11(IMAG)\r\n"
            + rows(F, RE, IM, H2.real, H2.imag).replace("\n", "\r\n")
            + "END\r\n"
        ).encode(),
        (H, H2),
    )
    yield Saved(
        "vector.csv",
        (
            "# Version 1.00\n#\nfreq[Hz];re:Trc1_S21;im:Trc1_S21;\n"
            + rows(F, RE, IM, sep=";").replace("\n", ";\n")
        ).encode(),
    )
    yield Saved(
        "trace.csv",
        (
            "! MAKER, model, serial\n! Date: 01.01.2020 10:00:00\n! Stimulus(Hz), S21 [Re], S21 [Im]\n"
            + rows(F, RE, IM)
        ).encode(),
    )
    yield Saved("spice.txt", ("Freq.\tV(out)\n" + rows(F, POLAR, sep="\t")).encode("cp1252"))
    yield Saved(
        "spice_cartesian.txt",
        (
            "Freq.\tV(out)\tV(mid)\n"
            + rows(
                F,
                [f"{a:.14e},{b:.14e}" for a, b in zip(RE, IM, strict=True)],
                [f"{a:.14e},{b:.14e}" for a, b in zip(H2.real, H2.imag, strict=True)],
                sep="\t",
            )
        ).encode(),
        (H, H2),
    )
    yield Saved(
        "spice_steps.txt",
        (
            "Freq.\tV(out)\nStep Information: R=1  (Step: 1/2)\n"
            + rows(F, POLAR, sep="\t")
            + "Step Information: R=2  (Step: 2/2)\n"
            + rows(
                F, [f"({20 * np.log10(abs(z)):.9e}dB,{np.degrees(np.angle(z)):.9e}°)" for z in H2], sep="\t"
            )
        ).encode("utf-8"),
        (H, H2),
    )
    down = slice(None, None, -1)
    yield Saved(
        "cell.mpt",
        (
            "EC-Lab ASCII FILE\nNb header lines : 5\n\nTechnique : impedance\n"
            "freq/Hz\tRe(Z)/Ohm\t-Im(Z)/Ohm\t|Z|/Ohm\tPhase(Z)/deg\ttime/s\n"
            + rows(
                F[down], RE[down], -IM[down], SIZE[down], DEG[down], np.arange(99.0), sep="\t", decimal=","
            )
        ).encode("cp1252"),
    )
    yield Saved(
        "potentiostat.DTA",
        (
            "EXPLAIN\nTAG\tEISPOT\nTITLE\tLABEL\tx\nFREQINIT\tQUANT\t1.00000E+002\tHz\nZCURVE\tTABLE\n"
            "\tPt\tTime\tFreq\tZreal\tZimag\tZsig\tZmod\tZphz\tIdc\n\t#\ts\tHz\tohm\tohm\tV\tohm\t°\tA\n"
            + "\t"
            + rows(
                POINT,
                np.arange(99.0),
                F[down],
                RE[down],
                IM[down],
                np.ones(99),
                SIZE[down],
                DEG[down],
                SIZE,
                sep="\t",
            )
            .replace("\n", "\n\t")
            .rstrip("\t")
        ).encode("cp1252"),
    )
    yield Saved(
        "one_quoted_header.z",
        (
            '"ZPlotW Data File: Version 3.2c"\n"Raw Data"\nDate: 1-2-2020\n"  Freq(Hz)    Ampl     Bias   Time(Sec)   Z\'(a)    Z\'\'(b)    GD   Err   Range"\n'
            + rows(F[::-1], TEN, TEN, POINT, RE[::-1], IM[::-1], TEN, form="{:.7E}")
        ).encode(),
    )
    yield Saved(
        "two_tables.DTA",
        (
            "EXPLAIN\nTAG\tEISPOT\nOCVCURVE\tTABLE\t1500\n\tPt\tT\tVf\tVm\n\t#\ts\tV vs. Ref.\tV\n"
            + "".join(f"\t{i}\t{0.25 * i:g}\t-0.34\t-0.35\n" for i in range(1500))
            + "ZCURVE\tTABLE\n\tPt\tFreq\tZreal\tZimag\tZsig\n\t#\tHz\tohm\tohm\tV\n"
            + "".join(
                f"\t{line}\n" for line in rows(POINT, F[::-1], RE[::-1], IM[::-1], TEN, sep="\t").splitlines()
            )
        ).encode(),
    )
    yield Saved(
        "blank_lines_between.txt",
        ("Frequency\t Zre\t Zimg\n\n" + rows(F, RE, IM, sep="\t ").replace("\n", "\n\n")).encode(),
    )
    yield Saved(
        "autolab.txt",
        (
            "Index;Frequency (Hz);Z' (Ω);-Z'' (Ω);Z (Ω);-Phase (°);Time (s)\n"
            + rows(POINT, F[down], RE[down], -IM[down], SIZE[down], -DEG[down], np.arange(99.0), sep=";")
        ).encode(),
    )
    yield Saved(
        "plot.z",
        (
            '"ZPLOT2 ASCII"\n"Sweep Frequency: Control Voltage"\n  "Freq(Hz)"  "Ampl"  "Bias"  "Time(Sec)"  "Z\'(a)"  "Z\'\'(b)"  "Err"\n "End Comments"\n'
            + rows(
                F[down],
                np.zeros(99),
                np.zeros(99),
                np.arange(99.0),
                RE[down],
                IM[down],
                np.zeros(99),
                sep="  ",
            )
        ).encode(),
    )
    yield Saved(
        "impedance_traces.txt",
        (
            '"4294X REV1.10"\n"DATE: Jan 01 2020"\n"MEASURE: IMPEDANCE"\n"TRACE: A"\n"FORMAT: |Z| (Ohm)"\n"Frequency"\t"Value"\n'
            + rows(F, SIZE, sep="\t")
            + '\n\n"TRACE: B"\n"FORMAT: PHASE (deg)"\n"Frequency"\t"Value"\n'
            + rows(F, DEG, sep="\t")
        ).encode(),
    )
    yield Saved(
        "two_tables.csv",
        (
            "Magnitude\nFrequency (Hz),Magnitude (dB)\n"
            + rows(F, DB)
            + "\nPhase\nFrequency (Hz),Phase (rad)\n"
            + rows(F, TURN)
        ).encode(),
    )
    yield Saved(
        "printer_x.csv",
        (
            "freq,psd_x,psd_y,psd_z,psd_xyz\n"
            + rows(F, SIZE**2, 1e-3 * SIZE, 1e-4 * SIZE, SIZE**2 + 1e-3 * SIZE)
        ).encode(),
        tolerance=0.1,
    )
    yield Saved("level.csv", rows(F[::-1], DB[::-1]).encode(), (H,), "f,mag_db", tolerance=0.1)
    yield Saved("matrix.csv", ("f_Hz,H\n" + rows(F, [f"{z.real:.12g}{z.imag:+.12g}i" for z in H])).encode())
    yield Saved("numpy.dat", ("# f [Hz] re im\n" + rows(F, RE, IM, sep=" ", form="{:.18e}")).encode())
    yield Saved(
        "numpy_complex.dat",
        ("# freq_hz response\n" + rows(F, [f" ({z.real:.18e}{z.imag:+.18e}j)" for z in H], sep=" ")).encode(),
    )
    yield Saved("frame.csv", (",freq_hz,re,im\n" + rows(POINT, F, RE, IM)).encode())
    yield Saved(
        "vibration_utf16.txt",
        (
            "Test: wing\tRun 3\r\n\r\nFrequency\tReal\tImaginary\r\nHz\tg/N\tg/N\r\n"
            + rows(F, RE, IM, sep="\t", decimal=",")
        ).encode("utf-16"),
    )
    yield Saved(
        "sheet.csv",
        (
            '"Frequenz [Hz]";"Betrag [dB]";"Phase [°]"\n'
            + rows(*([f'"{x:.6f}"'.replace(".", ",") for x in y] for y in (F, DB, DEG)), sep=";")
        ).encode("cp1252"),
    )
    yield Saved("kilohertz.csv", ("f (kHz),mag,phase (deg)\n" + rows(F / 1e3, SIZE, DEG)).encode())
    yield Saved("megahertz.txt", ("Freq. [MHz]\tRe\tIm\n" + rows(F / 1e6, RE, IM, sep="\t")).encode())
    yield Saved(
        "simulator.csv",
        ("Frequency (rad/s),Magnitude (abs),Phase (deg)\n" + rows(2 * np.pi * F, SIZE, DEG)).encode(),
    )
    yield Saved(
        "designer.csv",
        (
            "Frequency (Hz),Frequency (rad/sec),Gain (V/V),Gain (dB),Phase (Deg),Phase (Rad),Group Delay (uSec),\n"
            + rows(F, [f"{w:.1f}" for w in 2 * np.pi * F], [f"{x:.3f}" for x in SIZE], DB, DEG,
                   [f"{x:.3f}" for x in TURN], TEN, [""] * F.size)
        ).encode(),
    )  # fmt: skip
    yield Saved("bench.dat", rows(F, SIZE, -DEG, sep="\t").encode(), (H,), "f,mag,-phase_deg")
    yield Saved("lags.dat", rows(F, SIZE, -DEG, sep="\t").encode(), (H.conj(),), "f,mag,phase_deg")
    yield Saved("radians.csv", ("Frequency,Magnitude (dB),Phase\n" + rows(F, DB, np.angle(H))).encode())
    yield Saved("degrees.csv", ("Frequency,Magnitude,Phase\n" + rows(F, SIZE, DEG)).encode())
    yield Saved(
        "harmonic.txt",
        (
            "\tFrequency [Hz]\tAmplitude [mm]\tPhase Angle [°]\n" + rows(POINT, F, SIZE, DEG, sep="\t")
        ).encode(),
    )
    yield Saved(
        "finite_elements.txt",
        (
            "% Model:   x\n% Date:    today\n% freq (Hz)              abs(w) (mm)              arg(w) (rad)\n"
            + rows(F, SIZE, TURN, sep="    ")
        ).encode(),
    )
    yield Saved(
        "fft_analyser.csv",
        ("Model,CF-9000\nDate,2020/01/01\nAverage,32\nX(Hz),Real,Imag\n" + rows(F, RE, IM)).encode(),
    )
    yield Saved(
        "virtual.lvm",
        (
            "LabVIEW Measurement\t\nWriter_Version\t2\nSeparator\tTab\nDecimal_Separator\t,\n***End_of_Header***\t\n\t\n"
            "Channels\t2\t\nX_Dimension\tFrequency\tFrequency\t\n***End_of_Header***\t\t\nX_Value\tReal\tImag\tComment\n"
            + rows(F, RE, IM, sep="\t", decimal=",")
        ).encode(),
    )
    yield Saved(
        "bench_scope.csv", ("Frequency(Hz),CH2 Amplitude(dB),CH2 Phase(Deg)\n" + rows(F, DB, DEG)).encode()
    )
    yield Saved(
        "instrument_app.csv",
        (
            "% Frequency Response Analyzer\n% 2020-01-01\n% Frequency (Hz), Channel 1 Magnitude (dB), Channel 1 Phase (deg), Channel 2 Magnitude (dB), Channel 2 Phase (deg)\n"
            + rows(F, DB, DEG, 20 * np.log10(abs(H2)), np.degrees(np.angle(H2)), sep=", ")
        ).encode(),
        (H, H2),
    )
    yield Saved(
        "live_sound.txt",
        (
            "Frequency (Hz)\tMagnitude (dB)\tPhase (degrees)\tCoherence\n" + rows(F, DB, DEG, COH, sep="\t")
        ).encode(),
    )
    yield Saved("semicolons.dat", ("; measured by hand\n; f re im\n" + rows(F, RE, IM, sep="  ")).encode())
    yield Saved(
        "side_by_side.csv",
        ("f1 [Hz],Re1,Im1,f2 [Hz],Re2,Im2\n" + rows(F, RE, IM, F + 0.25, H2.real, H2.imag)).encode(),
        (H, H2),
        frequency=(F, F + 0.25),
    )
    yield Saved(
        "modal.csv",
        (
            '"Frequency(Hz)","H(1,2) Real","H(1,2) Imag","H(2,2) Real","H(2,2) Imag"\n'
            + rows(F, RE, IM, H2.real, H2.imag)
        ).encode(),
        (H, H2),
    )
    yield Saved(
        "fortran.dat",
        (
            "* FREQ        REAL          IMAG\n"
            + rows(F, RE, IM, sep="  ").replace("E", "D").replace("FRDQ", "FREQ")
        ).encode(),
    )
    yield Saved(
        "with_dc.csv",
        ("Frequency (Hz),Magnitude (dB),Phase (deg),Coherence\n0,*,*,0\n" + rows(F, DB, DEG, COH)).encode(),
    )
    yield Saved("no_header.csv", rows(F, RE, IM).encode(), columns="f,re,im")
    yield Saved("no_header_db.txt", rows(F, DB, DEG, sep="\t").encode(), columns="f,mag_db,phase")
    yield Saved(
        "no_header_khz.prn", rows(F / 1e3, TEN, SIZE, TURN, sep=" ").encode(), columns="f_khz,-,mag,phase_rad"
    )


def wild_files():
    """Return files of text whose words, signs or lines are not those of one table of numbers."""
    two = (H, 0.5 * H)
    yield Saved("rows_named.txt", ("f re im\n" + rows(POINT, F, RE, IM, sep=" ")).encode())
    yield Saved("reactance.csv", ("Frequency(Hz), R(ohm)-data, X(ohm)-data\n" + rows(F, RE, IM)).encode())
    yield Saved("susceptance.csv", ("Frequency(Hz), G(S), B(S)\n" + rows(F, RE, IM)).encode())
    yield Saved("lock_in.txt", ("Freq (Hz)\tR (V)\tTheta (deg)\n" + rows(F, SIZE, DEG, sep="\t")).encode())
    yield Saved("lock_in_xy.csv", ("f;x;y;r;phase\n" + rows(F, RE, IM, SIZE, TURN, sep=";")).encode())
    yield Saved(
        "memory.csv",
        (
            "Frequency (Hz),Gain: Magnitude (dB),Gain: Magnitude (dB) (Memory),Phase (°),Phase (°) (Memory)\n"
            + rows(F, DB, DB + 20 * np.log10(0.5), DEG, DEG)
        ).encode(),
        two,
    )
    yield Saved(
        "unit_row.txt", ("Linear\tAmplitude\tPhase\nHz\tg/N\t°\n" + rows(F, SIZE, DEG, sep="\t")).encode()
    )
    yield Saved(
        "one_x.lvm",
        (
            "Separator\tTab\n***End_of_Header***\n\nY_Unit_Label\tdB\tDegree\nX_Dimension\tFrequency\tFrequency\n"
            "X_Value\tFRF (Magnitude)\tFRF (Phase)\tComment\n" + rows(F, DB, DEG, sep="\t")
        ).encode(),
    )
    yield Saved("probe.csv", ("Frequency,DB(V(OUT)),P(V(OUT))\n" + rows(F, DB, DEG)).encode())
    yield Saved("printed.out", ("  FREQ   VDB(OUT)   VP(OUT)\n\n" + rows(F, DB, DEG, sep="   ")).encode())
    yield Saved(
        "printed_complex.txt",
        (
            "Index frequency v(out)\n" + rows(POINT, F, [f"{z.real:.9e},\t{z.imag:.9e}" for z in H], sep="\t")
        ).encode(),
    )
    yield Saved(
        "in_and_out.txt",
        (
            "Freq.\tV(in)\tV(out)\n"
            + rows(F, ["2.0,0.0"] * F.size, [f"{z.real:.9e},{z.imag:.9e}" for z in 2 * H], sep="\t")
        ).encode(),
    )
    yield Saved(
        "two_channels.csv", ("freq,vin,vout,phase_deg\n" + rows(F, 0 * F + 1.5, 1.5 * SIZE, DEG)).encode()
    )
    lines = [",".join([name, *(f"{x:.9e}" for x in row)]) for name, row in (("f", F), ("re", RE), ("im", IM))]
    yield Saved("in_rows.csv", "\n".join(lines).encode())
    written = rows(F, RE, IM, sep="   ").replace("E", "D")
    yield Saved("fortran_c.dat", ("C     RUN 3\nC     FREQ(HZ)   REAL   IMAG\n" + written).encode())
    traces = (
        f'"TRACE: {name}"\n"FORMAT: {kind}"\n"Frequency"\t"Data Trace Real"\t"Data Trace Imag"\n'
        + rows(F, values, 0 * F, sep="\t")
        for name, kind, values in (("A", "|Z|", SIZE), ("B", "Theta", DEG))
    )
    yield Saved("two_traces.txt", ('"4294A REV1.11"\n\n' + "\n".join(traces)).encode())
    yield Saved(
        "levels.csv",
        ("f (Hz),Input (dBV),Output (dBV),Phase (deg)\n" + rows(F, 0 * F - 6, DB - 6, DEG)).encode(),
    )
    yield Saved(
        "old_numpy.txt",
        (
            "# freq H\n"
            + rows(
                [f"({f:.12e}+0.0e+00j)" for f in F], [f"({z.real:.9e}+{z.imag:.9e}j)" for z in H], sep="  "
            )
        ).encode(),
    )
    yield Saved("julia.csv", ("f,H\n" + rows(F, [f"{z.real:.9e} - {-z.imag:.9e}im" for z in H])).encode())
    yield Saved(
        "french.csv",
        ("Fréquence (Hz);Partie réelle;Partie imaginaire\n" + rows(F, RE, IM, sep=";", decimal=",")).encode(
            "cp1252"
        ),
    )
    yield Saved(
        "spanish.csv", ("Frecuencia (Hz);Magnitud (dB);Fase (grados)\n" + rows(F, DB, DEG, sep=";")).encode()
    )
    yield Saved(
        "russian.csv", ("Частота, Гц;Амплитуда, дБ;Фаза, град\n" + rows(F, DB, DEG, sep=";")).encode()
    )
    yield Saved("japanese.csv", ("周波数[Hz],ゲイン[dB],位相[deg]\n" + rows(F, DB, DEG)).encode("shift_jis"))
    yield Saved("ohm.txt", ("Freq[Hz]   Ohm   Phase[Deg]\n" + rows(F, SIZE, DEG, sep="   ")).encode())
    yield Saved(
        "negative_phase.csv",
        (
            "freq / Hz, neg. Phase / °, Z / Ohm, Z' / Ohm, -Z'' / Ohm, Cs / F\n"
            + rows(F, -DEG, SIZE, RE, -IM, TEN)
        ).encode(),
    )
    yield Saved(
        "apostrophes.csv",
        (
            "Frequenz [Hz];Betrag [dB];Phase [°]\n"
            + rows([f"{1000 * f:,.7f}".replace(",", "'") for f in F], DB, DEG, sep=";")
        ).encode(),
        frequency=(1000 * F,),
    )
    yield Saved(
        "cells_with_units.csv",
        (
            "Frequency,Magnitude,Phase\n"
            + rows(
                [f"{f:.9f} Hz" if f < 20 else f"{f / 1e3:.12f} kHz" for f in F],
                [f"{d:.6f} dB" for d in DB],
                [f"{d:.6f} deg" for d in DEG],
            )
        ).encode(),
    )
    yield Saved("angular.csv", ("omega [1/s],|G|,arg(G) [rad]\n" + rows(2 * np.pi * F, SIZE, TURN)).encode())
    yield Saved(
        "spread.csv",
        ("f,mag,mag_std,phase_deg,phase_std\n" + rows(F, SIZE, SIZE / 99, DEG, 0 * F + 0.5)).encode(),
    )
    yield Saved("per_cent.csv", ("f (Hz),re,im,Coherence (%)\n" + rows(F, RE, IM, 100 * COH)).encode())
    yield Saved("padded.txt", universal(F, H).encode(), tolerance=1e-4, frequency=(F,))


def files_of_tables():
    """Return files of text as spreadsheets and people write them."""
    hertz = np.round(F * 1e3)
    for name, mark, sep, decimal in (("whole.csv", ",", ",", "."), ("whole_de.csv", ".", ";", ",")):
        cells = [f'"{f:,.0f}"'.replace(",", mark) for f in hertz]
        columns = ([f"{x:.7f}".replace(".", decimal) for x in y] for y in (100 * SIZE, DEG))
        yield Saved(name, ("f [Hz];|H| [%];φ [°]\n".replace(";", sep) + rows(cells, *columns, sep=sep)).encode(),
                    frequency=(hertz,))  # fmt: skip
    yield Saved(
        "angles.csv",
        (
            "Frequenz in Hz;Amplitude in dB;Phasenwinkel in Grad\n" + rows(F, DB, DEG, sep=";", decimal=",")
        ).encode(),
    )
    yield Saved("parts_jp.csv", ("周波数[Hz],実部,虚部\n" + rows(F, RE, IM)).encode())
    yield Saved(
        "receptance.csv", ("Frequency (Hz),Receptance (m/N),Phase (deg)\n" + rows(F, SIZE, DEG)).encode()
    )
    yield Saved("joined.csv", ("freqHz,magdB,PhaseDeg\n" + rows(F, DB, DEG)).encode())
    twice = 2 * H * (1 + 0.5j)
    yield Saved(
        "spectra.csv",
        (
            "Frequency (Hz),Force Re (N),Force Im (N),Accel Re (m/s^2),Accel Im (m/s^2)\n"
            + rows(F, 0 * F + 2, 0 * F + 1, twice.real, twice.imag)
        ).encode(),
    )
    yield Saved("ratio.csv", ("f (Hz),Vout/Vin,Phase (deg)\n" + rows(F, SIZE, DEG)).encode())
    yield Saved(
        "errors.csv",
        ("f [Hz],Mag,Mag_err,Phase [deg],Phase_err\n" + rows(F, SIZE, SIZE / 99, DEG, 0 * F + 0.5)).encode(),
    )
    yield Saved(
        "least_mean_most.csv",
        (
            "f (Hz),Gain min (dB),Gain mean (dB),Gain max (dB),Phase (deg)\n"
            + rows(F, DB - 1, DB, DB + 1, DEG)
        ).encode(),
    )
    yield Saved(
        "volts.csv",
        (
            "Frequency (Hz),CH1 Amplitude (V),CH2 Amplitude (V),Phase CH2-CH1 (deg)\n"
            + rows(F, F, F * SIZE, DEG)
        ).encode(),
    )


def simulated_files():
    """Return files of text that programs of mathematics, simulators and boards write."""
    for name, shape in (("octave.mat", (F.size, 1)), ("octave_rows.txt", (1, F.size))):
        head = "# Created by Octave 8.4.0\n" if shape[0] > 1 else "# Created by Octave 6.1.0, x\r\n"
        end = "\n " if shape[0] > 1 else " "
        variables = (
            f"# name: {word}\n# type: {kind}\n# rows: {shape[0]}\n# columns: {shape[1]}\n {end.join(cells)}\n\n\n"
            for word, kind, cells in (
                ("f", "matrix", [f"{f:.12g}" for f in F]),
                ("H", "complex matrix", [f"({z.real:.9g},{z.imag:.9g})" for z in H]),
            )
        )
        text = "# name: note\n# type: string\n# elements: 1\n# length: 3\nrig\n\n\n"
        yield Saved(name, (head + text + "".join(variables)).encode())
    yield Saved(
        "controller.txt",
        (
            "Freq [rad/s]  Response\n------------  ---------------------\n"
            + "".join(
                f"{2 * np.pi * f:12.7f} {z.real:12.6g}{z.imag:+12.6g}j\n" for f, z in zip(F, H, strict=True)
            )
        ).encode(),
    )
    yield Saved(
        "unit_row_apart.txt", ("Hz\tAmplitude\tPhase\n\tg/N\t°\n" + rows(F, SIZE, DEG, sep="\t")).encode()
    )
    yield Saved("board.csv", ('"Frequency","V(/out) (gain)","V(/out) (phase)"\n' + rows(F, DB, DEG)).encode())
    yield Saved("prefixed.csv", ("freq[Hz];db:Trc1_S21;deg:Trc1_S21;\n" + rows(F, DB, DEG, sep=";")).encode())
    yield Saved("dotted.csv", ("PNT,FREQ1.GHZ,LOGMAG1,PHASE1\n" + rows(POINT, F / 1e9, DB, DEG)).encode())
    yield Saved(
        "bridge.csv", ("f [Hz],|Z| [Ohm],P [deg],Ls [H],Cs [F]\n" + rows(F, SIZE, DEG, TEN, TEN)).encode()
    )
    yield Saved(
        "horn.txt", ("Freq (hertz),SPL (dB),Ze (ohms),ZePhase (deg)\n" + rows(F, DB + 90, SIZE, DEG)).encode()
    )
    yield Saved(
        "shaker.csv", ("Frequency (Hz),Transmissibility (G/G),Phase (deg)\n" + rows(F, SIZE, DEG)).encode()
    )
    yield Saved(
        "express.txt",
        (
            "Frequency - mag (Hz),FRF mag (dB),Frequency - phase (Hz),FRF phase (deg)\n" + rows(F, DB, F, DEG)
        ).encode(),
    )
    listed = [
        f" {i}\t{f:.9e},0.0\n\t{h.real:.9e},{h.imag:.9e}\n" for i, (f, h) in enumerate(zip(F, H, strict=True))
    ]
    names = "Variables:\n\t0\tfrequency\tfrequency\tgrid=3\n\t1\tv(out)\tvoltage\nValues:\n"
    yield Saved("spice.raw", (f"Title: * filter\nFlags: complex\n{names}" + "\n".join(listed)).encode())
    yield Saved(
        "unlike.csv",
        ("Frequency (Hz),H(Ch2;Ch1) (g/g),H(Ch2;Ch1) Phase (Degree)\n" + rows(F, SIZE, DEG)).encode(),
    )
    yield Saved(
        "named.csv",
        ("f_hz,Re(A_1/F),Im(A_1/F),Re(A_2/F),Im(A_2/F)\n" + rows(F, RE, IM, H2.real, H2.imag)).encode(),
        (H, H2),
    )
    yield Saved("lag.csv", ("Frequency (Hz),Gain (dB),Phase lag (deg)\n" + rows(F, DB, -DEG)).encode())
    yield Saved("chinese.csv", ("频率(Hz),幅值(dB),相位(°)\n" + rows(F, DB, DEG)).encode("gb18030"))
    head = "LabVIEW Measurement\t\nSeparator\tTab\nDecimal_Separator\t,\nX_Columns\tNo\n***End_of_Header***\t\n\t\n"
    channels = (
        "Channels\t2\t\nY_Unit_Label\tdB\tDegree\t\nX_Dimension\tFrequency\tFrequency\t\nX0\t1,0E+0\t1,0E+0\t\n"
        "Delta_X\t0,5\t0,5\t\n***End_of_Header***\t\t\nX_Value\tFRF (Magnitude)\tFRF (Phase)\tComment\n"
    )
    lines = rows(DB, DEG, sep="\t", decimal=",").splitlines()
    yield Saved("without_x.lvm", (head + channels + "".join(f"\t{line}\n" for line in lines)).encode())
    citi = "CITIFILE A.01.00\nNAME DATA\nVAR FREQ MAG 99\nDATA S[2,1] RI\n"
    listed = "VAR_LIST_BEGIN\n" + "".join(f"{f:.9g}\n" for f in F) + "VAR_LIST_END\nBEGIN\n"
    segment = "SEG_LIST_BEGIN\nSEG 1 50 99\nSEG_LIST_END\nBEGIN\n"
    yield Saved("segment.cti", (citi + segment + rows(RE, IM) + "END\n").encode())
    yield Saved("list.citi", (citi + listed + rows(RE, IM) + "END\n").encode())
    yield Saved("unit_alone.csv", ("Stimulus,Real,Imag\nMHz,,\n" + rows(F / 1e6, RE, IM)).encode())
    parts = "\n".join(",".join(f"{x:.9e}" for x in row) for row in (F, RE, IM))
    yield Saved("bare_rows.csv", parts.encode(), columns="f,re,im")


def files_of_simulators_and_names():
    """Return files whose columns are named twice, elsewhere, by letters, or with a force below the bar."""
    yield Saved("qucs.csv", ('"acfrequency";"r out.v";"i out.v"\n' + rows(F, RE, IM, sep=";")).encode())
    body = "".join(f"  {z.real:+.11e}-j{-z.imag:.11e}\n" for z in H)
    axis = "".join(f"  {f:+.11e}\n" for f in F)
    qucs = f"<Qucs Dataset 0.0.19>\n<indep acfrequency 99>\n{axis}</indep>\n<dep out.v acfrequency>\n{body}</dep>\n"
    yield Saved("qucs.dat", qucs.encode())
    names = " frequency       v(out)          v(out)\n"
    yield Saved("wrdata.data", (names + rows(F, RE, IM, sep="  ")).encode())
    gcs = (
        "# REM E-712\n# DIM = 3\n# NAME0 = Frequency [Hz]\n# NAME1 = Magnitude [dB]\n# NAME2 = Phase [deg]\n"
    )
    yield Saved("gcs.dat", (gcs + "# END_HEADER\n" + rows(F, DB, DEG, sep=" ")).encode())
    listed = "# column 1: frequency (Hz)\n# column 2: Re\n# column 3: Im\n"
    yield Saved("listed.txt", (listed + rows(F, RE, IM, sep=" ")).encode())
    y = 1 / H
    both = "freq/Hz\tRe(Z)/Ohm\t-Im(Z)/Ohm\tRe(Y)/Ohm-1\tIm(Y)/Ohm-1\n"
    yield Saved("both.mpt", (both + rows(F, RE, -IM, y.real, y.imag, sep="\t")).encode())
    traces = "Frequency(Hz),|Z|(ohm)-data,|Z|(ohm)-mem,θz(deg)-data,θz(deg)-mem\n"
    yield Saved("empty_memory.csv", (traces + rows(F, SIZE, 0 * F, DEG, 0 * F)).encode())
    parts = [f"{z.real:.9e}-%i*{-z.imag:.9e}" for z in H]
    turned = [f"{a:.9e}\u2220{d:.9f}°" for a, d in zip(SIZE, DEG, strict=True)]
    yield Saved("polar.csv", ("freq,v(out)\n" + rows(F, turned)).encode())
    yield Saved("cut.txt", ("f\tre\tim\n" + rows(F, RE, IM, sep="\t")).encode("utf-16")[:-1])
    more = rows(F, RE, IM).replace("\n", ",1,2\n", 1)
    yield Saved("one_longer.csv", ("f,re,im\n" + more).encode())
    yield Saved("two_unnamed.csv", ("f,re,im\n" + rows(F, RE, IM, TEN, SIZE)).encode())
    yield Saved("scilab.csv", ("f,H\n" + rows(F, parts)).encode())
    for i, (names, columns) in enumerate((
        ("f,X/F,phase_deg", (F, SIZE, DEG)), ("f [Hz],X1/F1 [m/N],phase X1/F1 [°]", (F, SIZE, DEG)), ("f,X/F (dB),phase_deg", (F, DB, DEG)),
        ("Frequency (hertz),Gain (decibels),Phase (degrees)", (F, DB, DEG)),
        ("f,Z',Z''", (F, RE, IM)), ("f,Z',-Z''", (F, RE, -IM)), ("Freq/Hz, Z'/ohm, Z\"/ohm", (F, RE, IM)),
        ("f,Hreal,Himag", (F, RE, IM)), ("f,ReH,ImH", (F, RE, IM)), ("Freq,I,Q", (F, RE, IM)),
        ("f,in_phase,quadrature", (F, RE, IM)),
    )):  # fmt: skip
        yield Saved(f"names_{i}.csv", (names + "\n" + rows(*columns)).encode())


def universal(f, h):
    """Return a universal file of one dataset 58 with single precision, blanks behind its marks."""
    ends = f"{4:5d}{1:10d}{1:5d}{0:10d} {'NONE':<10}{1:10d}{3:4d} {'NONE':<10}{2:10d}{3:4d}"
    axis = f"{5:10d}{f.size:10d}{1:10d}{f[0]:13.5E}{f[1] - f[0]:13.5E}{0.0:13.5E}"
    kinds = [f"{kind:10d}{0:5d}{0:5d}{0:5d} {'NONE':<20} {'NONE':<20}" for kind in (18, 8, 13, 0)]
    parts = np.column_stack([h.real, h.imag]).ravel()
    numbers = ["".join(f"{x:13.5E}" for x in parts[i : i + 6]) for i in range(0, parts.size, 6)]
    lines = ["    -1  ", "    58", *["NONE"] * 5, ends, axis, *kinds, *numbers, "    -1  "]
    return "\n".join(lines) + "\n"


def network_files():
    """Return Touchstone files: the impedance of one port, and S21 of two."""
    s11 = (H - 0.05) / (H + 0.05)
    yield Saved(
        "pocket.s1p",
        ("! pocket analyser\n# Hz S RI R 0.05\n" + rows(F, s11.real, s11.imag, sep=" ")).encode(),
    )
    yield Saved(
        "level.s1p",
        (
            "# kHz S DB R 0.05\n"
            + rows(F / 1e3, 20 * np.log10(abs(s11)), np.degrees(np.angle(s11)), sep="\t")
        ).encode(),
    )
    yield Saved(
        "admittance.s1p",
        ("# MHz Y RI R 50\n" + rows(F / 1e6, (50 / H).real, (50 / H).imag, sep=" ")).encode(),
    )
    zero = np.zeros(F.size)
    yield Saved(
        "through.s2p",
        (
            "# GHz S MA R 50\n"
            + rows(F / 1e9, zero, zero, SIZE, DEG, zero, zero, zero, zero, sep=" ", form="{:.14g}")
        ).encode(),
    )


def array_files():
    """Return files of numpy and MATLAB."""

    def mat(**arrays):
        buffer = io.BytesIO()
        scipy.io.savemat(buffer, arrays)
        return buffer.getvalue()

    def npz(*given, **arrays):
        buffer = io.BytesIO()
        np.savez(buffer, *given, **arrays)
        return buffer.getvalue()

    npy = io.BytesIO()
    np.save(npy, np.column_stack([F, H]))
    table = io.BytesIO()
    np.save(table, np.rec.fromarrays([F, RE, IM], names="freq,re,im"))
    yield Saved("table.npy", table.getvalue())
    w, column = 2 * np.pi * F, F[:, None]
    yield Saved("struct.mat", mat(data={"w": w, "P": {"frf": H}}))
    yield Saved("bode.mat", mat(mag=SIZE[None, None, :], phase=DEG[None, None, :], wout=w[:, None]))
    yield Saved("estimate.mat", mat(Txy=H[:, None], F=column, Cxy=COH[:, None]))
    yield Saved(
        "frd_struct.mat",
        mat(G={"ResponseData": H[None, None, :], "Frequency": w[:, None], "FrequencyUnit": "rad/TimeUnit"}),
    )
    yield Saved(
        "frd_hertz.mat", mat(G={"ResponseData": H[None, None, :], "Frequency": column, "FrequencyUnit": "Hz"})
    )
    yield Saved("matrix.mat", mat(FRF=np.column_stack([F, H])))
    yield Saved("radians.mat", mat(FRF=np.column_stack([w, H])))
    yield Saved("real_matrix.mat", mat(data=np.column_stack([F, RE, IM])), columns="f,re,im")
    yield Saved("many.mat", mat(freq=column, H=np.column_stack([H, H2])), (H, H2))
    yield Saved("runs.mat", mat(run=np.array([{"f": F, "H": H}, {"f": F, "H": H2}], object)), (H, H2))
    axis = {"start_value": F[0], "increment": F[1] - F[0]}
    yield Saved("testlab.mat", mat(Signal={"x_values": axis, "y_values": {"values": H[:, None]}}))
    spectra = {"Time_domain": column / 1280, "PSD_chan_1": SIZE[:, None], "Hf_coh_chan_2": COH[:, None]}
    yield Saved("channels.mat", mat(Freq_domain=column, Hf_chan_2=H[:, None], **spectra))
    yield Saved("unnamed.npz", npz(F, H))
    yield Saved("named.npz", npz(axis=np.e * F, G=H), columns="f=axis,h=G", frequency=(np.e * F,))
    yield Saved("parts.npz", npz(f_hz=F, re=RE, im=IM))
    yield Saved("pair.npy", npy.getvalue())


def all_files():
    """Return all of them."""
    return [
        *text_files(),
        *wild_files(),
        *files_of_tables(),
        *simulated_files(),
        *files_of_simulators_and_names(),
        *network_files(),
        *array_files(),
    ]
