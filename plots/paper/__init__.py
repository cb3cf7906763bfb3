"""The paper reproduced: runs every experiment under options/paper and writes a report of its figures, tables and statements.

    PYTHONPATH=plots python -m paper --program build/impakt --out out/paper

experiments  what there is to run           running  runs it, once           results  what came out
figures      the paper's, drawn             tables   the paper's, and ours   published  its numbers
claims       sentences of its text          checks   what we find of them
text         puts the report together       html     makes one file of it
"""
