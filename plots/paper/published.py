"""What the paper prints: Hoy, Tezaur, Mota, The Schwarz alternating method for multiscale contact mechanics.

To be read beside our figures; no result of ours is checked against these.
"""

# Greatest and average number of Schwarz iterations: Implicit-Implicit, Implicit-Explicit, Explicit-Explicit
TABLE_4_3 = {
    "50": ("4/1.7354", "4/1.7483", "4/1.7562"),
    "100": ("5/1.9105", "4/1.7506", "4/1.7569"),
    "200": ("5/2.2184", "5/2.0225", "5/2.1953"),
    "400": ("6/2.5882", "5/2.3142", "5/2.2505"),
}
TABLE_4_4 = {
    "1e-7": ("5/2.447", "5/1.8768", "3/1.2532"),
    "1e-8": ("5/2.2184", "5/2.0225", "5/2.1953"),
    "1e-9": ("5/2.2195", "5/2.0607", "5/2.1964"),
}
RATE = 0.82  # of the kinetic energy, figure 4.13(a)
