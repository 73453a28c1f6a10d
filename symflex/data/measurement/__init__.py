"""Measured frequency responses: reading, writing, and making synthetic ones."""

from symflex.data.measurement.estimate import Estimate
from symflex.data.measurement.files import (
    READERS,
    WRITERS,
    measurement_bytes,
    prepared,
    read_measurement,
    read_records,
    record_in_time,
    responses_in_time,
)
from symflex.data.measurement.measured_response import MeasuredResponse
from symflex.data.measurement.synthesise import MeasurementPlan, synthesise
