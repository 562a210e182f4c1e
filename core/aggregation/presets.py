"""What the tools offer by name. Without imports, for they ask before anything else is there."""

METHODS = ("greedy", "annealing", "exact")
DISTANCES = ("equal", "code", "table")
BOUNDARIES = ("regions", "classes")

# weights of class change, boundary length and centre distance, for 40 hectares
PRESETS = {
    "keep classes": (1.0, 11.25, 0.000035),
    "balanced": (1.0, 45.0, 0.00014),
    "compact": (1.0, 90.0, 0.00056),
}
