/* Firmware: a scene rendered by a board that speaks springpot serial (sp_wire_messages.h).
 *
 * A call a period: sp_step where the sensor or the host gave a new motion, else sp_idle, whose
 * watchdog takes the force to zero and latches. Sleeps between interrupts.
 *
 * A replay is of a recording, in its own time: a call for each motion that the host feeds, no call
 * of sp_idle in between, and no force in the motor. How fast the host is changes nothing.
 *
 * A command acts once: one that comes again or late is acknowledged, and only STOP obeyed. What has
 * been started is started again only for a host that asked who is here; else by RESET or REPLAY. */
#include "sp_metadata.h"
#include "sp_port.h"
#include "sp_scene.h"
#include "sp_wire.h"

int main(void);

static struct {
    sp_state scene;
    sp_wire_receiver receiver;
    uint32_t sequence;
    sp_wire_feed motion; /* the newest */
    int moved;           /* since the last call */
    int running;
    int replays;      /* what the host feeds, not what a hand does */
    int asked;        /* since the last command: another host, or the same one anew */
    int commanded;    /* since a host asked, by the command */
    uint32_t command; /* of this sequence */
    int was_reset;
    int sound; /* the self-test passed: else nothing is rendered */
} board;

static void hello(void)
{
    static const sp_wire_hash model = SP_METADATA_HASH;
    const sp_wire_hello message = {.layout = sp_wire_layout(),
                                   .role = SP_WIRE_RENDERS,
                                   .rate_hz = 1.0f / SP_METADATA_DT_S,
                                   .max_n = SP_METADATA_MAX_N,
                                   .model = model};
    uint8_t bytes[SP_WIRE_MAX_BYTES];
    sp_port_write(bytes, sp_wire_send_hello(&board.sequence, &message, bytes));
}

static uint8_t refusal(const sp_wire_command *command)
{
    const float ticks = command->rate_hz * SP_METADATA_DT_S;
    if (command->action == SP_WIRE_STOP) {
        return 0;
    }
    if (command->action > SP_WIRE_REPLAY || !board.sound) {
        return SP_WIRE_REFUSED_ACTION;
    }
    if (!(ticks > 0.999f && ticks < 1.001f)) { /* the scene has one rate */
        return SP_WIRE_REFUSED_RATE;
    }
    /* The scene's watchdog is the one there is: a host that wants a quicker one must know. */
    return command->watchdog_s < 0.99f * SP_METADATA_WATCHDOG_S ? SP_WIRE_REFUSED_WATCHDOG : 0;
}

/* Whether it acts: it is no copy of one that did, nor an older one. */
static int is_due(uint32_t sequence, const sp_wire_command *command)
{
    const uint32_t ahead = sequence - board.command;
    const int is_later = !board.commanded || (ahead != 0u && ahead < 0x80000000u);
    const int restarts = command->action == SP_WIRE_RESET || command->action == SP_WIRE_REPLAY;
    return is_later && (restarts || board.asked || !board.running);
}

static void obey(uint32_t sequence, const sp_wire_command *command)
{
    const sp_wire_ack ack = {.command = sequence, .refused = refusal(command)};
    if (ack.refused == 0 && command->action == SP_WIRE_STOP) {
        board.running = 0;
        sp_hand_force(0.0f);
    } else if (ack.refused == 0 && is_due(sequence, command)) {
        board.asked = 0;
        board.commanded = 1;
        board.command = sequence;
        sp_reset(&board.scene);
        board.was_reset = 1;
        board.moved = 0;
        board.running = board.running || command->action != SP_WIRE_RESET;
        board.replays = command->action == SP_WIRE_REPLAY;
        if (board.replays) {
            sp_hand_force(0.0f);
        }
    }
    uint8_t bytes[SP_WIRE_MAX_BYTES];
    sp_port_write(bytes, sp_wire_send_ack(&board.sequence, &ack, bytes));
}

static void tell(uint8_t call, float force_n, int notes)
{
    const sp_wire_rendered message = {.call = call | (board.was_reset ? SP_WIRE_WAS_RESET : 0),
                                      .position_m = board.motion.position_m,
                                      .velocity_mps = board.motion.velocity_mps,
                                      .dt_s = SP_METADATA_DT_S,
                                      .force_n = force_n,
                                      .notes = (uint8_t)notes};
    uint8_t bytes[SP_WIRE_MAX_BYTES];
    board.was_reset = 0;
    sp_port_write(bytes, sp_wire_send_rendered(&board.sequence, &message, bytes));
}

static int step(sp_real *force_n)
{
    return sp_step(&board.scene, (sp_real)board.motion.position_m,
                   (sp_real)board.motion.velocity_mps, force_n);
}

static void tick(void)
{
    sp_real force_n = (sp_real)0;
    int notes;
    if (sp_hand_motion(&board.motion.position_m, &board.motion.velocity_mps)) {
        board.moved = 1;
    }
    const uint8_t call = board.moved ? 0 : SP_WIRE_IDLE;
    if (board.moved) {
        notes = step(&force_n);
    } else {
        notes = sp_idle(&board.scene, (sp_real)SP_METADATA_DT_S, &force_n);
    }
    board.moved = 0;
    sp_hand_force((float)force_n);
    tell(call, (float)force_n, notes);
}

static void replay(void)
{
    sp_real force_n = (sp_real)0;
    const int notes = step(&force_n);
    tell(0, (float)force_n, notes);
}

static void take(const sp_wire_frame *frame, int is_new)
{
    sp_wire_ask ask;
    sp_wire_command command;
    if (sp_wire_get_ask(frame, &ask)) {
        sp_wire_restart(&board.receiver);
        board.asked = 1;
        board.commanded = 0;
        hello();
    } else if (sp_wire_get_command(frame, &command)) {
        obey(frame->sequence, &command);
    } else if (is_new && sp_wire_get_feed(frame, &board.motion)) {
        if (board.running && board.replays) {
            replay();
        } else {
            board.moved = 1;
        }
    }
}

int main(void)
{
    board.sound = sp_selftest() == 0;
    sp_init(&board.scene);
    sp_port_start(SP_METADATA_DT_S);
    hello();
    for (;;) {
        uint8_t byte;
        while (sp_port_read(&byte)) {
            sp_wire_frame frame;
            const int what = sp_wire_receive(&board.receiver, byte, &frame);
            if (what != SP_WIRE_NONE) {
                take(&frame, what == SP_WIRE_NEW);
            }
        }
        for (uint32_t passed = sp_port_periods(); passed > 0; passed--) {
            if (board.running && !board.replays) {
                tick();
            }
        }
        sp_port_sleep();
    }
}
