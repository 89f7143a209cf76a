/* @NAME@ on an Arduino: the position from an analog input, the force to a PWM or DAC output.
 *
 * Make the numbers below those of your device, with the motor's power off. The sketch pushes only:
 * a force that pulls is left out. Without a passed self-test there is no force at all. The self-test
 * takes @STATE@ bytes of stack. */
#include <@PREFIX@.h>

static const int POSITION_PIN = A0;
static const int FORCE_PIN = 9;
static const int SURFACE_COUNT = 0; /* of analogRead, at the undeformed surface */
static const @REAL@ M_PER_COUNT = @PER_COUNT@; /* into the object */
static const int FULL_DUTY = 255; /* of analogWrite */
static const @REAL@ FULL_DUTY_N = @FULL@; /* what the tool then feels */
static const uint32_t PERIOD_US = @PERIOD_US@

static @PREFIX@_state state;
static bool passed = false;
static uint32_t next_us = 0;
@BEFORE@
static void push(@REAL@ force_n)
{
    const @REAL@ share = force_n / FULL_DUTY_N;
    const int duty = share < 1 ? (int)(share * (@REAL@)FULL_DUTY) : FULL_DUTY;
    analogWrite(FORCE_PIN, share > 0 ? duty : 0);
}

void setup()
{
    pinMode(FORCE_PIN, OUTPUT);
    push(@ZERO@);
    Serial.begin(115200);
    const int differs = @PREFIX@_selftest();
    passed = differs == 0;
    if (!passed) {
        Serial.print("no force: this compiler changes floating-point results, at tick ");
        Serial.println(differs - 1);
    }
    @PREFIX@_init(&state);
    next_us = (uint32_t)micros() + PERIOD_US;
}

void loop()
{
    const uint32_t late_us = (uint32_t)micros() - next_us;
    if (!passed || late_us >= 0x80000000u) { /* before its time, the difference wraps around */
        return;
    }
    @REAL@ force_n = @ZERO@;
    const uint32_t missed = late_us / PERIOD_US;
    if (missed > 0) {
        (void)@PREFIX@_idle(&state, (@REAL@)(missed * PERIOD_US) * @PER_US@, &force_n);
    }
    next_us += (missed + 1) * PERIOD_US;
    const @REAL@ position_m = (@REAL@)(analogRead(POSITION_PIN) - SURFACE_COUNT) * M_PER_COUNT;
@DIFFERENCE@    const int notes = @PREFIX@_step(&state, position_m, @VELOCITY@, &force_n);
    push(notes < 0 ? @ZERO@ : force_n);
}
