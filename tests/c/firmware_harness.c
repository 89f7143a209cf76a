/* The firmware's main loop on a line and a clock of a test's own: before each sleep it finds the
 * bytes and the periods of the next pass, and after it what it made of them is noted. */
#include <setjmp.h>
#include <string.h>

#define main firmware_main
#include "sp_firmware.c"
#undef main

typedef struct {
    const uint8_t *bytes; /* of all passes */
    const uint32_t *counts;
    const uint32_t *periods;
    int32_t *resets; /* after each pass */
    int32_t *running;
    int32_t *acks;
    int32_t *steps; /* since the last reset */
    float *force_n;
    float *rendered_n; /* as the last call told */
    uint32_t n;
} script;

void harness_run(const script *given);

static struct {
    script script;
    uint32_t pass, left, periods;
    int32_t acks;
    float force_n, rendered_n;
    sp_wire_receiver host;
    jmp_buf over;
} line;

void sp_port_start(float period_s)
{
    (void)period_s;
}

int sp_port_read(uint8_t *byte)
{
    const int has = line.left > 0;
    if (has) {
        *byte = *line.script.bytes++;
        line.left--;
    }
    return has;
}

void sp_port_write(const uint8_t *bytes, uint32_t n)
{
    for (uint32_t i = 0; i < n; i++) {
        sp_wire_frame frame;
        sp_wire_ack ack;
        sp_wire_rendered rendered;
        if (sp_wire_receive(&line.host, bytes[i], &frame) != SP_WIRE_NONE) {
            line.acks += sp_wire_get_ack(&frame, &ack);
            if (sp_wire_get_rendered(&frame, &rendered)) {
                line.rendered_n = rendered.force_n;
            }
        }
    }
}

uint32_t sp_port_periods(void)
{
    const uint32_t passed = line.periods;
    line.periods = 0;
    return passed;
}

static void begin_pass(void)
{
    if (line.pass == line.script.n) {
        longjmp(line.over, 1);
    }
    line.left = line.script.counts[line.pass];
    line.periods = line.script.periods[line.pass];
}

void sp_port_sleep(void)
{
    line.script.resets[line.pass] = board.scene.resets;
    line.script.running[line.pass] = board.running;
    line.script.acks[line.pass] = line.acks;
    line.script.steps[line.pass] = board.scene.steps;
    line.script.force_n[line.pass] = line.force_n;
    line.script.rendered_n[line.pass] = line.rendered_n;
    line.pass++;
    begin_pass();
}

int sp_hand_motion(float *position_m, float *velocity_mps)
{
    (void)position_m;
    (void)velocity_mps;
    return 0;
}

void sp_hand_force(float force_n)
{
    line.force_n = force_n;
}

void harness_run(const script *given)
{
    memset(&board, 0, sizeof board);
    memset(&line, 0, sizeof line);
    line.script = *given;
    if (setjmp(line.over) == 0) {
        begin_pass();
        (void)firmware_main();
    }
}
