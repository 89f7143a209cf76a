"""The floors of springpot are folders of this one: each is a package of the package springpot."""

from setuptools import find_packages, setup

FLOORS = find_packages(include=["runtime_c*", "codegen*", "trainer*", "host*"])
setup(packages=["springpot", *(f"springpot.{name}" for name in FLOORS)])
