"""Responses in time, enclosed: to a step, an impulse, a ramp, a file."""

from symflex.analysis.time_response.enclosed_response import INTEGRATIONS, EnclosedResponse, response_text
from symflex.analysis.time_response.find import responses_by_default, time_response
from symflex.analysis.time_response.forced import exact_values, forced_response
from symflex.analysis.time_response.initial_values import free_motion, response_from
from symflex.analysis.time_response.sample_times import SampleTimes, default_until, evenly
from symflex.analysis.time_response.step_info import StepInfo, find_step_info
