"""flexbeam: flexible bodies in real time, their scenes from Python.

>>> import flexbeam
>>> run = flexbeam.Scene("examples/scenes/rotor.txt").run()
>>> run.t, run["tip_1"], run.units
"""
from ._library import version as __version__
from .description import Description
from .results import Advice, Campbell, Linear, Modes, Run
from .scene import FlexbeamError, Scene, StepRefused

__all__ = ["Advice", "Campbell", "Description", "FlexbeamError", "Linear", "Modes", "Run", "Scene", "StepRefused"]
