"""The colours of all pictures: Okabe and Ito's, which colour-blind readers tell apart too."""

INK, BLUE, SKY, GREEN, RED, YELLOW, ORANGE, PURPLE = (
    "#1b1b1b", "#0072b2", "#56b4e9", "#009e73", "#d55e00", "#f0e442", "#e69f00", "#cc79a7",
)  # fmt: skip
GREY = "#6f6f6f"
GRID = "#dddddd"

# What a page calls them, since it has a light and a dark value for each.
NAMES = {
    INK: "ink", BLUE: "blue", SKY: "sky", GREEN: "green", RED: "red", YELLOW: "yellow",
    ORANGE: "orange", PURPLE: "purple", GREY: "grey", GRID: "grid",
    "#000000": "ink", "#ffffff": "paper",
}  # fmt: skip
