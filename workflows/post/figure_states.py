"""figure_states.py: two states of a packing as shaded spheres, at one scale: as it was and as it became."""
import numpy

import style
import kiln
from style import NM, pyplot

PIXELS = 900  # along the longer side of a picture
AZIMUTH, ELEVATION = numpy.radians((32.0, 24.0))  # of the eye
LIGHT = numpy.array([-0.45, 0.55, 0.70])  # direction to the lamp: right, up, towards the eye
FAR = 0.55  # brightness of what is farthest away


def camera():
    """Rows: the directions to the right, up, and towards the eye."""
    (sine, cosine), (rise, level) = (numpy.sin(AZIMUTH), numpy.cos(AZIMUTH)), (numpy.sin(ELEVATION), numpy.cos(ELEVATION))
    return numpy.array([[cosine, sine, 0.0], [-rise * sine, rise * cosine, level], [level * sine, -level * cosine, rise]])


def inside_box(state):
    """Centres as the eye sees them, m, moved into the box along its periodic axes, relative to the middle of the box."""
    box = state["box"]
    size, low = numpy.diag(box["vectors"]), numpy.array(box.get("origin", (0, 0, 0)))
    cell = (state["particles"]["position"] - low) / size
    cell = numpy.where(box.get("periodic", (True, ) * 3), cell % 1.0, cell)
    return ((cell - 0.5) * size) @ camera().T


def render(state, pixel):
    """Brightness of each pixel, nan where there is no sphere, and the corners of the picture, m. pixel: its size, m."""
    place, radius = inside_box(state), state["particles"]["radius"]
    reach = radius.max() + pixel
    low, high = place.min(axis=0) - reach, place.max(axis=0) + reach
    width, height = (numpy.ceil((high - low) / pixel).astype(int) + 1)[:2]
    light = LIGHT / numpy.linalg.norm(LIGHT)
    depth, shade = numpy.full((height, width), -numpy.inf), numpy.full((height, width), numpy.nan)
    for (x, y, z), r in zip(place, radius):
        first, last = int((x - r - low[0]) / pixel), int((x + r - low[0]) / pixel) + 2
        bottom, top = int((y - r - low[1]) / pixel), int((y + r - low[1]) / pixel) + 2
        right = (low[0] + pixel * numpy.arange(first, last) - x) / r
        up = ((low[1] + pixel * numpy.arange(bottom, top) - y) / r)[:, None]
        towards = 1.0 - right**2 - up**2
        surface = z + r * numpy.sqrt(towards.clip(min=0.0))
        window = (slice(bottom, top), slice(first, last))
        nearer = (towards > 0.0) & (surface > depth[window])
        depth[window][nearer] = surface[nearer]
        bright = 0.30 + 0.70 * (right * light[0] + up * light[1] + numpy.sqrt(towards.clip(min=0.0)) * light[2]).clip(min=0.0)
        shade[window][nearer] = (bright * (FAR + (1.0 - FAR) * (z - low[2]) / (high[2] - low[2])))[nearer]
    return shade, low, high


def picture(state, pixel):
    """Colours and opacities of the pixels, edges smoothed: the mean of four points each; and the corners of the picture, m."""
    shade, low, high = render(state, pixel / 2)
    shade = shade[:shade.shape[0] // 2 * 2, :shade.shape[1] // 2 * 2]
    colours = style.SOLID(numpy.nan_to_num(shade))
    colours[..., 3] = ~numpy.isnan(shade)
    colours[..., :3] *= colours[..., 3:]
    mean = colours.reshape(shade.shape[0] // 2, 2, shade.shape[1] // 2, 2, 4).mean(axis=(1, 3))
    mean[..., :3] /= numpy.maximum(mean[..., 3:], 0.25)
    return mean, low, high


def draw(states):
    first, last = states[0], states[-1]
    pixel = numpy.ptp(inside_box(first)[:, 0]) / PIXELS + first["particles"]["radius"].max() / PIXELS
    pictures = [picture(state, pixel) for state in (first, last)]
    ratio = sum(shade.shape[0] for shade, _, _ in pictures) / PIXELS
    figure, axes = pyplot.subplots(2,
                                   1,
                                   figsize=(6.0, 6.0 * ratio + 0.7),
                                   height_ratios=[shade.shape[0] for shade, _, _ in pictures])
    widest = max(numpy.abs([low[0], high[0]]).max() for _, low, high in pictures) / NM
    for axis, state, (shade, low, high), word in zip(axes, (first, last), pictures, ("before", "after")):
        limits = numpy.array([low[0], low[0] + pixel * shade.shape[1], low[1], low[1] + pixel * shade.shape[0]]) / NM
        axis.imshow(shade, origin="lower", extent=limits, interpolation="antialiased")
        axis.set_xlim(-widest, widest)
        axis.set_axis_off()
        density, count = kiln.relative_density(state), len(state["particles"]["radius"])
        axis.set_title(f"{word}: relative density {density:.2f}, {count:,} particles", loc="left")
    bar = 10**numpy.floor(numpy.log10(widest))
    axes[1].plot([-widest, bar - widest], [limits[2]] * 2, color="black", linewidth=2.0, clip_on=False)
    axes[1].annotate(f"{bar:,.0f} nm", (bar / 2 - widest, limits[2]), (0, 3), textcoords="offset points", ha="center")
    return figure


def main():
    given = style.arguments(__doc__, ("states", "files with states; the first and the last of all are drawn"))
    style.save(draw([state for path in given.states
                     for state in style.documents(path, "dem-state", "which sinter writes", "particles.position")]), given.output)


if __name__ == "__main__":
    main()
