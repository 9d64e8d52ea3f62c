"""schedules.py: the words of a firing, such as "25C 10K/min 1200C 1h 10K/min 25C", as sinter reads them (lib/io/schedule_text.cpp;
tests/convert/test_homes.py compares the two)."""
import re

import numpy

import units


class ScheduleError(ValueError):
    """One sentence on a word that is not understood."""


def words_of(text):
    """The words; a number and the unit behind it are one, whether or not a blank stands between them."""
    words, number = [], False
    for word in text.split():
        begins_one = word[0] in "0123456789.+-"
        if number and not begins_one:
            words[-1] += " " + word
        else:
            words.append(word)
        number = begins_one and re.fullmatch(r"[0-9.+\-eE]+", word) is not None
    return words


def temperature_of(word):
    """K; None for what is no temperature."""
    return units.ROOM_TEMPERATURE if word == "RT" else units.quantity(word, "temperature")


def corners(text, hottest=None):
    """Times (s) and temperatures (K) of the corners of a schedule; `hottest` (K) replaces its highest temperature."""
    words = words_of(text)
    known = [value for value in map(temperature_of, words) if value is not None]
    if not words or temperature_of(words[0]) is None:
        raise ScheduleError(f"the schedule '{text}' does not begin with a temperature")

    def target(word):
        value = temperature_of(word)
        return hottest if hottest is not None and value == max(known) else value

    time, kelvin, rate = [0.0], [target(words[0])], None
    for word in words[1:]:
        hold, ramp, goal = units.quantity(word, "time"), units.quantity(word, "heating_rate"), target(word)
        if rate is None and hold is not None and hold >= 0:
            time.append(time[-1] + hold)
            kelvin.append(kelvin[-1])
        elif rate is None and ramp is not None and ramp > 0:
            rate = ramp
        elif rate is not None and goal is not None:
            time.append(time[-1] + abs(goal - kelvin[-1]) / rate)
            kelvin.append(goal)
            rate = None
        else:
            raise ScheduleError(f"'{word}' of the schedule '{text}' is not understood where it stands")
    if rate is not None or len(time) == 1:
        raise ScheduleError(f"the schedule '{text}' ends where a temperature is required")
    return numpy.array(time), numpy.array(kelvin)
