"""figure_fired.py: relative density against the temperature of the firing, model and measured (Fig. 1 of Dosta et al. 2017)."""
import json
import re

import style
from style import pyplot
from units import ZERO_CELSIUS

VALID = 0.9  # relative density


def programme(firings):
    """What all schedules are but for their highest temperature: " (25C 10K/min … 1h 10K/min 25C)"; nothing where they differ."""
    texts = set()
    for entry in firings:
        kelvin = {float(number) + (ZERO_CELSIUS if unit == "C" else 0.0): number + unit
                  for number, unit in re.findall(r"([-\d.eE+]+)([CK])(?=\s|$)", entry["schedule"])}
        texts.add(entry["schedule"].replace(kelvin[max(kelvin)], "\u2026") if kelvin else entry["schedule"])
    return f" ({texts.pop()})" if len(texts) == 1 else ""


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
              label="model")
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
    axes.set_xlabel("Highest temperature of the firing, \u00b0C" + programme(firings))
    axes.set_ylabel("Relative density")
    return figure


def main():
    given = style.arguments(__doc__, ("result", "JSON of fired.py"))
    try:
        with open(given.result, encoding="utf-8") as stream:
            result = json.load(stream)
        style.save(draw(result), given.output)
    except OSError as error:
        style.refuse(f"{given.result}: {error.strerror}")
    except (ValueError, KeyError, TypeError):
        style.refuse(f"{given.result}: is not the JSON of fired.py")


if __name__ == "__main__":
    main()
