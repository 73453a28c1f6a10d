"""Measured frequency responses: reading, writing, and making synthetic ones."""

from symflex.measurement.measured_response import MeasuredResponse
from symflex.measurement.prepare import prepared
from symflex.measurement.read import READERS, read_measurement
from symflex.measurement.synthesise import MeasurementPlan, synthesise
from symflex.measurement.write import WRITERS, measurement_bytes

__all__ = [
    "READERS",
    "WRITERS",
    "MeasuredResponse",
    "MeasurementPlan",
    "measurement_bytes",
    "prepared",
    "read_measurement",
    "synthesise",
]
