"""figure_fired.py: relative density against the temperature of the firing, model and measured (Fig. 1 of Dosta et al. 2017)."""
import json

import style
from style import pyplot
from units import ZERO_CELSIUS

VALID = 0.9  # relative density


def draw(result):
    """result: what fired.py writes as JSON."""
    figure, axes = pyplot.subplots(figsize=(style.WIDTH, 3.6))
    curve, firings = result["curve"], result["firings"]
    measured = [entry for entry in firings if entry["measured"] is not None]
    axes.axhspan(VALID, 1.0, color="#000000", alpha=0.06, linewidth=0)
    axes.text(0.99,
              VALID + 0.01,
              "grains would grow: outside of the model",
              transform=axes.get_yaxis_transform(),
              ha="right",
              fontsize="small",
              color="#555555")
    axes.plot([kelvin - ZERO_CELSIUS for kelvin in curve["temperature"]],
              curve["relative_density"],
              color=style.LINE,
              label="model, master sintering curve")
    axes.plot([entry["temperature"] - ZERO_CELSIUS for entry in firings], [entry["relative_density"] for entry in firings],
              "o",
              color=style.ACCENT,
              clip_on=False,
              zorder=3,
              label="model, fired as in the paper")
    axes.plot([entry["temperature"] - ZERO_CELSIUS for entry in measured], [entry["measured"] for entry in measured],
              "s",
              color="black",
              label="measured")
    for entry in measured:
        axes.annotate("", (entry["equivalent_temperature"] - ZERO_CELSIUS, entry["measured"]),
                      (entry["temperature"] - ZERO_CELSIUS, entry["measured"]),
                      arrowprops={
                          "arrowstyle": "->",
                          "color": style.REFERENCE,
                          "linestyle": ":",
                          "shrinkA": 5
                      })
    axes.set_ylim(min(min(curve["relative_density"]), 0.6) - 0.01, 1.0)
    axes.legend(loc="lower right")
    axes.set_xlabel("Temperature of the firing, \u00b0C (10 K/min, one hour)")
    axes.set_ylabel("Relative density")
    return figure


def main():
    given = style.arguments(__doc__, ("result", "JSON of fired.py"))
    with open(given.result, encoding="utf-8") as stream:
        style.save(draw(json.load(stream)), given.output)


if __name__ == "__main__":
    main()
