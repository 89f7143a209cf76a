"""A log of CAN frames as a recording of springpot.

    pip install python-can cantools
    python examples/can_log.py drive.blf rig.dbc --message Tool --rate 500 --out press.h5

The message of the data base holds the signals Position and Force, with their units. Frames are
taken by identifier and format, of one channel: a log may hold a second bus, and an extended frame
may have the number of a standard one.
"""

import argparse

import can
import cantools

import springpot


def read_can_log(
    log: str,
    database: str,
    message: str,
    rate_hz: float,
    channel: str = "",
    position: str = "Position",
    force: str = "Force",
) -> springpot.Recording:
    """Read the frames of one message, interpolated at a rate.

    Raises SystemExit for several channels without a choice, and for frames that are too short.
    """
    tool = cantools.database.load_file(database).get_message_by_name(message)
    frames = [
        frame
        for frame in can.LogReader(log)
        if (frame.arbitration_id, frame.is_extended_id) == (tool.frame_id, tool.is_extended_frame)
        and not (frame.is_remote_frame or frame.is_error_frame)
        and channel in ("", str(frame.channel))
    ]
    channels = sorted({str(frame.channel) for frame in frames})
    if len(channels) != 1:
        raise SystemExit(f"{log}: {message} is on channels {channels}: choose one, --channel")
    short = [frame for frame in frames if len(frame.data) < tool.length]
    if short:
        raise SystemExit(
            f"{log}: {len(short)} frames of {message} have fewer than {tool.length} bytes, "
            f"the first at {short[0].timestamp:.6f} s: is the data base of this device?"
        )
    rows = [tool.decode(frame.data) for frame in frames]
    table = {name: [row[name] for row in rows] for name in (position, force)}
    table["time"] = [frame.timestamp - frames[0].timestamp for frame in frames]
    named = (f"{name}:{tool.get_signal_by_name(name).unit}" for name in (position, force))
    return springpot.Recording.from_frame(
        table, message, time="time:s", **dict(zip(("position", "force"), named, strict=True)),
        resample_hz=rate_hz,
    )  # fmt: skip


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("log")
    parser.add_argument("database")
    parser.add_argument("--message", required=True)
    parser.add_argument("--rate", type=float, required=True, help="Hz")
    parser.add_argument("--channel", default="", help="of several in one log")
    parser.add_argument("--out", required=True, help="file to write, .h5")
    given = parser.parse_args()
    press = read_can_log(given.log, given.database, given.message, given.rate, given.channel)
    springpot.write_recordings(given.out, press)
