"""figure_density.py: relative density against sintering time, picked states marked (Fig. 2 of Dosta et al. 2017)."""
import style
import kiln
from style import pyplot


def draw(steps, picks):
    """steps: history of the run, picks: (time, density) of each picked state."""
    figure, axes = pyplot.subplots(figsize=(style.WIDTH, 3.4))
    axes.plot([step["time"] for step in steps], [step["relative_density"] for step in steps], color=style.LINE)
    for time, density in picks:
        axes.plot([0, time, time], [density, density, 0], color=style.REFERENCE, linewidth=0.7, linestyle=(0, (1, 2)))
        axes.plot(time, density, "o", color=style.ACCENT, markersize=6, clip_on=False, zorder=3)
        axes.annotate(f"{density:.2f}", (time, density), (6, -4), textcoords="offset points", va="top")
    low, high = steps[0]["relative_density"], max(steps[-1]["relative_density"], *(density for _, density in picks))
    axes.set_xlim(0, 1.06 * max(time for time, _ in picks))
    axes.set_ylim(low - 0.02, high + 0.03)
    axes.set_xlabel(f"Time at {style.temperature_text([step['temperature'] for step in steps])}, s")
    axes.set_ylabel("Relative density")
    return figure


def main():
    given = style.arguments(__doc__, ("history", "history of sinter, JSON lines"), ("states", "files with the picked states"))
    steps = style.documents(given.history, None, "the history of sinter", "time", "relative_density", "temperature")
    picks = [(state["time"], kiln.relative_density(state)) for path in given.states
             for state in style.documents(path, "dem-state", "which sinter writes", "particles.radius", "time")]
    style.save(draw(steps, picks), given.output)


if __name__ == "__main__":
    main()
