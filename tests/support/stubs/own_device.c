/* What docs/how-to/own-device.md leaves to its reader, on a pseudo-terminal of this machine: a tool
 * of 0.3 kg in a hand that presses to and fro. Prints the URL; ends when its standard input does.
 */
#define _XOPEN_SOURCE 700
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

int device_byte(void);
void device_write(const uint8_t *bytes, uint32_t size);
uint32_t device_time_us(void);
void device_motion(float *position_m, float *velocity_mps);
void device_motor(float force_n);
void device_start(void);
void device_loop(void);

static int line;
static double motor_n, position_m, velocity_mps, stepped_s;
static double device_s; /* goes on in even steps: a microcontroller is not kept away */

static double now_s(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

int device_byte(void)
{
    uint8_t byte;
    return read(line, &byte, 1) == 1 ? byte : -1;
}

void device_write(const uint8_t *bytes, uint32_t size)
{
    (void)!write(line, bytes, size);
}

uint32_t device_time_us(void)
{
    return (uint32_t)(uint64_t)(1e6 * device_s);
}

void device_motor(float force_n)
{
    motor_n = (double)force_n;
}

void device_motion(float *position, float *velocity)
{
    for (; stepped_s < device_s; stepped_s += 1e-4) {
        const double wanted_m = 0.005 - 0.008 * cos(6.28 * stepped_s);
        const double hand_n = 400.0 * (wanted_m - position_m) - 8.0 * velocity_mps;
        velocity_mps += 1e-4 / 0.3 * (hand_n - motor_n);
        position_m += 1e-4 * velocity_mps;
    }
    *position = (float)position_m;
    *velocity = (float)velocity_mps;
}

int main(void)
{
    struct pollfd input = {.fd = STDIN_FILENO, .events = POLLIN};
    const struct timespec pause = {.tv_nsec = 100000};
    struct termios raw;
    line = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
    if (line < 0 || grantpt(line) != 0 || unlockpt(line) != 0) {
        return 1;
    }
    const int other =
        open(ptsname(line), O_RDWR | O_NOCTTY); /* or the line hangs up between hosts */
    if (other < 0 || tcgetattr(other, &raw) != 0) {
        return 1;
    }
    raw.c_iflag = raw.c_oflag = raw.c_lflag = 0;
    (void)tcsetattr(other, TCSANOW, &raw);
    (void)close(other);
    printf("serial://%s\n", ptsname(line));
    (void)fflush(stdout);
    stepped_s = device_s = now_s();
    device_start();
    while (poll(&input, 1, 0) == 0) {
        for (const double until_s = now_s(); device_s < until_s; device_s += 1e-4) {
            device_loop();
        }
        (void)nanosleep(&pause, NULL);
    }
    return 0;
}
