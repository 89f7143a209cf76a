"""Formats of other programs: Mach-1 text, CAN logs, HDF5, MAT, TDMS, workbooks."""
