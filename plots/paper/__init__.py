"""The paper reproduced: runs every experiment under options/paper and writes a report of its figures, tables and claims.

    PYTHONPATH=plots python -m paper --program build/impakt --out out/paper

experiments  what there is to run          running  runs it, once        results  what came out
figures      pictures of the paper         tables   its tables, ours     claims   sentences of its text, checked
text         puts the report together      html     makes one file of it
"""
