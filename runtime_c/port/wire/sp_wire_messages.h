/* The springpot serial protocol: the one table of its messages. C builds structs, packing and
 * unpacking out of it, Python reads it as text (host/devices/wire.py); both ends compare a
 * checksum of it in the hello, so that two ends of different tables refuse each other.
 *
 * A frame: type u8, version u8, sequence u32, body, CRC-32C of all before it (u32), all
 * little-endian; the whole COBS-encoded, between two 0 bytes. The sequence counts the frames
 * that one end has sent. Setpoints (SAMPLE, FORCE) are never sent again: the newest counts. COMMAND
 * is sent again until an ACK with its sequence comes back.
 *
 * Signs: position is the penetration into the object, force is positive where it pushes the tool
 * out. m, m/s, N, s.
 */
#ifndef SP_WIRE_MESSAGES_H
#define SP_WIRE_MESSAGES_H

/* clang-format off */
#define SP_WIRE_VERSION 2

/* MESSAGE(type, NAME, name) */
#define SP_WIRE_TABLE(MESSAGE)   \
    MESSAGE(1, ASK, ask)         \
    MESSAGE(2, HELLO, hello)     \
    MESSAGE(3, COMMAND, command) \
    MESSAGE(4, ACK, ack)         \
    MESSAGE(5, SAMPLE, sample)   \
    MESSAGE(6, FORCE, force)

/* Host: who are you? A device that hears it, old or new, forgets the sequence that it has seen. */
#define SP_WIRE_ASK(FIELD) \
    FIELD(u32, layout)          /* sp_wire_layout() of the host */

/* Device: the answer, and its first frame after a restart: a host that hears it forgets the
 * sequence that it has seen. */
#define SP_WIRE_HELLO(FIELD)  \
    FIELD(u32, layout)        \
    FIELD(f32, rate_hz)         /* samples a second that it sends by itself */ \
    FIELD(f32, max_n)           /* maximum force of its motor */

/* Host: do it. After STOP the motor is without force. The device's watchdog counts from the first
 * FORCE on; once it has tripped, only START, PRESS and RESET take forces again. */
#define SP_WIRE_COMMAND(FIELD) \
    FIELD(u8, action)           /* SP_WIRE_STOP, _START: a hand will be given forces, _RESET, _PRESS: an object is pressed */ \
    FIELD(f32, watchdog_s)      /* silence of the host after which the force goes to zero */ \
    FIELD(f32, rate_hz)         /* samples a second that the host wants */

/* Device: done. */
#define SP_WIRE_ACK(FIELD) \
    FIELD(u32, command)         /* sequence of the command */ \
    FIELD(u8, refused)          /* 0, or an SP_WIRE_REFUSED_... */

/* Device: the newest measurement. */
#define SP_WIRE_SAMPLE(FIELD) \
    FIELD(u8, status)           /* bits SP_WIRE_TRIPPED, _RUNNING, _LOAD_CELL */ \
    FIELD(f32, position_m)    \
    FIELD(f32, velocity_mps)  \
    FIELD(f32, measured_n)      /* of a load cell */

/* Host: the newest force for the motor. */
#define SP_WIRE_FORCE(FIELD) \
    FIELD(f32, force_n)

enum { SP_WIRE_STOP = 0, SP_WIRE_START = 1, SP_WIRE_RESET = 2, SP_WIRE_PRESS = 3 };
enum { SP_WIRE_REFUSED_ACTION = 1, SP_WIRE_REFUSED_RATE = 2, SP_WIRE_REFUSED_WATCHDOG = 3 };
enum { SP_WIRE_TRIPPED = 1, SP_WIRE_RUNNING = 2, SP_WIRE_LOAD_CELL = 4 };
/* clang-format on */

#endif
