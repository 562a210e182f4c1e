"""Named weights of the three costs."""

# weights of class change, boundary length and centre distance, for 40 hectares
PRESETS = {
    "keep classes": (1.0, 11.25, 0.000035),
    "balanced": (1.0, 45.0, 0.00014),
    "compact": (1.0, 90.0, 0.00056),
}
