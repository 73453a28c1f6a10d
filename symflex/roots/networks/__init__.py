"""Roots of networks of distributed members, from the equations as they stand: no determinant is expanded."""
