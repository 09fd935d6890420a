"""Hydrodynamic databases: what a potential-flow code says of a hull, made, imported, checked and read.

Reading a database needs scipy alone; making one needs the extra ``hydro`` (Capytaine, cvxpy).
"""
